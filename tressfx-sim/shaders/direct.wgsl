// A rod whose edges turn and never stretch, in one implicit sub-step: the rotations of all edges of a strand are found at once, by
// Newton's method with elimination from the tip to the root and back. One thread a guide. Forces are per mass of unit length, and
// times the square of the sub-step.

import package::grid::{GROUP, thread_index};
import package::joint::{Stiffness, joint_between, outer, scaled_identity, stiffness_of, torque_of};
import package::root::{Root, root_of, shape_of};
import package::step::step;
import package::vector::{after, direction_or, is_finite, rotate, turned};
import package::wind::wind_of;

@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> rest_lengths: array<f32>;
/// Two for each vertex: half of the rotation that the joint before its edge wants, and the frame of the edge at rest. The tip has no edge;
/// its first has what the strand's bending is multiplied by, how many edges the root holds, the shortest length that bends, and 1 if the
/// tip is pinned.
@group(0) @binding(3) var<storage, read> rod_rest: array<vec4<f32>>;
/// The state, `STATE` for each vertex.
@group(0) @binding(4) var<storage, read_write> rods: array<vec4<f32>>;
/// What the sweeps leave for each other, `SCRATCH` for each vertex.
@group(0) @binding(5) var<storage, read_write> rod_scratch: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> positions: array<vec4<f32>>;
/// Strands that were reset because they had become non-finite.
@group(0) @binding(7) var<storage, read_write> non_finite: atomic<u32>;

/// Frame of the edge, at the tip the force that holds it; what the vertex moved by in the last sub-step; its velocity, and at the root whether the past counts; its
/// velocity before; the strain of the joint, and before.
const STATE: u32 = 6u;
const FRAME: u32 = 0u;
const MOVED: u32 = 1u;
const VELOCITY: u32 = 2u;
const LAST_VELOCITY: u32 = 3u;
const STRAIN: u32 = 4u;
const LAST_STRAIN: u32 = 5u;

/// The frame of the edge and what the vertex has moved by in this sub-step, as far as they are known; what is left of the edge
/// after the elimination: its rotation, and by the columns of two matrices what of it its parent's rotation and the
/// displacement of the vertex before it make.
const SCRATCH: u32 = 9u;
const NOW: u32 = 0u;
const MOVING: u32 = 1u;
const FREE: u32 = 2u;
const BY_PARENT: u32 = 3u;
const BY_PLACE: u32 = 6u;

/// How stiff the spring is that holds a pinned tip, over the mass of the tip.
const HOLD: f32 = 1e4;
/// The longest rotation of an edge in a round, rad.
const LONGEST_TURN: f32 = 1.5;
/// Where an edge turns by more than this in the last round, rad, the strand's past says little about its future.
const TOO_FAST: f32 = 0.5;
/// There is another round where an edge turns by more than this, rad/s times the length of the sub-step,
const ANOTHER_ROUND: f32 = 2.0;
/// and in sub-steps shorter than this, s, by less, as their square.
const SHORT: f32 = 1.0 / 120.0;

/// What is the same for a whole strand.
struct Strand {
    guide: u32,
    root: Root,
    /// Edges that the root holds.
    held: u32,
    edges: u32,
    bending: f32,
    shortest_span: f32,
    mass_correction: f32,
    wind: vec3<f32>,
    /// 1 where the tip is pinned.
    tip_pinned: f32,
    has_past: bool,
    /// The length that the formula in time divides by.
    length: f32,
    /// What gravity makes of the sub-step.
    fall: vec3<f32>,
}

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
    var turn = 0.0;
    for (var round = 0u; round < step.rounds; round++) {
        eliminate(strand);
        turn = substitute(strand);
        if (turn < ANOTHER_ROUND * step.length * min(step.length / SHORT, 1.0)) { break; }
    }
    if (!finish(strand, turn < TOO_FAST)) {
        rest_again(strand);
        atomicAdd(&non_finite, 1u);
    }
}

