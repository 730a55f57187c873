// Collision with tapered capsules, from the root to the tip. One thread a guide.
//
// A vertex inside a capsule is rotated about its parent towards the outside, as far as the limit of this sub-step allows.
// The vertices after it are placed again at their distance from their parent, so that every edge keeps its length. A strand
// that touches no capsule is not written.
//
// Most vertices are far from all capsules. If the nearest capsule is at the distance `free_distance` from a vertex, the
// vertices after it need no test for that length of the strand.

import package::capsule::{GpuCapsule, GpuCapsuleMotion, TURN_LIMIT, clearance, nearest, origin_of, relative_to, slid, turned_out};
import package::grid::{GROUP, thread_index};
import package::root::{Root, carried_from, root_of};
import package::step::step;
import package::vector::{DOWN, direction_or, rotate, rotate_back};

/// Capsules at the end of the sub-step, in the space of the rest pose, relative to the centre of the groom.
@group(0) @binding(1) var<storage, read> capsules: array<GpuCapsule>;
/// How each of them has moved during the sub-step.
@group(0) @binding(2) var<storage, read> capsule_motions: array<GpuCapsuleMotion>;
@group(0) @binding(3) var<storage, read> rest_lengths: array<f32>;
@group(0) @binding(4) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> positions: array<vec4<f32>>;

/// The most times that all capsules are tested for a vertex: one that leaves a capsule may enter another.
const ROUNDS: u32 = 5u;
/// The limit on turns is multiplied by this from round to round. Otherwise each round would amplify the rounding errors
/// of the round before. (A round is one pass over the capsules.)
const LIMIT_PER_ROUND: f32 = 0.25;
/// A round that turns a vertex by less than this share of its edge is the last one.
const MIN_TURN: f32 = 1e-5;
/// A vertex is inside if its squared distance is less than this share of the squared radius. So a vertex on the surface is
/// outside, in spite of rounding.
const INSIDE: f32 = 0.999999;
/// Larger than any groom.
const FAR: f32 = 1e30;
/// A computed clearance is multiplied by this, so that rounding cannot make it too large.
const CERTAIN: f32 = 0.999;

/// A vertex that is being moved out of the capsules. Vectors are on the axes of the head, points relative to the root of the
/// strand.
struct Contact {
    point: vec3<f32>,
    /// Whether any capsule held the vertex.
    touched: bool,
    /// The vertex's displacement from its previous position, less what contacts and friction have removed.
    displacement: vec3<f32>,
    /// Distance to the nearest capsule, or less, if none was touched.
    free_distance: f32,
    /// The direction of the edge that rotations start from if the vertex is deep inside, see `leave`.
    heading: vec3<f32>,
    /// The share of the limit on turns that is not used yet.
    unused_share: f32,
}

/// One pass over the capsules from `first_capsule` up to `end_capsule`, without `end_capsule`.
struct Round {
    first_capsule: u32,
    end_capsule: u32,
    /// How many capsules the vertex was inside of.
    hit_count: u32,
    /// The last of them.
    last_hit: u32,
    /// The length that the turns moved the vertex by in all.
    moved_distance: f32,
    /// The vertex was at least this far from every capsule that it was not inside of.
    min_clearance: f32,
}

@compute @workgroup_size(GROUP)
fn collide(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= step.guides) { return; }
    // Contacts are computed relative to the root: small numbers have small rounding errors, see `lengths`.
    let root = positions[strand].xyz;
    // The parent before and after this kernel.
    var old_parent = root;
    var parent = root;
    var moved = false;
    var free_distance = 0.0;
    for (var i = 1u; i < step.vertices; i++) {
        let vertex = positions[i * step.strands + strand];
        var point = vertex.xyz;
        moved = moved && vertex.w > 0.0;
        if (moved) { point = parent + edge_length(i, strand) * direction_or(vertex.xyz - parent, DOWN); }
        free_distance -= distance(point, parent);
        if (free_distance <= 0.0 && vertex.w > 0.0) {
            let length = edge_length(i, strand);
            let edge = in_head(vertex.xyz - old_parent);
            let contact = resolved(root, in_head(parent - root), in_head(point - root), length, edge, i, strand);
            if (contact.touched) {
                point = root + in_world(contact.point);
                let past = root + in_world(contact.point - contact.displacement);
                previous[i * step.guides + strand] = vec4(past, 0.0);
            }
            moved = moved || contact.touched;
            free_distance = CERTAIN * contact.free_distance;
        }
        if (moved) { positions[i * step.strands + strand] = vec4(point, vertex.w); }
        old_parent = vertex.xyz;
        parent = point;
    }
}

/// Rest length of the edge from the parent of a vertex.
fn edge_length(vertex: u32, strand: u32) -> f32 {
    return rest_lengths[(vertex - 1u) * step.guides + strand];
}

