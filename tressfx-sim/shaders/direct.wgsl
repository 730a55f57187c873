// A rod whose edges turn and never stretch, in one implicit sub-step: the rotations of all edges of a strand are found at once, by
// Newton's method with elimination from the tip to the root and back. One thread a guide. Forces are per mass of unit length, and
// times the square of the sub-step.

import package::grid::{GROUP, thread_index};
import package::joint::{Stiffness, joint_between, lag_of, outer, scaled_identity, stiffness_of, torque_of};
import package::rod::{
    BY_PARENT, BY_PLACE, FRAME, LAST_STRAIN, LAST_VELOCITY, MOVED, MOVING, NOW, STRAIN, Strand, VELOCITY, along, frame_at_rest,
    half_turn, length_of, positions, rest, rods, slot, strand_of,
};
import package::root::shape_of;
import package::step::step;
import package::vector::{after, direction_or, is_finite, turned_by};
@if(contacts)
import package::rod::{edge_of, last_touch};
@if(contacts)
import package::rod_contact::{Contacts, FAR, contacts_of, packed_direction, surface_bound};

/// Strands that were reset because they had become non-finite.
@group(0) @binding(5) var<storage, read_write> non_finite: atomic<u32>;

/// How stiff the spring is that holds a pinned tip, over the mass of the tip.
const HOLD: f32 = 1e4;
/// What holds an edge against a rotation about itself is never less than this share of all that holds it.
const LEAST_TWIST: f32 = 1e-6;
/// The longest rotation of an edge in a round, rad.
const LONGEST_TURN: f32 = 1.5;
/// Where an edge turns by more than this in the last round, rad, the strand's past says little about its future.
const TOO_FAST: f32 = 0.5;
/// There is another round where an edge turns by more than this, rad/s times the length of the sub-step,
const ANOTHER_ROUND: f32 = 2.0;
/// and in sub-steps shorter than this, s, by less, as their square.
const SHORT: f32 = 1.0 / 120.0;

/// An edge whose ends move against each other by more than this share of its length is not aimed: it could point anywhere.
const NO_AIM: f32 = 0.5;

/// Where something is touched, there are at least so many rounds, unless no edge turns by more than `SETTLED`, rad,
const TOUCHING_ROUNDS: u32 = 4u;
/// and at most so many where an edge is deep inside a capsule. It is also the most that a strand may ask for.
const MOST_ROUNDS: u32 = 8u;
const SETTLED: f32 = 1e-5;

/// Whether any edge of a strand touches a capsule, and whether one is deep inside.
struct Touched { any: bool, deep: bool }

@compute @workgroup_size(GROUP)
fn direct(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= step.guides) { return; }
    let strand = strand_of(guide);
    if (step.reset != 0u) {
        rest_again(strand);
        return;
    }
    aim(strand);
    var touched = touched_of(strand);
    var turn = 0.0;
    for (var round = 1u; round <= MOST_ROUNDS; round++) {
        eliminate(strand, touched.any);
        turn = substitute(strand);
        touched = touched_of(strand);
        let calm = turn < ANOTHER_ROUND * step.length * min(step.length / SHORT, 1.0);
        let least = select(1u, TOUCHING_ROUNDS, touched.any && turn >= SETTLED);
        if (round >= least && (calm || round >= step.rounds) && !(touched.deep && turn >= SETTLED)) { break; }
    }
    let is_new = note_touches(strand, touched.any);
    if (!finish(strand, turn < TOO_FAST && !is_new)) {
        rest_again(strand);
        atomicAdd(&non_finite, 1u);
    }
}

/// The strand goes to its rest pose, at rest.
fn rest_again(strand: Strand) {
    for (var i = 0u; i < step.vertices; i++) {
        let vertex = rest[i * step.guides + strand.guide];
        positions[i * step.strands + strand.guide] = vec4(shape_of(strand.root, vertex.xyz), vertex.w);
        for (var j = FRAME; j < NOW; j++) { rods[slot(strand, i, j)] = vec4(0.0); }
        if (i < strand.edges) { rods[slot(strand, i, FRAME)] = frame_at_rest(strand, i); }
    }
    store_strains(strand, false);
}

/// Stores the strains of all joints; the ones before them are kept, or are the same.
fn store_strains(strand: Strand, keep: bool) {
    @if(internal_damping) {
        var parent = strand.root.rotation;
        for (var edge = 0u; edge < strand.edges; edge++) {
            let frame = rods[slot(strand, edge, FRAME)];
            let strain = vec4(joint_between(parent, half_turn(strand, edge), frame).strain, 0.0);
            rods[slot(strand, edge, LAST_STRAIN)] = select(strain, rods[slot(strand, edge, STRAIN)], keep);
            rods[slot(strand, edge, STRAIN)] = strain;
            parent = frame;
        }
    }
}