fn strand_of(guide: u32) -> Strand {
    let tip = rod_rest[2u * (step.vertices - 1u) * step.guides + guide];
    let has_past = step.first_order == 0u && rods[VELOCITY * step.guides + guide].w > 0.5;
    var strand: Strand;
    strand.guide = guide;
    strand.root = root_of(guide);
    strand.held = u32(tip.y);
    strand.edges = step.vertices - 1u;
    strand.bending = step.bending * tip.x;
    strand.shortest_span = tip.z;
    strand.mass_correction = select(5.0 / 6.0, 1.0, step.vertices == 2u) / 6.0;
    strand.wind = wind_of(guide);
    strand.has_past = has_past;
    strand.tip_pinned = tip.w;
    strand.length = select(step.length, step.length * (2.0 / 3.0), has_past);
    strand.fall = step.gravity * select(1.0, 4.0 / 9.0, has_past);
    return strand;
}

fn state(strand: Strand, vertex: u32, slot: u32) -> u32 {
    return (vertex * STATE + slot) * step.guides + strand.guide;
}

fn scratch(strand: Strand, vertex: u32, slot: u32) -> u32 {
    return (vertex * SCRATCH + slot) * step.guides + strand.guide;
}

fn length_of(strand: Strand, edge: u32) -> f32 {
    return rest_lengths[edge * step.guides + strand.guide];
}

fn half_turn(strand: Strand, edge: u32) -> vec4<f32> {
    return rod_rest[2u * edge * step.guides + strand.guide];
}

fn frame_at_rest(strand: Strand, edge: u32) -> vec4<f32> {
    return after(strand.root.rotation, rod_rest[(2u * edge + 1u) * step.guides + strand.guide]);
}

fn along(frame: vec4<f32>) -> vec3<f32> {
    return rotate(frame, vec3(0.0, 0.0, 1.0));
}

/// The strand goes to its rest pose, at rest.
fn rest_again(strand: Strand) {
    for (var i = 0u; i < step.vertices; i++) {
        let vertex = rest[i * step.guides + strand.guide];
        positions[i * step.strands + strand.guide] = vec4(shape_of(strand.root, vertex.xyz), vertex.w);
        for (var slot = FRAME; slot < STATE; slot++) { rods[state(strand, i, slot)] = vec4(0.0); }
        if (i < strand.edges) { rods[state(strand, i, FRAME)] = frame_at_rest(strand, i); }
    }
    store_strains(strand, FRAME, false);
}

/// Stores the strains of all joints; the ones before them are kept, or are the same.
fn store_strains(strand: Strand, slot: u32, keep: bool) {
    @if(internal_damping) {
        var parent = strand.root.rotation;
        for (var edge = 0u; edge < strand.edges; edge++) {
            let frame = rods[state(strand, edge, slot)];
            let strain = vec4(joint_between(parent, half_turn(strand, edge), frame).strain, 0.0);
            rods[state(strand, edge, LAST_STRAIN)] = select(strain, rods[state(strand, edge, STRAIN)], keep);
            rods[state(strand, edge, STRAIN)] = strain;
            parent = frame;
        }
    }
}

/// The guess that Newton's method begins with: each edge is turned, the shortest way, to where its vertices would get with their
/// velocities.
fn aim(strand: Strand) {
    let root_now = shape_of(strand.root, rest[strand.guide].xyz);
    var moving = root_now - positions[strand.guide].xyz + step.center_displacement;
    var begin = step.length * rods[state(strand, 0u, VELOCITY)].xyz;
    rod_scratch[scratch(strand, 0u, MOVING)] = vec4(moving, 0.0);
    for (var edge = 0u; edge < strand.edges; edge++) {
        let length = length_of(strand, edge);
        let frame = rods[state(strand, edge, FRAME)];
        let here = along(frame);
        let to = step.length * rods[state(strand, edge + 1u, VELOCITY)].xyz;
        var now = frame_at_rest(strand, edge);
        if (edge >= strand.held) {
            let start = select(begin, moving, edge == strand.held);
            now = turned(frame, here, direction_or(length * here + to - start, here));
        }
        // From two directions, not from two places, which would lose more.
        moving += length * (along(now) - here);
        begin = to;
        rod_scratch[scratch(strand, edge, NOW)] = now;
        rod_scratch[scratch(strand, edge + 1u, MOVING)] = vec4(moving, 0.0);
    }
}

