// Collision with tapered capsules that move with the head, from the root to the tip. One thread a guide.
//
// A vertex inside a capsule is not pushed but turned out about its parent, and what hangs on it follows, so that every edge
// keeps its length. Strands that touch nothing stay as they are, to the bit.
//
// A vertex that is so far from all capsules that the next ones cannot have got there is the last to be looked at for a while.

import package::capsule::{GROWTH, GpuCapsule, about, clearance, nearest, slid, turned_out};
import package::constants::{GUIDES, STRANDS, VERTICES};
import package::grid::{GROUP, thread_index};
import package::step::Step;
import package::vector::{direction_or, rotate, rotate_back};

@group(0) @binding(0) var<uniform> step: Step;
/// In the space of the rest pose, about the centre of the groom.
@group(0) @binding(1) var<storage, read> capsules: array<GpuCapsule>;
@group(0) @binding(2) var<storage, read> rest_lengths: array<f32>;
@group(0) @binding(3) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> positions: array<vec4<f32>>;

/// A vertex that leaves one capsule may enter another.
const ROUNDS: u32 = 5u;
/// What a round leaves to the next one of how far it may turn: else each would multiply the errors of the one before.
const NEXT_ROUND: f32 = 0.25;
/// As a share of the edge: after less than that nothing is looked at again.
const LEAST_TURN: f32 = 1e-5;
/// Share of the squared radius within which a vertex is inside: one that was put on the surface is not inside of it.
const INSIDE: f32 = 0.999999;
/// The way of an edge that has none.
const DOWN = vec3<f32>(0.0, -1.0, 0.0);
/// Further than any groom extends.
const FAR: f32 = 1e30;
/// Of a clearance, what rounding leaves certain.
const CERTAIN: f32 = 0.999;

/// `kept` is the way that the point has made in the sub-step, as the head sees it, less what contacts have taken from it. Turns
/// start from `heading`, and `left` is the share of their bound that is left. The point is at least `clear` away from all capsules, if
/// it has not touched any.
struct Contact { point: vec3<f32>, touched: bool, kept: vec3<f32>, clear: f32, heading: vec3<f32>, left: f32 }

/// What a round does: the capsules from `first` up to `last` are looked at, `hits` of them held the point, the last of those is `hit`,
/// `gone` is how far the point has been turned, and it was at least `others` away from all that did not hold it.
struct Round { first: u32, last: u32, hits: u32, hit: u32, gone: f32, others: f32 }

@compute @workgroup_size(GROUP)
fn collide(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= GUIDES) { return; }
    // Contacts are found about the root, so that roundings are those of what is near, see `length`.
    let root = positions[strand].xyz;
    // The parent before and after this kernel.
    var old_parent = root;
    var parent = root;
    var moved = false;
    var clear = 0.0;
    for (var i = 1u; i < VERTICES; i++) {
        let vertex = positions[i * STRANDS + strand];
        var point = vertex.xyz;
        moved = moved && vertex.w > 0.0;
        if (moved) { point = parent + edge_length(i, strand) * direction_or(vertex.xyz - parent, DOWN); }
        clear -= distance(point, parent);
        if (clear <= 0.0 && vertex.w > 0.0) {
            let length = edge_length(i, strand);
            let edge = in_head(vertex.xyz - old_parent);
            let contact = resolved(root, in_head(parent - root), in_head(point - root), length, edge, i * GUIDES + strand);
            if (contact.touched) {
                point = root + in_world(contact.point);
                let past = rotate_back(step.turn, root + in_world(contact.point - contact.kept)) - step.shift;
                previous[i * GUIDES + strand] = vec4(past, 0.0);
            }
            moved = moved || contact.touched;
            clear = CERTAIN * contact.clear;
        }
        if (moved) { positions[i * STRANDS + strand] = vec4(point, vertex.w); }
        old_parent = vertex.xyz;
        parent = point;
    }
}

/// Of the edge from the parent of a vertex.
fn edge_length(vertex: u32, strand: u32) -> f32 {
    return rest_lengths[(vertex - 1u) * GUIDES + strand];
}

