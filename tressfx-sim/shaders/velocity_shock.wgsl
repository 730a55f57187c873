// Velocity shock propagation: the strand makes a share of the head's motion at once, position and past alike, so that a
// quick head does not leave its hair behind and the length constraints need not catch up. One thread a vertex of a guide.

import package::constants::{GUIDES, STRANDS, VERTICES};
import package::grid::{GROUP, thread_index};
import package::step::Step;
import package::vector::rotate;

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn velocity_shock(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                  @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if (i >= GUIDES * VERTICES) { return; }
    let place = (i / GUIDES) * STRANDS + i % GUIDES;
    let here = positions[place];
    if (here.w == 0.0) { return; }
    positions[place] = vec4(shocked(here.xyz), here.w);
    previous[i] = vec4(shocked(previous[i].xyz), 0.0);
}

fn shocked(point: vec3<f32>) -> vec3<f32> {
    let carried = rotate(step.turn, point + step.shift);
    return point + step.shock * (carried - point);
}
