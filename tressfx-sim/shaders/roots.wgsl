// Where the roots are at the end of a sub-step, between the end of the last one and the end of the frame. One thread a guide.

import package::grid::{GROUP, thread_index};
import package::step::step;
import package::vector::{after, rotate};

/// A rigid transform within the space of the rest pose: points relative to the centre of the groom are turned, then moved.
struct RootTransform { rotation: vec4<f32>, place: vec4<f32> }

/// `GuideRoot` of `package::root`, here to be written.
struct GuideRoot { rotation: vec4<f32>, place: vec4<f32>, last_rotation: vec4<f32>, last_place: vec4<f32> }

/// At the end of the frame, as the head sees them.
@group(0) @binding(1) var<storage, read> targets: array<RootTransform>;
/// At the end of the last sub-step, as the head sees them.
@group(0) @binding(2) var<storage, read_write> reached: array<RootTransform>;
@group(0) @binding(3) var<storage, read_write> guide_roots: array<GuideRoot>;

@compute @workgroup_size(GROUP)
fn roots(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= step.guides) { return; }
    let last = guide_roots[guide];
    let now = root_between(reached[guide], targets[guide], step.root_share);
    reached[guide] = now;
    let rotation = after(step.head_rotation, now.rotation);
    let place = vec4(rotate(step.head_rotation, now.place.xyz), 0.0);
    if (step.reset != 0u) {
        guide_roots[guide] = GuideRoot(rotation, place, rotation, place);
    } else {
        guide_roots[guide] = GuideRoot(rotation, place, last.rotation, last.place);
    }
}

/// The transform at a share of the distance from one to another.
fn root_between(one: RootTransform, other: RootTransform, share: f32) -> RootTransform {
    // Both signs of a quaternion are the same rotation.
    let near = select(-other.rotation, other.rotation, dot(one.rotation, other.rotation) >= 0.0);
    return RootTransform(normalize(mix(one.rotation, near, share)), mix(one.place, other.place, share));
}
