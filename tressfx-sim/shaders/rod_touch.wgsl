// What the edges of a strand touch, as far as the strand remembers it.

import package::rod::Strand;
@if(contacts)
import package::rod::{LENGTHS, STRAIN, TOUCH, moved_slot, positions, rest_before, rods, slot};
import package::rod_contact::Edge;
@if(contacts)
import package::rod_contact::{Touch, contacts_of, nothing_touched, packed_direction, unpacked_direction};
import package::rod_near::Range;
@if(contacts)
import package::rod_near::{is_in, near_obstacles, nothing_known, squared_past_head};
import package::step::step;

/// The edges that were near a collider at the end of the last sub-step.
@if(contacts)
fn last_near(strand: Strand) -> Range {
    let lengths = rods[slot(strand, 0u, LENGTHS)];
    return Range(u32(lengths.z), u32(lengths.w));
}

/// What the edge before a vertex touched then.
@if(contacts)
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

/// What a sweep finds along a strand: whether an edge may touch something, touches it, and is deep inside.
struct Found { near: bool, touching: bool, deep: bool }

/// The end of an edge, from the root, and by what it has moved.
@if(contacts)
struct End { at: vec3<f32>, moved: vec3<f32> }

@if(contacts)
fn end_at(strand: Strand, vertex: u32) -> End {
    let at = positions[vertex * step.strands + strand.guide].xyz - strand.root_now;
    return End(at, rods[moved_slot(strand, vertex, 0u)].xyz);
}

/// Notes what an edge between these ends touches, for the next sub-step, and says whether it is new.
@if(contacts)
fn note_touch(strand: Strand, vertex: u32, u: End, v: End, obstacles: u32) -> bool {
    let last = last_touch(strand, vertex);
    let edge = edge_between(strand, u.at, v.at, u.moved, v.moved);
    let touch = contacts_of(strand.root_now, edge, last, obstacles, 1.0).touch;
    rods[slot(strand, vertex, TOUCH)] = vec4(touch.stretch, packed_direction(touch.normal));
    rods[slot(strand, vertex, STRAIN)].w = f32(touch.obstacle);
    return touch.obstacle > 0u && touch.obstacle != last.obstacle;
}

/// The same of all edges that may touch anything.
@if(contacts)
fn note_touches(strand: Strand, range: Range, surface: f32) -> bool {
    var is_new = false;
    var clear = nothing_known();
    var past_before = 0.0;
    for (var vertex = range.first; vertex <= range.last; vertex++) {
        let u = end_at(strand, vertex - 1u);
        let v = end_at(strand, vertex);
        if (vertex == range.first) { past_before = squared_past_head(strand, u.at, u.moved); }
        let past = squared_past_head(strand, v.at, v.moved);
        let length = rest_before(strand, vertex).w;
        let obstacles = near_obstacles(&clear, surface, max(past_before, past), strand, u.at, v.at, length);
        is_new = note_touch(strand, vertex, u, v, obstacles) || is_new;
        past_before = past;
    }
    return is_new;
}
