// Velocity shock propagation: the strand makes a share of its root's motion at once, position and past alike, so that a quick
// head does not leave its hair behind and the length constraints need not catch up. It runs before the integration: a pull
// towards the head would else count this share a second time. It is also the kernel that brings positions from the centre of
// the last sub-step to that of this one. One thread a vertex of a guide.

import package::grid::{GROUP, thread_index};
import package::root::{Root, carried, root_of};
import package::step::step;

@group(0) @binding(1) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn velocity_shock(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                  @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= step.guides) { return; }
    let i = group.z * step.guides + guide;
    let place = group.z * step.strands + guide;
    let last = positions[place];
    if (last.w == 0.0) { return; }
    let root = root_of(guide);
    positions[place] = vec4(shocked(root, last.xyz), last.w);
    previous[i] = vec4(shocked(root, previous[i].xyz), 0.0);
}

/// A point that has made its share of the root's motion; `last` is about the centre of the last sub-step.
fn shocked(root: Root, last: vec3<f32>) -> vec3<f32> {
    let here = last - step.shift;
    return here + step.shock * (carried(root, last) - here);
}
