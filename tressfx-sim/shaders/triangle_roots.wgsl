// Where the triangles of a mesh take the roots that are bound to them. One thread a guide.

import package::grid::{GROUP, thread_index};
import package::root_frame::{between_frames, frame_of, put_root, source, targets};
import package::vector::{after, is_finite, rotate};

/// A root on a triangle. Its frame has a tangent and a bitangent in the plane of the triangle, each a sum of the two edges from the first corner.
struct TriangleRoot {
    corners: vec3<u32>,
    /// Along the first edge.
    u: f32,
    /// From the triangle to the root, in the frame.
    offset: vec3<f32>,
    /// Along the second edge.
    v: f32,
    /// The tangent and the bitangent as sums of the edges.
    edges: vec4<f32>,
    /// The frame in the bind pose.
    frame: vec4<f32>,
    /// Where the root is in the bind pose, relative to the centre.
    rest: vec3<f32>,
    padding: f32,
}

/// A triangle whose sine between two edges is smaller than the root of this has no plane.
const FLAT: f32 = 1e-12;

@group(0) @binding(2) var<storage, read> bound_roots: array<TriangleRoot>;
/// Positions of vertices, with whatever is between them.
@group(0) @binding(3) var<storage, read> mesh: array<f32>;

/// Relative to the centre.
fn corner(vertex: u32) -> vec3<f32> {
    let at = source.first + vertex * source.stride;
    return vec3(mesh[at], mesh[at + 1u], mesh[at + 2u]) - source.center;
}

@compute @workgroup_size(GROUP)
fn triangle_roots(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                  @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= source.guides) { return; }
    let root = bound_roots[guide];
    let a = corner(root.corners.x);
    let one = corner(root.corners.y) - a;
    let other = corner(root.corners.z) - a;
    let normal = cross(one, other);
    let squared = dot(normal, normal);
    // A triangle that has collapsed turns nothing: its roots keep the rotation that they had.
    var rotation = targets[guide].rotation;
    var frame = after(rotation, root.frame);
    if (squared > FLAT * dot(one, one) * dot(other, other)) {
        let up = normal * inverseSqrt(squared);
        let tangent = root.edges.x * one + root.edges.y * other;
        let bitangent = root.edges.z * one + root.edges.w * other;
        // Of all tangents in the plane this one is turned as the triangle is as a whole, however it is stretched and sheared.
        frame = frame_of(tangent + cross(bitangent, up), up);
        rotation = between_frames(root.frame, frame);
    }
    let place = a + root.u * one + root.v * other + rotate(frame, root.offset);
    if (is_finite(place)) { put_root(guide, rotation, root.rest, place); }
}