/// The guess that Newton's method begins with: each edge is turned, the shortest way, to where its vertices would get with their
/// velocities.
fn aim(strand: Strand) {
    var moving = strand.root_moved;
    var begin = step.length * rods[slot(strand, 0u, VELOCITY)].xyz;
    rods[slot(strand, 0u, MOVING)] = vec4(moving, 0.0);
    for (var edge = 0u; edge < strand.edges; edge++) {
        let length = length_of(strand, edge);
        let frame = rods[slot(strand, edge, FRAME)];
        let here = along(frame);
        let to = step.length * rods[slot(strand, edge + 1u, VELOCITY)].xyz;
        var now = frame_at_rest(strand, edge);
        var by = along(now) - here;
        if (edge >= strand.held) {
            let start = select(begin, moving, edge == strand.held);
            let apart = to - start;
            now = frame;
            by = vec3(0.0);
            if (dot(apart, apart) < NO_AIM * NO_AIM * length * length) {
                let there = length * here + apart;
                let size = sqrt(dot(there, there));
                // By how much the distance of the ends grows; from their difference it would be rounding.
                let stretch = dot(apart, length * here + there) / (length + size);
                by = (apart - stretch * here) / size;
                now = normalize(after(vec4(cross(here, by), 2.0 + dot(here, by)), frame));
            }
        }
        moving += length * by;
        begin = to;
        rods[slot(strand, edge, NOW)] = now;
        rods[slot(strand, edge + 1u, MOVING)] = vec4(moving, 0.0);
    }
}

/// A vertex: where the past says that it would be without forces, and with gravity alone, from where it is.
struct Pulled { place: vec3<f32>, free: vec3<f32> }

fn pulled(strand: Strand, vertex: u32, moving: vec3<f32>) -> Pulled {
    let velocity = rods[slot(strand, vertex, VELOCITY)].xyz;
    var place = -moving;
    var kept = velocity;
    if (strand.has_past) {
        place += rods[slot(strand, vertex, MOVED)].xyz / 3.0;
        kept = (4.0 * velocity - rods[slot(strand, vertex, LAST_VELOCITY)].xyz) / 3.0;
    }
    return Pulled(place, place + strand.length * kept + strand.fall);
}

/// The mass of a vertex with what acts on it in proportion to its place, and the force.
struct Inertia { mass: mat3x3<f32>, force: vec3<f32> }

fn inertia(strand: Strand, vertex: u32, mass: f32, pulled: Pulled, moving: vec3<f32>, axis: vec3<f32>) -> Inertia {
    let drag = scaled_identity(strand.length * step.drag_across)
        + strand.length * (step.drag_along - step.drag_across) * outer(axis, axis);
    var force = pulled.free + drag * (pulled.place + strand.length * strand.wind);
    var held = 1.0;
    @if(pull) {
        let pull = strand.length * strand.length * step.pull;
        let then = positions[vertex * step.strands + strand.guide].xyz;
        let goal = shape_of(strand.root, rest[vertex * step.guides + strand.guide].xyz);
        force += pull * (goal - then + step.center_displacement - moving);
        held += pull;
    }
    return Inertia(mass * (scaled_identity(held) + drag), mass * force);
}

