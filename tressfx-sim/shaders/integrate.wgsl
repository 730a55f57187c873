// Velocity shock propagation, Verlet integration with damping and gravity, and the pull towards the global shape; or back to the
// rest pose. It is also the kernel that brings positions from the centre of the last sub-step to that of this one. One thread a
// vertex of a guide.

import package::grid::{GROUP, thread_index};
import package::root::{Root, carried, root_of, shape_of};
import package::step::step;
import package::vector::rotate;

@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn integrate(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
             @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= step.guides) { return; }
    let vertex = group.z;
    let i = vertex * step.guides + guide;
    let place = vertex * step.strands + guide;

    let root = root_of(guide);
    let rest_here = rest[i];
    let shape = shape_of(root, rest_here.xyz);
    if (step.reset != 0u || rest_here.w == 0.0) {
        // A pinned vertex goes where its root takes it, so its past does not matter.
        positions[place] = vec4(shape, rest_here.w);
        previous[i] = vec4(shape, 0.0);
        return;
    }
    let last = positions[place].xyz;
    let past = previous[i].xyz;
    let here = shocked(root, last);
    let free = moved_on(root, here, shocked_displacement(root, last - past), shocked(root, past));
    previous[i] = vec4(here, 0.0);
    positions[place] = vec4(pulled_to_shape(free, shape, vertex), rest_here.w);
}

/// A point that has made its share of the root's motion at once, so that a quick head does not leave its hair behind and the
/// length constraints need not catch up. Position and past make it alike, and before the integration: the pull towards the
/// global shape would else count this share a second time. `last` is relative to the centre of the last sub-step.
fn shocked(root: Root, last: vec3<f32>) -> vec3<f32> {
    let here = last - step.center_displacement;
    return here + step.shock * (carried(root, last) - here);
}

/// The displacement between two points that have made their share of the root's motion. From their displacement before it,
/// since the difference of two rounded points would lose more.
fn shocked_displacement(root: Root, last: vec3<f32>) -> vec3<f32> {
    return last + step.shock * (rotate(root.turn, last) - last);
}

/// Where a vertex gets to by its own velocity and gravity.
fn moved_on(root: Root, here: vec3<f32>, displacement: vec3<f32>, before: vec3<f32>) -> vec3<f32> {
    return here + step.velocity_kept * bounded(root, displacement, before) + step.gravity;
}

/// The displacement, no longer than `max_displacement` relative to the head: a passenger's hair is not held back by the
/// speed of the car. The head's motion counts without the share that the shock has made already.
fn bounded(root: Root, displacement: vec3<f32>, before: vec3<f32>) -> vec3<f32> {
    let remaining = (1.0 - step.shock) * (carried(root, before + step.center_displacement) - before);
    let relative = displacement - remaining;
    let squared = dot(relative, relative);
    if (squared <= step.max_displacement * step.max_displacement) { return displacement; }
    return remaining + relative * (step.max_displacement * inverseSqrt(squared));
}

/// A vertex after the pull towards where its root takes the rest pose. The pull is full at the root and nothing at the end of
/// its range: a strand has no kink where it ends.
fn pulled_to_shape(point: vec3<f32>, shape: vec3<f32>, vertex: u32) -> vec3<f32> {
    @if(!global_shape) { return point; }
    @if(global_shape) {
        let along = f32(vertex) / f32(step.vertices - 1u) / step.global_range;
        let fade = max(1.0 - along * along, 0.0);
        return point + step.global_stiffness * fade * (shape - point);
    }
}