/// Moves a vertex out of the capsules, within the limit on rotations. `edge` is the edge from its parent before this kernel
/// moved anything.
///
/// Each contact removes its own part of the displacement; the part grows with the depth of the vertex. The contacts are not
/// merged into one, because between two capsules a vertex is rotated back and forth.
fn resolved(root: vec3<f32>, parent: vec3<f32>, start: vec3<f32>, length: f32, edge: vec3<f32>, vertex: u32, strand: u32) -> Contact {
    let origin = in_head(root);
    var contact = Contact(start, false, vec3(0.0), 0.0, direction_or(edge, DOWN), 1.0);
    var round = Round(step.first_capsule, step.end_capsule, 0u, 0u, 0.0, FAR);
    for (var count = 0u; count < ROUNDS; count++) {
        for (var i = round.first_capsule; i < round.end_capsule; i++) {
            let capsule = relative_to(origin, capsules[i]);
            let sphere = nearest(capsule, contact.point);
            let from_center = contact.point - sphere.xyz;
            if (dot(from_center, from_center) < INSIDE * sphere.w * sphere.w) {
                if (!contact.touched) {
                    contact.displacement = start - in_head(previous[vertex * step.guides + strand].xyz - root);
                }
                let surface = surface_displacement(root, contact.point, i, strand);
                round.moved_distance += leave(&contact, parent, length, sphere, surface);
                round.hit_count += 1u;
                round.last_hit = i;
                if (CERTAIN * round.min_clearance <= round.moved_distance) { round.end_capsule = step.end_capsule; }
            } else {
                round.min_clearance = min(round.min_clearance, clearance(capsule, contact.point, sphere));
            }
        }
        if (!contact.touched) { contact.free_distance = round.min_clearance; }
        if (round.moved_distance <= MIN_TURN * length) { break; }
        contact.unused_share *= LIMIT_PER_ROUND;
        round = next_round(round);
    }
    return contact;
}

/// The round after this one. If the vertex was inside of one capsule only, and the rotations so far cannot have moved it to
/// another, the next round tests that one capsule only; if the vertex moves too far in it, `resolved` tests the capsules
/// after it too.
fn next_round(round: Round) -> Round {
    let min_clearance = CERTAIN * round.min_clearance - round.moved_distance;
    if (round.hit_count == 1u && min_clearance > 0.0) {
        return Round(round.last_hit, round.last_hit + 1u, 0u, 0u, 0.0, min_clearance);
    }
    return Round(step.first_capsule, step.end_capsule, 0u, 0u, 0.0, FAR);
}

/// Rotates a vertex out of a capsule and returns how far it moves. `surface` is the displacement of the capsule's surface.
///
/// The rotation starts from the present edge if the vertex is only just inside, from the edge before this kernel if it is
/// deep inside, and from a mix of the two between. Why not from the present edge always: where a strand crosses a sphere
/// nearly at right angles, each vertex would be rotated to the opposite side of its parent, and the errors would grow. Why
/// not from the earlier edge always: a vertex that is only just inside must be rotated only a little.
fn leave(contact: ptr<function, Contact>, parent: vec3<f32>, length: f32, sphere: vec4<f32>, surface: vec3<f32>) -> f32 {
    let before = direction_or((*contact).point - parent, DOWN);
    let apart = length * distance(before, (*contact).heading);
    let depth = sphere.w - distance((*contact).point, sphere.xyz);
    let weight = min(TURN_LIMIT * depth / max(apart, 1e-12), 1.0);
    let turn = turned_out(parent, mix(before, (*contact).heading, weight), length, sphere, (*contact).unused_share);
    let pushed = turn.point - (*contact).point;
    let normal = direction_or(turn.point - sphere.xyz, vec3(0.0));
    let relative = (*contact).displacement + pushed - surface;
    (*contact).displacement = surface + slid(relative, normal, max(dot(pushed, normal), 0.0), step.friction);
    (*contact).point = turn.point;
    (*contact).touched = true;
    (*contact).heading = mix((*contact).heading, direction_or(turn.point - parent, DOWN), weight);
    (*contact).unused_share *= 1.0 - turn.used_share;
    return sqrt(dot(pushed, pushed));
}

/// The displacement of a capsule's surface at a point, which is relative to the root. Like the displacement of a vertex it
/// leaves out the share of the root's motion that `velocity_shock` has added to the vertex's previous position.
fn surface_displacement(root: vec3<f32>, point: vec3<f32>, capsule: u32, strand: u32) -> vec3<f32> {
    let here = root + in_world(point);
    let own = in_head(here) - origin_of(capsule_motions[capsule], in_head(here));
    let with_head = here - rotate_back(step.head_turn, here) + step.center_displacement;
    let with_root = here - carried_from(root_of(strand), here) + step.center_displacement;
    return own + in_head(with_head - step.shock * with_root);
}

fn in_head(point: vec3<f32>) -> vec3<f32> {
    return rotate_back(step.head_rotation, point);
}

fn in_world(point: vec3<f32>) -> vec3<f32> {
    return rotate(step.head_rotation, point);
}