/// A vertex: where the past says that it would be without forces, and with gravity alone, from where it is.
struct Pulled { place: vec3<f32>, free: vec3<f32> }

fn pulled(strand: Strand, vertex: u32, moving: vec3<f32>) -> Pulled {
    let velocity = rods[state(strand, vertex, VELOCITY)].xyz;
    var place = -moving;
    var kept = velocity;
    if (strand.has_past) {
        place += rods[state(strand, vertex, MOVED)].xyz / 3.0;
        kept = (4.0 * velocity - rods[state(strand, vertex, LAST_VELOCITY)].xyz) / 3.0;
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
fn eliminate(strand: Strand) {
    let tip = strand.edges;
    var length = length_of(strand, tip - 1u);
    var frame = rod_scratch[scratch(strand, tip - 1u, NOW)];
    var axis = along(frame);
    var moving = rod_scratch[scratch(strand, tip, MOVING)].xyz;
    var after_edge = pulled(strand, tip, moving);
    let last = inertia(strand, tip, 0.5 * length, after_edge, moving, axis);
    let spring = hold_stiffness(strand);
    let hold = rods[state(strand, tip, FRAME)].xyz;
    let gap = hold_place(strand) - positions[tip * step.strands + strand.guide].xyz + step.center_displacement - moving;
    var place = last.mass + scaled_identity(spring);
    var mixed = scaled_identity(0.0);
    var turn = scaled_identity(0.0);
    var force = last.force + hold + spring * gap;
    var torque = vec3(0.0);
    // The force that the tip has come to is held with, not that of the spring, which changes its sign from round to round.
    var pull = last.force + hold;
    for (var edge = tip; edge > strand.held; ) {
        edge--;
        var length_before = 0.0;
        var parent = strand.root.rotation;
        var direction = axis;
        if (edge > 0u) {
            length_before = length_of(strand, edge - 1u);
            parent = rod_scratch[scratch(strand, edge - 1u, NOW)];
            direction = along(parent);
        }
        moving = rod_scratch[scratch(strand, edge, MOVING)].xyz;
        let before_edge = pulled(strand, edge, moving);

        // The vertex after the edge moves by the one before it and `arm * rotation`.
        let arm = -length * cross_matrix(axis);
        let back = transpose(arm);
        let across = scaled_identity(1.0) - outer(axis, axis);
        let half = back * mixed;
        turn += half + transpose(half) + back * place * arm;
        torque += back * force;
        mixed += place * arm;
        // Tension pulls an edge straight; pressure would let it fall, and is left out.
        let correction = strand.mass_correction * length;
        turn += (length * max(dot(axis, pull), 0.0) - correction * length * length) * across;
        torque -= correction * (back * (after_edge.free - before_edge.free));

        let joined = select(0.0, length_before, edge > strand.held);
        let span = max(0.5 * (joined + length), strand.shortest_span);
        let joint = joint_between(parent, half_turn(strand, edge), frame);
        let bending = strand.bending / span * strand.length * strand.length;
        let stiffness = Stiffness(bending, step.twist_ratio, step.internal_damping / strand.length);
        let own = torque_of(joint, stiffness, past_strain(strand, edge, joint.strain));
        let spring = stiffness_of(joint, stiffness);

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
        let last = rods[state(strand, edge, STRAIN)].xyz;
        let before = rods[state(strand, edge, LAST_STRAIN)].xyz;
        return select(last, (4.0 * last - before) / 3.0, strand.has_past);
    }
}

fn store(strand: Strand, edge: u32, free: vec3<f32>, by_parent: mat3x3<f32>, by_place: mat3x3<f32>) {
    rod_scratch[scratch(strand, edge, FREE)] = vec4(free, 0.0);
    rod_scratch[scratch(strand, edge, BY_PARENT)] = vec4(by_parent[0], 0.0);
    rod_scratch[scratch(strand, edge, BY_PARENT + 1u)] = vec4(by_parent[1], 0.0);
    rod_scratch[scratch(strand, edge, BY_PARENT + 2u)] = vec4(by_parent[2], 0.0);
    rod_scratch[scratch(strand, edge, BY_PLACE)] = vec4(by_place[0], 0.0);
    rod_scratch[scratch(strand, edge, BY_PLACE + 1u)] = vec4(by_place[1], 0.0);
    rod_scratch[scratch(strand, edge, BY_PLACE + 2u)] = vec4(by_place[2], 0.0);
}

/// From the root to the tip: turns each edge. Gives the longest rotation, rad.
fn substitute(strand: Strand) -> f32 {
    var shift = vec3(0.0);
    var parent = vec3(0.0);
    var moving = rod_scratch[scratch(strand, strand.held, MOVING)].xyz;
    var longest = 0.0;
    for (var edge = strand.held; edge < strand.edges; edge++) {
        let length = length_of(strand, edge);
        var rotation = rod_scratch[scratch(strand, edge, FREE)].xyz
            + columns(strand, edge, BY_PARENT) * parent
            - columns(strand, edge, BY_PLACE) * shift;
        let size = sqrt(dot(rotation, rotation));
        rotation *= min(1.0, LONGEST_TURN / max(size, LONGEST_TURN));
        longest = max(longest, min(size, LONGEST_TURN));
        let frame = rod_scratch[scratch(strand, edge, NOW)];
        let now = normalize(after(rotation_by(rotation), frame));
        shift += length * cross(rotation, along(frame));
        moving += length * (along(now) - along(rods[state(strand, edge, FRAME)]));
        rod_scratch[scratch(strand, edge, NOW)] = now;
        rod_scratch[scratch(strand, edge + 1u, MOVING)] = vec4(moving, 0.0);
        parent = rotation;
    }
    return longest;
}

fn columns(strand: Strand, edge: u32, first: u32) -> mat3x3<f32> {
    return mat3x3(
        rod_scratch[scratch(strand, edge, first)].xyz,
        rod_scratch[scratch(strand, edge, first + 1u)].xyz,
        rod_scratch[scratch(strand, edge, first + 2u)].xyz,
    );
}

/// Stores the state that the next sub-step begins with, and the positions. Says whether they are finite.
fn finish(strand: Strand, calm: bool) -> bool {
    var place = shape_of(strand.root, rest[strand.guide].xyz);
    var finite = true;
    for (var i = 0u; i < step.vertices; i++) {
        let moving = rod_scratch[scratch(strand, i, MOVING)].xyz;
        var velocity = moving / step.length;
        if (calm) {
            var past = vec3(0.0);
            if (strand.has_past) { past = rods[state(strand, i, MOVED)].xyz / 3.0; }
            velocity = (moving - past) / strand.length;
        }
        rods[state(strand, i, LAST_VELOCITY)] = vec4(rods[state(strand, i, VELOCITY)].xyz, 0.0);
        rods[state(strand, i, VELOCITY)] = vec4(velocity, select(0.0, 1.0, calm));
        rods[state(strand, i, MOVED)] = vec4(moving, 0.0);
        let then = positions[i * step.strands + strand.guide];
        if (i == strand.edges) { keep_hold(strand, then.xyz - step.center_displacement + moving); }
        positions[i * step.strands + strand.guide] = vec4(place, then.w);
        finite = finite && is_finite(place) && is_finite(velocity);
        if (i < strand.edges) {
            let now = rod_scratch[scratch(strand, i, NOW)];
            rods[state(strand, i, FRAME)] = now;
            place += length_of(strand, i) * along(now);
        }
    }
    store_strains(strand, FRAME, true);
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
        rods[state(strand, strand.edges, FRAME)] += vec4(more, 0.0);
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