/// From the tip to the root: takes each edge out of the system, and gives the vertex before it and its parent what the edge and all
/// beyond want of them. That is half of a quadratic function of the displacement of a vertex and of the rotation of the edge before it.
fn eliminate(strand: Strand, touches: bool) {
    let tip = strand.edges;
    var length = length_of(strand, tip - 1u);
    var frame = rods[slot(strand, tip - 1u, NOW)];
    var axis = along(frame);
    var moving = rods[slot(strand, tip, MOVING)].xyz;
    var after_edge = pulled(strand, tip, moving);
    let last = inertia(strand, tip, 0.5 * length, after_edge, moving, axis);
    let spring = hold_stiffness(strand);
    let hold = rods[slot(strand, tip, FRAME)].xyz;
    let gap = hold_place(strand) - positions[tip * step.strands + strand.guide].xyz + step.center_displacement - moving;
    var place = last.mass + scaled_identity(spring);
    var mixed = scaled_identity(0.0);
    var turn = scaled_identity(0.0);
    var force = last.force + hold + spring * gap;
    var torque = vec3(0.0);
    // The force that the tip has come to is held with, not that of the spring, which changes its sign from round to round.
    var pull = last.force + hold;
    // Of the edge after the one at hand, which has half of the mass between them.
    var length_after = 0.0;
    for (var edge = tip; edge > strand.held; ) {
        edge--;
        var length_before = 0.0;
        var parent = strand.root.rotation;
        var direction = axis;
        if (edge > 0u) {
            length_before = length_of(strand, edge - 1u);
            parent = rods[slot(strand, edge - 1u, NOW)];
            direction = along(parent);
        }
        let end_moving = moving;
        moving = rods[slot(strand, edge, MOVING)].xyz;
        let before_edge = pulled(strand, edge, moving);

        // The vertex after the edge moves by the one before it and `arm * rotation`.
        let arm = -length * cross_matrix(axis);
        let back = transpose(arm);
        let across = scaled_identity(1.0) - outer(axis, axis);
        let half = back * mixed;
        turn += half + transpose(half) + back * place * arm;
        torque += back * force;
        mixed += place * arm;
        @if(contacts) {
            if (touches) {
                let mass = 0.5 * (length + length_after);
                let contacts = contacts_of(strand.root_now, edge_of(strand, edge, moving, end_moving), last_touch(strand, edge), mass);
                turn += back * contacts.turn * arm;
                torque += back * contacts.torque;
                mixed += contacts.mixed * arm;
                place += contacts.place;
                force += contacts.force;
                pull += contacts.pull;
            }
            length_after = length;
        }
        // Tension pulls an edge straight; pressure would let it fall, and is left out.
        let correction = strand.mass_correction * length;
        turn += (length * max(dot(axis, pull), 0.0) - correction * length * length) * across;
        torque -= correction * (back * (after_edge.free - before_edge.free));

        let joined = select(0.0, length_before, edge > strand.held);
        let span = max(0.5 * (joined + length), strand.shortest_span);
        let joint = joint_between(parent, half_turn(strand, edge), frame);
        let bending = strand.bending / span * strand.length * strand.length;
        let past = past_strain(strand, edge, joint.strain);
        let stiffness = Stiffness(bending, step.twist_ratio, lag_of(joint, step.internal_damping / strand.length, past));
        let own = torque_of(joint, stiffness, past);
        let spring = stiffness_of(joint, stiffness);

        // Where twist is all but free, f32 would know nothing of what is left of it beside the inertia.
        let whole = turn + spring;
        turn += LEAST_TWIST * (whole[0].x + whole[1].y + whole[2].z) * outer(axis, axis);
        let inverse = inverse_of(turn + spring);
        let by_parent = inverse * spring;
        let by_place = inverse * transpose(mixed);
        let free = inverse * (torque + own);
        store(strand, edge, free, by_parent, by_place);

        let mass = 0.5 * (length_before + length);
        let vertex_axis = direction_or(axis + direction, axis);
        let vertex = inertia(strand, edge, mass, before_edge, moving, vertex_axis);
        place = symmetric(place - mixed * by_place) + vertex.mass;
        force += vertex.force - mixed * free;
        // Equal to `spring * free - own`, without the difference of two large numbers.
        torque = transpose(by_parent) * torque - turn * (inverse * own);
        mixed = mixed * by_parent;
        turn = symmetric(turn * by_parent);
        pull += vertex.force;

        after_edge = before_edge;
        frame = parent;
        axis = direction;
        length = length_before;
    }
}

/// What the past says of a strain.
fn past_strain(strand: Strand, edge: u32, strain: vec3<f32>) -> vec3<f32> {
    @if(!internal_damping) { return strain; }
    @if(internal_damping) {
        let last = rods[slot(strand, edge, STRAIN)].xyz;
        let before = rods[slot(strand, edge, LAST_STRAIN)].xyz;
        return select(last, (4.0 * last - before) / 3.0, strand.has_past);
    }
}

fn store(strand: Strand, edge: u32, free: vec3<f32>, by_parent: mat3x3<f32>, by_place: mat3x3<f32>) {
    rods[slot(strand, edge, BY_PARENT)] = vec4(by_parent[0], free.x);
    rods[slot(strand, edge, BY_PARENT + 1u)] = vec4(by_parent[1], free.y);
    rods[slot(strand, edge, BY_PARENT + 2u)] = vec4(by_parent[2], free.z);
    rods[slot(strand, edge, BY_PLACE)] = vec4(by_place[0], 0.0);
    rods[slot(strand, edge, BY_PLACE + 1u)] = vec4(by_place[1], 0.0);
    rods[slot(strand, edge, BY_PLACE + 2u)] = vec4(by_place[2], 0.0);
}

