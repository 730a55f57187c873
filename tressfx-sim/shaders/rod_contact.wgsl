// Contacts of a rod with capsules, and friction. A contact is a spring across the surface that only pushes; friction is one along
// it that yields at Coulomb's limit. All vectors are on the axes of the world, places are from the root where it is now.

import package::capsule::{Collider, GpuCapsule};
@if(fields)
import package::field_contact::{depth_of_field, is_field, met_by};
import package::step::step;
import package::symmetric::{Symmetric, outer, scaled, scaled_identity, sum};
import package::vector::{DOWN, direction_or, rotate, rotate_back, turned_by};

@group(0) @binding(7) var<storage, read> colliders: array<Collider>;

/// The stiffness of a contact times the square of the sub-step, over the mass of the vertex.
const CONTACT: f32 = 100.0;
/// The stiffness of friction until it yields, as a share of that. With more, what the springs along a strand do to each other
/// needs many more rounds.
const GRIP: f32 = 0.01;
/// There is another round where an edge is deeper than this share of the radius, and from there on the push grows so much faster with the depth. A taut strand pulls as hard
/// as a push at a depth of some millimetres; with a push that is as stiff near the surface strands at rest would tremble.
const DEEP: f32 = 0.1;
const STEEPER: f32 = 10.0;
/// An edge touches between its ends where it is nearer to the axis there than at its ends; in full from this share of the
/// radius on.
const NEARER: f32 = 0.1;
/// The way of an edge is followed in so many steps, each as long as nothing can be touched,
const ADVANCES: u32 = 12u;
/// until it is nearer to the surface than this share of the radius.
const REACHED: f32 = 0.02;
/// Where the normal has turned by more than what this cosine says since the edge touched, it has got to the other side.
const SAME_SIDE: f32 = 0.3;
const LAST_BIT: u32 = 31u;
/// Further than any capsule.
const FAR: f32 = 1e30;

/// What the rod remembers of a contact of an edge.
struct Touch {
    /// The capsule's place in the list of the section and 1; 0 where nothing was touched.
    obstacle: u32,
    /// The normal, which says on which side the edge is.
    normal: vec3<f32>,
    /// How far the spring of friction is stretched.
    stretch: vec3<f32>,
    /// The distance from the surface; negative inside.
    gap: f32,
    is_deep: bool,
}

/// An edge in a sub-step.
struct Edge {
    /// Where it is, from end to end.
    u: vec3<f32>,
    v: vec3<f32>,
    /// By what its ends have moved.
    u_moved: vec3<f32>,
    v_moved: vec3<f32>,
    /// Where its ends were, relative to the centre of the groom of then.
    u_before: vec3<f32>,
    v_before: vec3<f32>,
}

/// What contacts do to an edge: half of a quadratic function of the displacement of its points, by the displacement of the vertex
/// before it and by the rotation of its arm.
struct Push {
    place: Symmetric,
    mixed: Symmetric,
    turn: Symmetric,
    force: vec3<f32>,
    torque: vec3<f32>,
    /// The force across the surface alone, which tension knows of.
    pull: vec3<f32>,
}

/// That, and the deepest of them.
struct Contacts { push: Push, touch: Touch }

/// Where an edge is nearest to the axis of a capsule: the shares of both, the direction from the axis to the edge, and the
/// distance from the surface.
struct Near { s: f32, t: f32, normal: vec3<f32>, gap: f32 }

/// The way of an edge past a capsule, as the capsule sees it.
struct Way { from_u: vec3<f32>, from_v: vec3<f32>, longest: f32 }

fn nothing_touched() -> Touch {
    return Touch(0u, vec3(0.0), vec3(0.0), 0.0, false);
}

/// The contacts of an edge with all capsules of the section. `last` is what it touched before, `root` where the root is, relative
/// to the centre of the groom, and `mass` that of the vertex after the edge. Only `obstacles` are looked at; see `bit_of`.
fn contacts_of(root: vec3<f32>, edge: Edge, last: Touch, obstacles: u32, mass: f32) -> Contacts {
    let none = scaled_identity(0.0);
    var contacts = Contacts(Push(none, none, none, vec3(0.0), vec3(0.0), vec3(0.0)), nothing_touched());
    for (var i = step.first_capsule; i < step.end_capsule; i++) {
        if ((obstacles & bit_of(i)) == 0u) { continue; }
        let u_past = edge.u_moved - surface_moved(i, edge.u_before);
        let v_past = edge.v_moved - surface_moved(i, edge.v_before);
        let longest = sqrt(max(dot(u_past, u_past), dot(v_past, v_past)));
        let way = Way(edge.u - u_past, edge.v - v_past, longest);
        let index = i - step.first_capsule + 1u;
        var known = nothing_touched();
        if (last.obstacle == index) { known = last; }
        @if(fields) {
            if (is_field(colliders[i].capsule)) {
                touch_field(&contacts, root, edge, way, known, index, mass);
                continue;
            }
        }
        let capsule = capsule_at(root, i);
        let near = nearest_points(capsule, edge.u, edge.v);
        // Nothing of the way was nearer than this.
        if (near.gap > longest) { continue; }
        touch_capsule(&contacts, capsule, edge, way, near, known, index, mass);
    }
    return contacts;
}