/// Where a vertex is when it has left all capsules, about the root and seen from the head. `edge` is the way that its edge had
/// before anything moved, `past` the place of its past.
///
/// Every contact takes its share of the velocity, as deep as it is: between two capsules a vertex is turned back and forth, and no
/// contact stands for all.
fn resolved(root: vec3<f32>, parent: vec3<f32>, start: vec3<f32>, length: f32, edge: vec3<f32>, past: u32) -> Contact {
    let origin = in_head(root);
    var contact = Contact(start, false, vec3(0.0), 0.0, direction_or(edge, DOWN), 1.0);
    var round = Round(0u, arrayLength(&capsules), 0u, 0u, 0.0, FAR);
    for (var count = 0u; count < ROUNDS; count++) {
        for (var i = round.first; i < round.last; i++) {
            let capsule = about(origin, capsules[i]);
            let sphere = nearest(capsule, contact.point);
            let from_center = contact.point - sphere.xyz;
            if (dot(from_center, from_center) < INSIDE * sphere.w * sphere.w) {
                if (!contact.touched) { contact.kept = start - in_head(carried(previous[past].xyz) - root); }
                round.gone += leave(&contact, parent, length, sphere);
                round.hits += 1u;
                round.hit = i;
                if (CERTAIN * round.others <= round.gone) { round.last = arrayLength(&capsules); }
            } else {
                round.others = min(round.others, clearance(capsule, contact.point, sphere));
            }
        }
        if (!contact.touched) { contact.clear = round.others; }
        if (round.gone <= LEAST_TURN * length) { break; }
        contact.left *= NEXT_ROUND;
        round = following(round);
    }
    return contact;
}

/// The round after this one. Capsules that the point cannot have got to are not looked at, unless that round takes it further.
fn following(round: Round) -> Round {
    let others = CERTAIN * round.others - round.gone;
    if (round.hits == 1u && others > 0.0) { return Round(round.hit, round.hit + 1u, 0u, 0u, 0.0, others); }
    return Round(0u, arrayLength(&capsules), 0u, 0u, 0.0, FAR);
}

/// Turns a vertex out of a capsule, and says how far.
///
/// The deeper it is, the more the turn starts from the way that its edge had before anything moved. The way to where the vertex was
/// would not do: where a strand crosses a sphere nearly at right angles, each vertex would be turned to the other side than its
/// parent, by errors that grow. The old way alone would not do either: what is only just touched is to be only just turned.
fn leave(contact: ptr<function, Contact>, parent: vec3<f32>, length: f32, sphere: vec4<f32>) -> f32 {
    let before = direction_or((*contact).point - parent, DOWN);
    let apart = length * distance(before, (*contact).heading);
    let depth = sphere.w - distance((*contact).point, sphere.xyz);
    let weight = min(GROWTH * depth / max(apart, 1e-12), 1.0);
    let turn = turned_out(parent, mix(before, (*contact).heading, weight), length, sphere, (*contact).left);
    let pushed = turn.point - (*contact).point;
    let normal = direction_or(turn.point - sphere.xyz, vec3(0.0));
    (*contact).kept = slid((*contact).kept + pushed, normal, max(dot(pushed, normal), 0.0), step.friction);
    (*contact).point = turn.point;
    (*contact).touched = true;
    (*contact).heading = mix((*contact).heading, direction_or(turn.point - parent, DOWN), weight);
    (*contact).left *= 1.0 - turn.share;
    return sqrt(dot(pushed, pushed));
}

/// Where the head's motion takes a point. It carries the capsules.
fn carried(point: vec3<f32>) -> vec3<f32> {
    return rotate(step.turn, point + step.shift);
}

fn in_head(point: vec3<f32>) -> vec3<f32> {
    return rotate_back(step.head_rotation, point);
}

fn in_world(point: vec3<f32>) -> vec3<f32> {
    return rotate(step.head_rotation, point);
}