/// From the root to the tip: turns each edge. Gives the longest rotation, rad.
fn substitute(strand: Strand) -> f32 {
    var shift = vec3(0.0);
    var parent = vec3(0.0);
    var moving = rods[slot(strand, strand.held, MOVING)].xyz;
    var begin = moving;
    var longest = 0.0;
    for (var edge = strand.held; edge < strand.edges; edge++) {
        let length = length_of(strand, edge);
        let first = rods[slot(strand, edge, BY_PARENT)];
        let second = rods[slot(strand, edge, BY_PARENT + 1u)];
        let third = rods[slot(strand, edge, BY_PARENT + 2u)];
        let by_place = mat3x3(
            rods[slot(strand, edge, BY_PLACE)].xyz,
            rods[slot(strand, edge, BY_PLACE + 1u)].xyz,
            rods[slot(strand, edge, BY_PLACE + 2u)].xyz,
        );
        let free = vec3(first.w, second.w, third.w);
        var rotation = free + mat3x3(first.xyz, second.xyz, third.xyz) * parent - by_place * shift;
        let size = sqrt(dot(rotation, rotation));
        rotation *= min(1.0, LONGEST_TURN / max(size, LONGEST_TURN));
        longest = max(longest, min(size, LONGEST_TURN));
        let frame = rods[slot(strand, edge, NOW)];
        let here = along(frame);
        let turn = rotation_by(rotation);
        let now = normalize(after(turn, frame));
        shift += length * cross(rotation, here);
        // From the rotation, not from the frames before and after it: in short sub-steps those differ by little more than rounding, and
        // a strand would get its speed from that.
        let end = rods[slot(strand, edge + 1u, MOVING)].xyz;
        moving += (end - begin) + length * turned_by(turn, here);
        begin = end;
        rods[slot(strand, edge, NOW)] = now;
        rods[slot(strand, edge + 1u, MOVING)] = vec4(moving, 0.0);
        parent = rotation;
    }
    return longest;
}

/// Whether a strand touches anything, as far as it has got. Where the nearest capsule is some way off, the edges from there on need no
/// test for as long.
fn touched_of(strand: Strand) -> Touched {
    var touched = Touched(false, false);
    @if(contacts) {
        if (step.first_capsule == step.end_capsule) { return touched; }
        var furthest = 0.0;
        var reach = 0.0;
        for (var i = strand.held; i <= strand.edges; i++) {
            let moving = rods[slot(strand, i, MOVING)].xyz;
            furthest = max(furthest, dot(moving, moving));
            if (i < strand.edges) { reach += length_of(strand, i); }
        }
        furthest = sqrt(furthest) + surface_bound(positions[strand.guide].xyz, reach);
        var free = 0.0;
        var moving = rods[slot(strand, strand.held, MOVING)].xyz;
        for (var edge = strand.held; edge < strand.edges; edge++) {
            let end_moving = rods[slot(strand, edge + 1u, MOVING)].xyz;
            free -= length_of(strand, edge);
            if (free <= 0.0) {
                let contacts = contacts_of(strand.root_now, edge_of(strand, edge, moving, end_moving), last_touch(strand, edge), 1.0);
                touched.any = touched.any || contacts.touch.obstacle > 0u;
                touched.deep = touched.deep || contacts.touch.is_deep;
                free = contacts.clearance - furthest;
            }
            moving = end_moving;
        }
    }
    return touched;
}

/// Notes what each edge touches, in place of what the elimination has left, and says whether any of it is new.
fn note_touches(strand: Strand, touches: bool) -> bool {
    var is_new = false;
    @if(contacts) {
        for (var edge = 0u; edge < strand.edges; edge++) {
            var stretch = vec4(0.0);
            var obstacle = 0u;
            if (touches && edge >= strand.held) {
                let moving = rods[slot(strand, edge, MOVING)].xyz;
                let end_moving = rods[slot(strand, edge + 1u, MOVING)].xyz;
                let last = last_touch(strand, edge);
                let touch = contacts_of(strand.root_now, edge_of(strand, edge, moving, end_moving), last, 1.0).touch;
                obstacle = touch.obstacle;
                if (obstacle > 0u) { stretch = vec4(touch.stretch, packed_direction(touch.normal)); }
                is_new = is_new || (obstacle > 0u && obstacle != last.obstacle);
            }
            rods[slot(strand, edge, BY_PLACE)] = stretch;
            rods[slot(strand, edge, BY_PLACE + 1u)] = vec4(f32(obstacle), 0.0, 0.0, 0.0);
        }
    }
    return is_new;
}

