// Rotations, and directions that stay finite whatever they are given.

/// Below this squared length a vector has no direction.
const NO_LENGTH: f32 = 1e-24;
/// The direction of an edge that has none.
const DOWN: vec3<f32> = vec3(0.0, -1.0, 0.0);

/// Turns a vector by a unit quaternion.
fn rotate(rotation: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let t = 2.0 * cross(rotation.xyz, v);
    return v + rotation.w * t + cross(rotation.xyz, t);
}

/// The matrix of a rotation by a unit quaternion.
fn matrix_of(rotation: vec4<f32>) -> mat3x3<f32> {
    return mat3x3(
        rotate(rotation, vec3(1.0, 0.0, 0.0)),
        rotate(rotation, vec3(0.0, 1.0, 0.0)),
        rotate(rotation, vec3(0.0, 0.0, 1.0)),
    );
}

/// By what a rotation moves a point.
fn turned_by(rotation: vec4<f32>, point: vec3<f32>) -> vec3<f32> {
    let t = 2.0 * cross(rotation.xyz, point);
    return rotation.w * t + cross(rotation.xyz, t);
}

/// The matrix of that: less rounded than the difference of a rotation's matrix and that of none.
fn moved_by(rotation: vec4<f32>) -> mat3x3<f32> {
    return mat3x3(
        turned_by(rotation, vec3(1.0, 0.0, 0.0)),
        turned_by(rotation, vec3(0.0, 1.0, 0.0)),
        turned_by(rotation, vec3(0.0, 0.0, 1.0)),
    );
}

/// Turns a vector back.
fn rotate_back(rotation: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    return rotate(vec4(-rotation.xyz, rotation.w), v);
}

/// The rotation that is `second` after `first`.
fn after(second: vec4<f32>, first: vec4<f32>) -> vec4<f32> {
    let axis = second.w * first.xyz + first.w * second.xyz + cross(second.xyz, first.xyz);
    return vec4(axis, second.w * first.w - dot(second.xyz, first.xyz));
}

/// The direction of a vector, or `otherwise` where it has none.
fn direction_or(v: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let squared = dot(v, v);
    return select(otherwise, v * inverseSqrt(squared), squared > NO_LENGTH);
}

/// A unit vector across a unit vector.
fn across(u: vec3<f32>) -> vec3<f32> {
    let axis = select(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), abs(u.x) > 0.6);
    return normalize(cross(u, axis));
}

/// Whether all three are numbers. Looks at the bits: compilers may assume that comparisons never see a NaN.
fn is_finite(v: vec3<f32>) -> bool {
    let exponents = bitcast<vec3<u32>>(v) & vec3(0x7f800000u);
    return all(exponents != vec3(0x7f800000u));
}