/// Adds the contact of the end of an edge with a field.
@if(fields)
fn touch_field(contacts: ptr<function, Contacts>, root: vec3<f32>, edge: Edge, way: Way, last: Touch, index: u32, mass: f32) {
    let shape = colliders[step.first_capsule + index - 1u].capsule;
    let end = rotate_back(step.head_rotation, root + edge.v);
    let met = met_by(shape, end, rotate_back(step.head_rotation, edge.v - way.from_v));
    let near = Near(1.0, 0.0, rotate(step.head_rotation, met.normal), met.distance);
    add(contacts, edge, way, near, 1.0, last.stretch, index, mass, depth_of_field(shape));
}

/// Adds the contacts of an edge with one capsule.
fn touch_capsule(contacts: ptr<function, Contacts>, capsule: GpuCapsule, edge: Edge, way: Way, near: Near, last: Touch,
                 index: u32, mass: f32) {
    let start = nearest_points(capsule, way.from_u, way.from_v);
    var first = start;
    if (start.gap > 0.0) {
        first = first_touch(capsule, edge, way, start);
        if (first.gap > REACHED * least_radius(capsule)) { return; }
    }
    let is_known = last.obstacle != 0u && start.gap <= 0.0;
    let side = select(first.normal, last.normal, is_known);
    var point = near;
    var weight = 1.0;
    let end = nearest_to(capsule, edge.u, edge.v, 1.0);
    var touches_end = dot(end.normal, side) >= SAME_SIDE;
    if (dot(near.normal, side) < SAME_SIDE) {
        // It has got to the other side of the axis: it is held at the side that it came from.
        let center = mix(capsule.a, capsule.b, first.t);
        let gap = dot(mix(edge.u, edge.v, first.s) - center, side) - radius_at(capsule, first.t);
        point = Near(first.s, first.t, side, gap);
        touches_end = false;
    } else {
        let before = nearest_to(capsule, edge.u, edge.v, 0.0);
        let nearer = (min(before.gap, end.gap) - near.gap) / (NEARER * radius_at(capsule, near.t));
        weight = clamp(nearer, 0.0, 1.0);
    }
    // A loop, so that drivers that put functions in line do it once: it is what takes them longest to compile.
    for (var i = 0u; i < 2u; i++) {
        add(contacts, edge, way, point, weight, last.stretch, index, mass, DEEP * radius_at(capsule, point.t));
        if (!touches_end) { break; }
        point = end;
        weight = 1.0;
    }
}

/// Adds the contact of a point of an edge, if it is inside. `stretch` is that of friction at the beginning of the sub-step; beyond `deep` the edge is deep.
fn add(contacts: ptr<function, Contacts>, edge: Edge, way: Way, near: Near, weight: f32, stretch: vec3<f32>, index: u32,
       mass: f32, deep: f32) {
    if (near.gap >= 0.0) { return; }
    let past = mix(edge.u - way.from_u, edge.v - way.from_v, near.s);
    let stretched = stretch + past;
    let along = stretched - dot(stretched, near.normal) * near.normal;
    let length = sqrt(dot(along, along));
    let depth = -near.gap;
    let is_deep = depth > deep;
    let pushed = select(depth, deep + STEEPER * (depth - deep), is_deep);
    let most = step.friction * pushed / GRIP;
    let across = outer(1.0, near.normal);
    var grip = sum(scaled_identity(GRIP), scaled(-GRIP, across));
    var held = along;
    if (length > most) {
        // It yields: only the direction of the force changes.
        let direction = along / length;
        grip = scaled(most / length, sum(grip, outer(-GRIP, direction)));
        held = most * direction;
    }
    let scale = weight * CONTACT * mass;
    let stiffness = scaled(scale, sum(scaled(select(1.0, STEEPER, is_deep), across), grip));
    let push = scale * pushed * near.normal;
    let force = push - scale * GRIP * held;
    (*contacts).push.place = sum((*contacts).push.place, stiffness);
    (*contacts).push.mixed = sum((*contacts).push.mixed, scaled(near.s, stiffness));
    (*contacts).push.turn = sum((*contacts).push.turn, scaled(near.s * near.s, stiffness));
    (*contacts).push.force += force;
    (*contacts).push.torque += near.s * force;
    (*contacts).push.pull += push;
    if (near.gap < (*contacts).touch.gap) {
        (*contacts).touch = Touch(index, near.normal, held, near.gap, is_deep);
    }
}

/// A capsule, from the root, on the axes of the world.
fn capsule_at(root: vec3<f32>, index: u32) -> GpuCapsule {
    let capsule = colliders[index].capsule;
    let a = rotate(step.head_rotation, capsule.a) - root;
    let b = rotate(step.head_rotation, capsule.b) - root;
    return GpuCapsule(a, capsule.radius_a, b, capsule.radius_b);
}

