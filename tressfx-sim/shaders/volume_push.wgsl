// Pushes the guides out of where hair is denser than at rest, and takes their velocities towards those of the hair around them. The change of
// velocity goes into what the solver of the next sub-step begins with. One thread a vertex of a guide.

import package::grid::{GROUP, thread_index};
import package::nodes::{corner_of, node_index};
import package::step::step;
import package::vector::rotate;
import package::volume::{Place, VolumeNode, place_of, volume, weight_of};
import package::volume_vertex::{Seen, positions, seen};
@if(!rods)
import package::volume_vertex::previous;
@if(rods)
import package::rod::push_slot;
@if(rods)
import package::volume_vertex::rods;

@group(0) @binding(4) var<storage, read> node_values: array<VolumeNode>;

/// Compression spreads by no more than this share of a cell in a sub-step: with a whole cell the strands of a block that is pressed together swing by
/// centimetres a second for ever.
const FARTHEST_SOUND: f32 = 0.5;
/// It pushes no vertex further than this share.
const LONGEST_PUSH: f32 = 0.1;

@compute @workgroup_size(GROUP)
fn volume_push(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let thread = thread_index(group, groups, lane);
    if (thread >= step.guides * step.vertices) { return; }
    let guide = thread % step.guides;
    let vertex = thread / step.guides;
    let position = positions[vertex * step.strands + guide];
    let seen = seen(guide, vertex, position.xyz);
    let place = place_of(seen.place);
    var push = vec3(0.0);
    // What is pinned goes where its root takes it.
    if (place.is_inside && position.w > 0.0) { push = rotate(step.head_rotation, push_at(place, seen.velocity)); }
    @if(!rods) { previous[thread] -= vec4(push, 0.0); }
    @if(rods) { rods[push_slot(guide, vertex)] = vec4(push / (step.length * step.length), 0.0); }
}

/// The displacement in a sub-step by the change of velocity, in the space of the head.
fn push_at(place: Place, velocity: vec3<f32>) -> vec3<f32> {
    var slope = vec3(0.0);
    var mean = vec3(0.0);
    for (var corner = 0u; corner < 8u; corner++) {
        let offset = corner_of(corner);
        let value = node_values[node_index(place.node + offset, volume.nodes)];
        let weight = weight_of(place.share, offset);
        slope += weight * value.slope;
        mean += weight * value.velocity;
    }
    let sound = min(volume.sound_speed * step.length, FARTHEST_SOUND * volume.cell);
    let push = -sound * sound * slope;
    let longest = LONGEST_PUSH * volume.cell;
    let size = sqrt(dot(push, push));
    // Implicit, so that no friction turns a motion around.
    let share = volume.friction * step.length / (1.0 + volume.friction * step.length);
    return push * (longest / max(size, longest)) + share * step.length * (mean - velocity);
}
