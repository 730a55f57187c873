// The vertices of guides as the grid of `volume` sees them. With the feature `rods` `direct` moves them, and with `push` their state is changed.

import package::root::{carried_from, root_of};
import package::step::step;
import package::vector::rotate_back;
import package::volume::volume;
@if(rods)
import package::rod::{BEGIN, MOVED, slot_of, unpacked_marks};

@group(0) @binding(2) var<storage, read> positions: array<vec4<f32>>;
@if(!rods && !push)
@group(0) @binding(3) var<storage, read> previous: array<vec4<f32>>;
@if(!rods && push)
@group(0) @binding(3) var<storage, read_write> previous: array<vec4<f32>>;
@if(rods && !push)
@group(0) @binding(3) var<storage, read> rods: array<vec4<f32>>;
@if(rods && push)
@group(0) @binding(3) var<storage, read_write> rods: array<vec4<f32>>;

/// A vertex at the end of the sub-step, in the space of the head: its place, and its velocity relative to the head, units/s.
struct Seen { place: vec3<f32>, velocity: vec3<f32> }

fn seen(guide: u32, vertex: u32, here: vec3<f32>) -> Seen {
    let relative = displacement(guide, vertex, here) - surface_displacement(guide, here);
    let velocity = rotate_back(step.head_rotation, relative) / step.length;
    let speed = sqrt(dot(velocity, velocity));
    return Seen(rotate_back(step.head_rotation, here), velocity * min(1.0, volume.fastest / max(speed, volume.fastest)));
}

/// By what a vertex has moved in the sub-step, as its solver keeps it.
fn displacement(guide: u32, vertex: u32, here: vec3<f32>) -> vec3<f32> {
    @if(!rods) { return here - previous[vertex * step.guides + guide].xyz; }
    @if(rods) {
        let turn = unpacked_marks(rods[slot_of(guide, 0u, BEGIN)].w).turn;
        return rods[slot_of(guide, vertex, MOVED + turn)].xyz;
    }
}

/// By what a point has moved that moves with the head. `tressfx` leaves the share of the root's motion out that the velocity shock has made.
fn surface_displacement(guide: u32, here: vec3<f32>) -> vec3<f32> {
    let with_head = here - rotate_back(step.head_turn, here) + step.center_displacement;
    @if(rods) { return with_head; }
    @if(!rods) {
        let with_root = here - carried_from(root_of(guide), here) + step.center_displacement;
        return with_head - step.shock * with_root;
    }
}