/// The bit of a collider in a set of them. Those from the 32nd on share the last.
fn bit_of(index: u32) -> u32 {
    return 1u << min(index - step.first_capsule, LAST_BIT);
}

/// By what a point that moves with a collider has moved in the sub-step; `before` is where it was, relative to the centre of then.
/// Exactly 0 where nothing moves.
fn surface_moved(index: u32, before: vec3<f32>) -> vec3<f32> {
    return moved_with_head(before) + moved_by_itself(index, before);
}

/// The same of one that moves with the head.
fn moved_with_head(before: vec3<f32>) -> vec3<f32> {
    return step.center_displacement + turned_by(step.head_turn, before);
}

/// What a collider that moves by itself adds to that; exactly 0 of others.
fn moved_by_itself(index: u32, before: vec3<f32>) -> vec3<f32> {
    let motion = colliders[index].motion;
    let in_head = rotate_back(step.head_rotation, before + turned_by(step.head_turn, before));
    return rotate(step.head_rotation, turned_by(motion.rotation, in_head) + motion.translation);
}

/// Where the edge first comes to the surface on its way (conservative advancement), or where it gets to.
fn first_touch(capsule: GpuCapsule, edge: Edge, way: Way, start: Near) -> Near {
    let reached = REACHED * least_radius(capsule);
    var near = start;
    var time = 0.0;
    for (var i = 0u; i < ADVANCES; i++) {
        if (near.gap <= reached) { return near; }
        time += near.gap / way.longest;
        if (time >= 1.0) { return Near(0.0, 0.0, near.normal, FAR); }
        near = nearest_points(capsule, mix(way.from_u, edge.u, time), mix(way.from_v, edge.v, time));
    }
    // It comes nearer and nearer: it counts as touching.
    return Near(near.s, near.t, near.normal, 0.0);
}

fn least_radius(capsule: GpuCapsule) -> f32 {
    return min(capsule.radius_a, capsule.radius_b);
}

fn radius_at(capsule: GpuCapsule, t: f32) -> f32 {
    return capsule.radius_a + t * (capsule.radius_b - capsule.radius_a);
}

/// The nearest points of an edge from `u` to `v` and of the axis (Ericson 2005, 5.1.9).
fn nearest_points(capsule: GpuCapsule, u: vec3<f32>, v: vec3<f32>) -> Near {
    let edge = v - u;
    let axis = capsule.b - capsule.a;
    let apart = u - capsule.a;
    let ee = dot(edge, edge);
    let aa = dot(axis, axis);
    let ea = dot(edge, axis);
    let e = dot(edge, apart);
    let a = dot(axis, apart);
    var s = share(ea * a - e * aa, ee * aa - ea * ea);
    let t = share(ea * s + a, aa);
    s = share(ea * t - e, ee);
    return near_at(capsule, u, v, s, t);
}

/// The point at `s` of an edge and the point of the axis that is nearest to it.
fn nearest_to(capsule: GpuCapsule, u: vec3<f32>, v: vec3<f32>, s: f32) -> Near {
    let axis = capsule.b - capsule.a;
    return near_at(capsule, u, v, s, share(dot(mix(u, v, s) - capsule.a, axis), dot(axis, axis)));
}

/// A part of a whole, from 0 to 1; 0 of nothing.
fn share(part: f32, whole: f32) -> f32 {
    return select(0.0, clamp(part / whole, 0.0, 1.0), whole > 0.0);
}

fn near_at(capsule: GpuCapsule, u: vec3<f32>, v: vec3<f32>, s: f32, t: f32) -> Near {
    let from_axis = mix(u, v, s) - mix(capsule.a, capsule.b, t);
    return Near(s, t, direction_or(from_axis, DOWN), sqrt(dot(from_axis, from_axis)) - radius_at(capsule, t));
}

/// A unit vector as an integer below 2^22: a point of an octahedron (Meyer et al. 2010).
fn packed_direction(v: vec3<f32>) -> f32 {
    let flat = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    let folded = (1.0 - abs(flat.yx)) * select(vec2(-1.0), vec2(1.0), flat >= vec2(0.0));
    let point = floor(1023.5 * (select(flat, folded, v.z < 0.0) + 1.0) + 0.5);
    return point.x * 2048.0 + point.y;
}

fn unpacked_direction(packed: f32) -> vec3<f32> {
    let x = floor(packed / 2048.0);
    let flat = vec2(x, packed - 2048.0 * x) / 1023.5 - 1.0;
    let z = 1.0 - abs(flat.x) - abs(flat.y);
    let folded = (1.0 - abs(flat.yx)) * select(vec2(-1.0), vec2(1.0), flat >= vec2(0.0));
    return normalize(vec3(select(flat, folded, z < 0.0), z));
}
