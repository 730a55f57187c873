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
/// Further than any groom extends.
const FAR: f32 = 1e30;
/// Of a clearance, what rounding leaves certain.
const CERTAIN: f32 = 0.999;

/// `kept` is the way that the point has made in the sub-step, as the head sees it, less what contacts have taken from it. `clear`
/// is how far the point is from all capsules, if it has not touched any.
struct Contact { point: vec3<f32>, touched: bool, kept: vec3<f32>, clear: f32 }

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
        clear -= distance(point, parent);
        if (clear > 0.0 && !moved) {
            old_parent = point;
            parent = point;
            continue;
        }
        if (vertex.w > 0.0) {
            let length = rest_lengths[(i - 1u) * GUIDES + strand];
            if (moved) { point = parent + length * direction_or(vertex.xyz - parent, vec3(0.0, -1.0, 0.0)); }
            let heading = rotate_back(step.head_rotation, vertex.xyz - old_parent);
            let contact = resolved(root, in_head(parent - root), in_head(point - root), length, heading, i * GUIDES + strand);
            if (contact.touched) {
                point = root + in_world(contact.point);
                let past = rotate_back(step.turn, root + in_world(contact.point - contact.kept)) - step.shift;
                previous[i * GUIDES + strand] = vec4(past, 0.0);
            }
            moved = moved || contact.touched;
            clear = CERTAIN * contact.clear;
        } else {
            moved = false;
        }
        if (moved) { positions[i * STRANDS + strand] = vec4(point, vertex.w); }
        old_parent = vertex.xyz;
        parent = point;
    }
}

/// Where a vertex is when it has left all capsules, about the root and seen from the head. `edge` is the way that its edge had
/// before anything moved, `past` the place of its past.
///
/// The deeper a vertex is, the more its turn starts from there. The way to where the vertex was would not do: where a strand
/// crosses a sphere nearly at right angles, each vertex would be turned to the other side than its parent, by errors that grow.
/// That way alone would not do either: what is only just touched is to be only just turned.
///
/// Every contact takes its share of the velocity, as deep as it is. Between two capsules a vertex is turned back and forth, and
/// which one is the last hangs on a rounding.
fn resolved(root: vec3<f32>, parent: vec3<f32>, start: vec3<f32>, length: f32, edge: vec3<f32>, past: u32) -> Contact {
    let origin = in_head(root);
    var contact = Contact(start, false, vec3(0.0), 0.0);
    var heading = direction_or(edge, vec3(0.0, -1.0, 0.0));
    var left = 1.0;
    for (var round = 0u; round < ROUNDS; round++) {
        var again = false;
        var clear = FAR;
        for (var i = 0u; i < arrayLength(&capsules); i++) {
            let capsule = about(origin, capsules[i]);
            let sphere = nearest(capsule, contact.point);
            let from_center = contact.point - sphere.xyz;
            clear = min(clear, clearance(capsule, contact.point, sphere));
            if (dot(from_center, from_center) < INSIDE * sphere.w * sphere.w) {
                if (!contact.touched) { contact.kept = start - in_head(carried(previous[past].xyz) - root); }
                let before = direction_or(contact.point - parent, vec3(0.0, -1.0, 0.0));
                let apart = length * distance(before, heading);
                let weight = min(GROWTH * (sphere.w - sqrt(dot(from_center, from_center))) / max(apart, 1e-12), 1.0);
                let turn = turned_out(parent, mix(before, heading, weight), length, sphere, left);
                let pushed = turn.point - contact.point;
                let normal = direction_or(turn.point - sphere.xyz, vec3(0.0));
                contact.kept = slid(contact.kept + pushed, normal, max(dot(pushed, normal), 0.0), step.friction);
                contact.point = turn.point;
                contact.touched = true;
                left *= 1.0 - turn.share;
                heading = mix(heading, direction_or(contact.point - parent, vec3(0.0, -1.0, 0.0)), weight);
                again = again || dot(pushed, pushed) > LEAST_TURN * LEAST_TURN * length * length;
            }
        }
        if (!again) {
            contact.clear = clear;
            break;
        }
        left *= NEXT_ROUND;
    }
    return contact;
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
