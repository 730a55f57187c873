// Where the bones of strands take their roots, without a mesh. One thread a guide.

import package::grid::{GROUP, thread_index};
import package::joint_matrix::{blended, cofactors_times, transformed};
import package::root_frame::{between_frames, frame_of, put_root, source};
import package::vector::{is_finite, rotate};

/// A root that bones move. Bones are two in a word, the lower half first.
struct BoneRoot {
    /// Where it is in the bind pose, relative to the centre.
    rest: vec3<f32>,
    joints_01: u32,
    /// The frame in the bind pose: its z is the direction in which the strand grows.
    frame: vec4<f32>,
    weights: vec4<f32>,
    joints_23: u32,
    padding: u32,
    more_padding: vec2<u32>,
}

@group(0) @binding(2) var<storage, read> bound_roots: array<BoneRoot>;

@compute @workgroup_size(GROUP)
fn bone_roots(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= source.guides) { return; }
    let root = bound_roots[guide];
    let by = blended(root.joints_01, root.joints_23, root.weights);
    let x = rotate(root.frame, vec3(1.0, 0.0, 0.0));
    let z = rotate(root.frame, vec3(0.0, 0.0, 1.0));
    let tangent = vec3(dot(by.x.xyz, x), dot(by.y.xyz, x), dot(by.z.xyz, x));
    let bitangent_of = cross(z, x);
    let bitangent = vec3(dot(by.x.xyz, bitangent_of), dot(by.y.xyz, bitangent_of), dot(by.z.xyz, bitangent_of));
    let normal = cofactors_times(by, z);
    let up = normal * inverseSqrt(max(dot(normal, normal), 1e-30));
    // As on a triangle: turned as what is across the strand is as a whole.
    let frame = frame_of(tangent + cross(bitangent, up), up);
    let place = transformed(by, root.rest + source.center) - source.center;
    if (is_finite(place)) { put_root(guide, between_frames(root.frame, frame), root.rest, place); }
}