/// Keeps what the edge before a vertex touches; zeros of a strand that touches nothing.
fn keep_touch(strand: Strand, vertex: u32) {
    @if(contacts) {
        let stretch = rods[slot(strand, vertex - 1u, BY_PLACE)];
        rods[slot(strand, vertex, MOVED)].w = stretch.x;
        rods[slot(strand, vertex, VELOCITY)].w = stretch.y;
        rods[slot(strand, vertex, LAST_VELOCITY)].w = stretch.z;
        rods[slot(strand, vertex, STRAIN)].w = stretch.w;
        rods[slot(strand, vertex, LAST_STRAIN)].w = rods[slot(strand, vertex - 1u, BY_PLACE + 1u)].x;
    }
}

/// Stores the state that the next sub-step begins with, and the positions. Says whether they are finite.
fn finish(strand: Strand, calm: bool) -> bool {
    var place = strand.root_now;
    var finite = true;
    for (var i = 0u; i < step.vertices; i++) {
        let moving = rods[slot(strand, i, MOVING)].xyz;
        var velocity = moving / step.length;
        if (calm) {
            var past = vec3(0.0);
            if (strand.has_past) { past = rods[slot(strand, i, MOVED)].xyz / 3.0; }
            velocity = (moving - past) / strand.length;
        }
        rods[slot(strand, i, LAST_VELOCITY)] = vec4(rods[slot(strand, i, VELOCITY)].xyz, 0.0);
        rods[slot(strand, i, VELOCITY)] = vec4(velocity, select(0.0, 1.0, calm));
        rods[slot(strand, i, MOVED)] = vec4(moving, 0.0);
        let then = positions[i * step.strands + strand.guide];
        if (i == strand.edges) { keep_hold(strand, then.xyz - step.center_displacement + moving); }
        positions[i * step.strands + strand.guide] = vec4(place, then.w);
        finite = finite && is_finite(place) && is_finite(velocity);
        if (i < strand.edges) {
            let now = rods[slot(strand, i, NOW)];
            rods[slot(strand, i, FRAME)] = now;
            place += length_of(strand, i) * along(now);
        }
    }
    store_strains(strand, true);
    for (var i = 1u; i < step.vertices; i++) { keep_touch(strand, i); }
    return finite;
}

/// The stiffness of the spring that holds a pinned tip; 0 where the tip is free.
fn hold_stiffness(strand: Strand) -> f32 {
    @if(!pinned_tips) { return 0.0; }
    @if(pinned_tips) { return strand.tip_pinned * HOLD * 0.5 * length_of(strand, strand.edges - 1u); }
}

/// Where a pinned tip is held.
fn hold_place(strand: Strand) -> vec3<f32> {
    return shape_of(strand.root, rest[strand.edges * step.guides + strand.guide].xyz);
}

/// The force that a pinned tip has come to takes up what the spring leaves.
fn keep_hold(strand: Strand, place: vec3<f32>) {
    @if(pinned_tips) {
        let more = hold_stiffness(strand) * (hold_place(strand) - place);
        rods[slot(strand, strand.edges, FRAME)] += vec4(more, 0.0);
    }
}

/// The rotation by an angle about an axis, given as their product.
fn rotation_by(v: vec3<f32>) -> vec4<f32> {
    let angle = sqrt(dot(v, v));
    // sin(x / 2) / x and its limit.
    let share = select(0.5, sin(0.5 * angle) / angle, angle > 1e-3);
    return vec4(share * v, cos(0.5 * angle));
}

/// The matrix of `v x`.
fn cross_matrix(v: vec3<f32>) -> mat3x3<f32> {
    return mat3x3(vec3(0.0, v.z, -v.y), vec3(-v.z, 0.0, v.x), vec3(v.y, -v.x, 0.0));
}

fn symmetric(m: mat3x3<f32>) -> mat3x3<f32> {
    return 0.5 * (m + transpose(m));
}

/// The inverse of a symmetric matrix. Its trace is taken out first: of the shortest strands the determinant alone would be 0 in f32.
fn inverse_of(m: mat3x3<f32>) -> mat3x3<f32> {
    let size = 1.0 / (m[0].x + m[1].y + m[2].z);
    let a = size * m[0];
    let b = size * m[1];
    let c = size * m[2];
    let first = cross(b, c);
    let share = size / dot(a, first);
    return mat3x3(share * first, share * cross(c, a), share * cross(a, b));
}
