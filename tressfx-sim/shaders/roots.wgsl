// Where the roots are at the end of a sub-step, on a curve through where they are at the end of the frame and were at the ends of the three
// before it. One thread a guide.

import package::grid::{GROUP, thread_index};
import package::step::step;
import package::vector::{after, rotate};

/// A rigid transform within the space of the rest pose: points relative to the centre of the groom are turned, then moved.
struct RootTransform { rotation: vec4<f32>, place: vec4<f32> }

/// `GuideRoot` of `package::root`, here to be written.
struct GuideRoot { rotation: vec4<f32>, place: vec4<f32>, last_rotation: vec4<f32>, last_place: vec4<f32> }

/// At the end of the frame, as the head sees them.
@group(0) @binding(1) var<storage, read> targets: array<RootTransform>;
/// At the ends of the last frames, in turns.
@group(0) @binding(2) var<storage, read> places_0: array<RootTransform>;
@group(0) @binding(3) var<storage, read> places_1: array<RootTransform>;
@group(0) @binding(4) var<storage, read> places_2: array<RootTransform>;
@group(0) @binding(5) var<storage, read_write> guide_roots: array<GuideRoot>;

/// The farthest that the curve may lead from the straight line between two unit quaternions.
const TURN_SLACK: f32 = 0.25;

@compute @workgroup_size(GROUP)
fn roots(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= step.guides) { return; }
    let last = guide_roots[guide];
    let now = root_on_way(guide);
    let rotation = after(step.head_rotation, now.rotation);
    let place = vec4(rotate(step.head_rotation, now.place.xyz), 0.0);
    if (step.reset != 0u) {
        guide_roots[guide] = GuideRoot(rotation, place, rotation, place);
    } else {
        guide_roots[guide] = GuideRoot(rotation, place, last.rotation, last.place);
    }
}

/// The place of a root so many frames before the start of this one.
fn place_before(guide: u32, frames: u32) -> RootTransform {
    let index = (step.root_place + 3u - frames) % 3u;
    if (index == 0u) { return places_0[guide]; }
    if (index == 1u) { return places_1[guide]; }
    return places_2[guide];
}

fn root_on_way(guide: u32) -> RootTransform {
    let end = targets[guide];
    if (step.root_share >= 1.0) { return end; }
    let start = place_before(guide, 0u);
    // A root that stands still does so, whatever it did before.
    if (all(start.rotation == end.rotation) && all(start.place == end.place)) { return end; }
    let last = place_before(guide, 1u);
    let earlier = place_before(guide, 2u);
    let turn = bent(start.rotation, near(end, start), near(last, start), near(earlier, start), TURN_SLACK);
    let place = bent(start.place, end.place, last.place, earlier.place, step.root_slack);
    return RootTransform(normalize(turn), place);
}

/// The rotation as it is nearer to another: both signs of a quaternion are the same rotation.
fn near(root: RootTransform, other: RootTransform) -> vec4<f32> {
    return select(-root.rotation, root.rotation, dot(root.rotation, other.rotation) >= 0.0);
}

/// A point on the curve.
fn bent(start: vec4<f32>, end: vec4<f32>, last: vec4<f32>, earlier: vec4<f32>, slack: f32) -> vec4<f32> {
    let bend = step.root_bend;
    let away = bend.x * (end - start) + bend.y * (last - start) + bend.z * (earlier - start);
    let limited = away * min(1.0, slack * inverseSqrt(max(dot(away, away), 1e-30)));
    return mix(start, end, step.root_share) + limited;
}
