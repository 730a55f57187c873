// Which edges of a strand touch a capsule, and which come near enough to be looked at.

import package::capsule::{clearance, nearest};
import package::rod::{LENGTHS, STRAIN, Strand, TOUCH, moved_slot, positions, rods, reach_of, slot};
import package::rod_contact::{
    CERTAIN, Edge, FAR, Touch, colliders, contacts_of, nothing_touched, packed_direction, surface_bound, unpacked_direction,
};
@if(fields)
import package::field_contact::{SLOPE, is_field, sample_of};
import package::step::step;
import package::vector::rotate_back;

/// The vertices behind edges that may touch a capsule, from the first to the last; none where the last is before the first.
struct Range { first: u32, last: u32 }

fn nothing_near() -> Range {
    return Range(step.vertices, 0u);
}

fn is_in(range: Range, vertex: u32) -> bool {
    return vertex >= range.first && vertex <= range.last;
}

/// Those at the end of the last sub-step.
fn last_near(strand: Strand) -> Range {
    let lengths = rods[slot(strand, 0u, LENGTHS)];
    return Range(u32(lengths.z), u32(lengths.w));
}

/// What the edge before a vertex touched then.
fn last_touch(strand: Strand, vertex: u32) -> Touch {
    var touch = nothing_touched();
    if (is_in(last_near(strand), vertex)) {
        touch.obstacle = u32(rods[slot(strand, vertex, STRAIN)].w);
        if (touch.obstacle > 0u) {
            let kept = rods[slot(strand, vertex, TOUCH)];
            touch.stretch = kept.xyz;
            touch.normal = unpacked_direction(kept.w);
        }
    }
    return touch;
}

/// An edge whose ends are at these places from the root and have moved by so much.
fn edge_between(strand: Strand, u: vec3<f32>, v: vec3<f32>, u_moved: vec3<f32>, v_moved: vec3<f32>) -> Edge {
    let then = strand.root_now + step.center_displacement;
    return Edge(u, v, u_moved, v_moved, then + u - u_moved, then + v - v_moved);
}

/// The most that the surface of any capsule has moved where the strand can be.
fn surface_way(strand: Strand) -> f32 {
    let then = strand.root_now - strand.root_moved + step.center_displacement;
    return surface_bound(then, reach_of(strand));
}

/// Whether an edge may touch a capsule. `clear` is how far the nearest one is at least from where the sweep has come to, `surface` how
/// far capsules have moved at most.
fn may_touch(clear: ptr<function, f32>, surface: f32, strand: Strand, edge: Edge, length: f32) -> bool {
    *clear -= length;
    let longest = sqrt(max(dot(edge.u_moved, edge.u_moved), dot(edge.v_moved, edge.v_moved))) + surface;
    if (*clear > longest) { return false; }
    *clear = clear_distance(strand.root_now + 0.5 * (edge.u + edge.v)) - 0.5 * length;
    return *clear <= longest;
}

/// What has been found along a strand.
struct Found { near: Range, touching: bool, deep: bool }

/// Looks at an edge, the one before `vertex`.
fn look_at(found: ptr<function, Found>, strand: Strand, edge: Edge, vertex: u32) {
    (*found).near = Range(min((*found).near.first, vertex), vertex);
    let touch = contacts_of(strand.root_now, edge, last_touch(strand, vertex), 1.0).touch;
    (*found).touching = (*found).touching || touch.obstacle > 0u;
    (*found).deep = (*found).deep || touch.is_deep;
}

/// The distance from a place, relative to the centre of the groom, to the nearest capsule, or less.
fn clear_distance(place: vec3<f32>) -> f32 {
    let in_head = rotate_back(step.head_rotation, place);
    var clear = FAR;
    for (var i = step.first_capsule; i < step.end_capsule; i++) {
        let capsule = colliders[i].capsule;
        @if(fields) {
            if (is_field(capsule)) {
                clear = min(clear, SLOPE * sample_of(capsule, in_head).distance);
                continue;
            }
        }
        clear = min(clear, clearance(capsule, in_head, nearest(capsule, in_head)));
    }
    return min(clear, CERTAIN * clear);
}

/// Notes what the edges that may touch anything touch, for the next sub-step, and says whether any of it is new.
fn note_touches(strand: Strand, range: Range) -> bool {
    var is_new = false;
    for (var vertex = range.first; vertex <= range.last; vertex++) {
        let u = positions[(vertex - 1u) * step.strands + strand.guide].xyz - strand.root_now;
        let v = positions[vertex * step.strands + strand.guide].xyz - strand.root_now;
        let u_moved = rods[moved_slot(strand, vertex - 1u, 0u)].xyz;
        let v_moved = rods[moved_slot(strand, vertex, 0u)].xyz;
        let last = last_touch(strand, vertex);
        let touch = contacts_of(strand.root_now, edge_between(strand, u, v, u_moved, v_moved), last, 1.0).touch;
        is_new = is_new || (touch.obstacle > 0u && touch.obstacle != last.obstacle);
        rods[slot(strand, vertex, TOUCH)] = vec4(touch.stretch, packed_direction(touch.normal));
        rods[slot(strand, vertex, STRAIN)].w = f32(touch.obstacle);
    }
    return is_new;
}
