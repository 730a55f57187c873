// Which colliders an edge of a strand may touch in a sub-step: those that are no further from it than its ends have moved past their
// surface. What rides on the head with the roots moves with them, so motion is measured past the head.

import package::capsule::clearance;
@if(fields)
import package::field_contact::{SLOPE, is_field, sample_of};
import package::rod::{Strand, reach_of};
import package::rod_contact::{FAR, LAST_BIT, bit_of, capsule_at, colliders, moved_by_itself, moved_with_head, nearest_points};
import package::step::step;
import package::vector::rotate_back;

/// A computed distance is multiplied by this, and a motion divided, so that rounding cannot make one too large or the other too small.
const SURE: f32 = 0.999;

/// The vertices behind edges that may touch something, from the first to the last; none where the last is before the first.
struct Range { first: u32, last: u32 }

fn no_edge() -> Range {
    return Range(step.vertices, 0u);
}

fn all_edges(strand: Strand) -> Range {
    return Range(strand.held + 1u, strand.edges);
}

fn is_any(range: Range) -> bool {
    return range.first <= range.last;
}

fn is_in(range: Range, vertex: u32) -> bool {
    return vertex >= range.first && vertex <= range.last;
}

/// How far a sweep along a strand can go on, at least, until it gets to the nearest collider, and to any other.
struct Clear { nearest: u32, distance: f32, others: f32 }

fn nothing_known() -> Clear {
    return Clear(0u, 0.0, 0.0);
}

/// The most that the surface of any collider has moved by itself where the strand can be.
fn surface_way(strand: Strand) -> f32 {
    let then = strand.root_now - strand.root_moved + step.center_displacement;
    let reach = reach_of(strand);
    var most = 0.0;
    for (var i = step.first_capsule; i < step.end_capsule; i++) {
        let turn = length(colliders[i].motion.rotation.xyz);
        most = max(most, length(moved_by_itself(i, then)) + 2.0 * turn * reach);
    }
    return most;
}

/// The square of what a vertex, at this place from the root, has moved past the head.
fn squared_past_head(strand: Strand, place: vec3<f32>, moved: vec3<f32>) -> f32 {
    let before = strand.root_now + step.center_displacement + place - moved;
    let past = moved - moved_with_head(before);
    return dot(past, past);
}

/// The set of colliders that an edge of a sweep, from `u` to `v`, may touch; see `bit_of`. `past` is what `squared_past_head` says of its ends, the larger, and
/// `surface` how far colliders have moved by themselves at most.
fn near_obstacles(clear: ptr<function, Clear>, surface: f32, past: f32, strand: Strand, u: vec3<f32>, v: vec3<f32>, length: f32) -> u32 {
    (*clear).distance -= length;
    (*clear).others -= length;
    let room = SURE * min((*clear).distance, (*clear).others) - surface;
    if (room > 0.0 && room * room > past) { return 0u; }
    let way = (sqrt(past) + surface) / SURE;
    let middle = rotate_back(step.head_rotation, strand.root_now + 0.5 * (u + v));
    var nearest = Clear(step.first_capsule, FAR, FAR);
    var end = step.end_capsule;
    if ((*clear).others > way) {
        // Only the nearest is within reach.
        nearest = Clear((*clear).nearest, FAR, (*clear).others);
        end = nearest.nearest + 1u;
    }
    // Threads of a group that are near to one collider each look at it more closely at once: so no branch in this loop.
    var close = 0u;
    for (var i = nearest.nearest; i < end; i++) {
        let distance = distance_from_middle(i, middle, length);
        close |= select(0u, bit_of(i), distance <= way);
        nearest.others = min(nearest.others, max(nearest.distance, distance));
        nearest.nearest = select(nearest.nearest, i, distance < nearest.distance);
        nearest.distance = min(nearest.distance, distance);
    }
    *clear = nearest;
    return within_reach(close, way, strand.root_now, u, v);
}

/// How far an edge of this middle, in the space of the head, and length is from a collider, or less: by so much a point of it can move in any direction
/// and not touch it.
fn distance_from_middle(index: u32, middle: vec3<f32>, length: f32) -> f32 {
    @if(fields) {
        if (is_field(colliders[index].capsule)) {
            return SLOPE * sample_of(colliders[index].capsule, middle).distance - 0.5 * length;
        }
    }
    return SURE * clearance(colliders[index], middle) - 0.5 * length;
}

/// Those of the colliders that are close to the middle of an edge which the whole edge can touch.
fn within_reach(close: u32, way: f32, root: vec3<f32>, u: vec3<f32>, v: vec3<f32>) -> u32 {
    var found = 0u;
    var rest = close;
    while (rest != 0u) {
        let bit = firstTrailingBit(rest);
        rest &= rest - 1u;
        // The last bit is of all that are left.
        let first = step.first_capsule + bit;
        let end = select(first + 1u, step.end_capsule, bit == LAST_BIT);
        for (var i = first; i < end; i++) {
            if (is_within_reach(i, way, root, u, v)) { found |= bit_of(i); }
        }
    }
    return found;
}

fn is_within_reach(index: u32, way: f32, root: vec3<f32>, u: vec3<f32>, v: vec3<f32>) -> bool {
    @if(fields) {
        // Nothing better is known of them than from the middle.
        if (is_field(colliders[index].capsule)) { return true; }
    }
    let gap = nearest_points(capsule_at(root, index), u, v).gap;
    return min(gap, SURE * gap * colliders[index].motion.clear_share) <= way;
}
