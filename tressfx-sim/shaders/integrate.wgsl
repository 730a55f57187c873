// Verlet integration with damping and gravity, and the pull towards the global shape; or back to the rest pose.
// One thread a vertex of a guide.

import package::constants::{GUIDES, STRANDS, VERTICES};
import package::grid::{GROUP, thread_index};
import package::step::Step;
import package::vector::rotate;

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn integrate(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
             @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if (i >= GUIDES * VERTICES) { return; }
    let vertex = i / GUIDES;
    let place = vertex * STRANDS + i % GUIDES;

    let rest_here = rest[i];
    let shape = rotate(step.head_rotation, rest_here.xyz);
    if (step.reset != 0u || rest_here.w == 0.0) {
        // A pinned vertex goes where the head takes it, so its past does not matter.
        positions[place] = vec4(shape, rest_here.w);
        previous[i] = vec4(shape, 0.0);
        return;
    }
    // Both are about where the centre was at the end of the last sub-step.
    let last = positions[place].xyz;
    let before = previous[i].xyz;
    let here = last - step.shift;
    var goal = here + step.keep * bounded(last - before, before) + step.gravity;
    @if(global_shape) {
        // Full at the root, nothing at the end of the range: a strand has no kink where the pull ends.
        let along = f32(vertex) / f32(VERTICES - 1u) / step.global_range;
        let fade = max(1.0 - along * along, 0.0);
        goal += step.global_stiffness * fade * (shape - goal);
    }
    previous[i] = vec4(here, 0.0);
    positions[place] = vec4(goal, rest_here.w);
}

/// The displacement, no longer than `max_displacement` relative to the head: a passenger's hair is not held back by the
/// speed of the car.
fn bounded(displacement: vec3<f32>, before: vec3<f32>) -> vec3<f32> {
    let carried = rotate(step.turn, before) - before + step.shift;
    let relative = displacement - carried;
    let squared = dot(relative, relative);
    if (squared <= step.max_displacement * step.max_displacement) { return displacement; }
    return carried + relative * (step.max_displacement * inverseSqrt(squared));
}
