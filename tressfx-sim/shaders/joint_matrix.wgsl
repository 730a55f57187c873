// Matrices of joints, and what several of them make together.

/// The rows of an affine transform.
struct Affine { x: vec4<f32>, y: vec4<f32>, z: vec4<f32> }

/// Three rows a joint: from the bind pose to where it is.
@group(0) @binding(1) var<storage, read> joints: array<vec4<f32>>;

/// The sum of the matrices of four joints, which are two in a word, the lower half first.
fn blended(joints_01: u32, joints_23: u32, weights: vec4<f32>) -> Affine {
    let numbers = vec4(joints_01 & 0xffffu, joints_01 >> 16u, joints_23 & 0xffffu, joints_23 >> 16u);
    var sum = Affine(vec4(0.0), vec4(0.0), vec4(0.0));
    for (var slot = 0u; slot < 4u; slot++) {
        let weight = weights[slot];
        if (weight == 0.0) { continue; }
        let first = 3u * numbers[slot];
        sum.x += weight * joints[first];
        sum.y += weight * joints[first + 1u];
        sum.z += weight * joints[first + 2u];
    }
    return sum;
}

/// Where it takes a point.
fn transformed(by: Affine, point: vec3<f32>) -> vec3<f32> {
    let place = vec4(point, 1.0);
    return vec3(dot(by.x, place), dot(by.y, place), dot(by.z, place));
}

/// Where it takes a direction, of another length.
fn linear(by: Affine, direction: vec3<f32>) -> vec3<f32> {
    return vec3(dot(by.x.xyz, direction), dot(by.y.xyz, direction), dot(by.z.xyz, direction));
}

/// Where its linear part takes a normal, of another length: the cofactors keep it across the surface.
fn cofactors_times(by: Affine, normal: vec3<f32>) -> vec3<f32> {
    let x = by.x.xyz;
    let y = by.y.xyz;
    let z = by.z.xyz;
    return vec3(dot(cross(y, z), normal), dot(cross(z, x), normal), dot(cross(x, y), normal));
}
