// The frame of a root, as a rotation; and where what moves roots on the GPU writes them.

import package::vector::{across, after, direction_or, rotate};

/// A rigid transform within the space of the rest pose: points relative to the centre of the groom are turned, then moved.
struct RootTransform { rotation: vec4<f32>, place: vec4<f32> }

/// What all roots of a section share.
struct RootSource {
    /// The centre of the groom, in the space of the mesh.
    center: vec3<f32>,
    guides: u32,
    /// Numbers from vertex to vertex, and before the first position.
    stride: u32,
    first: u32,
    padding: vec2<u32>,
}

@group(0) @binding(0) var<uniform> source: RootSource;
/// One a guide.
@group(0) @binding(8) var<storage, read_write> targets: array<RootTransform>;

/// The rotation that takes x to a tangent and z to a normal, which the tangent is made perpendicular to (Shepperd 1978).
fn frame_of(tangent: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    let z = direction_or(normal, vec3(0.0, 0.0, 1.0));
    let x = direction_or(tangent - dot(tangent, z) * z, across(z));
    let y = cross(z, x);
    let trace = x.x + y.y + z.z;
    if (trace > 0.0) {
        return normalize(vec4(y.z - z.y, z.x - x.z, x.y - y.x, 1.0 + trace));
    }
    if (x.x >= y.y && x.x >= z.z) {
        return normalize(vec4(1.0 + x.x - y.y - z.z, x.y + y.x, z.x + x.z, y.z - z.y));
    }
    if (y.y >= z.z) {
        return normalize(vec4(x.y + y.x, 1.0 + y.y - x.x - z.z, y.z + z.y, z.x - x.z));
    }
    return normalize(vec4(z.x + x.z, y.z + z.y, 1.0 + z.z - x.x - y.y, x.y - y.x));
}

/// Says that the root which is at `rest` in the bind pose is at `place`, both relative to the centre, and turned by `rotation`.
fn put_root(guide: u32, rotation: vec4<f32>, rest: vec3<f32>, place: vec3<f32>) {
    targets[guide] = RootTransform(rotation, vec4(place - rotate(rotation, rest), 0.0));
}

/// The rotation from one frame to another.
fn between_frames(rest: vec4<f32>, now: vec4<f32>) -> vec4<f32> {
    return normalize(after(now, vec4(-rest.xyz, rest.w)));
}
