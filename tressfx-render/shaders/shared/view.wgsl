// A view and its lights: what every pass over it knows.

const MAX_LIGHTS: u32 = 16u;
// Of so many, the first ones, it is stored at each vertex how much arrives.
const STORED_LIGHTS: u32 = 8u;

struct LightUniform {
    // Unit direction towards the light and 0, or position of a point light and 1.
    place: vec4<f32>,
    // Radiance on a surface that faces it; for a point light at the distance in w, beyond which it falls off.
    color: vec4<f32>,
    // The share that a cone leaves is the square of `xyz` times the direction towards the light, plus `w`.
    cone: vec4<f32>,
}

// A point at the distance d from the plane of the eye falls on the pixel
// center + (focal.x * x, -(skew * x + focal.y * y)) / w, where w is d in a perspective and 1 in an orthographic view.
struct LensUniform {
    // World to the space of the eye: x right, y up, -z ahead.
    to_eye: mat4x4<f32>,
    center: vec2<f32>,
    focal: vec2<f32>,
    skew: f32,
    // The focal length where it is the same in all directions, else 0.
    even_focal: f32,
    near: f32,
    // Nearness sorts and is compared with the scene: 1 / d in a perspective, else 1 - nearness_slope * d. Either is linear on
    // the screen, and affine in depth: (z - depth_offset) * depth_scale, in either order of depth.
    nearness_slope: f32,
    depth_offset: f32,
    depth_scale: f32,
    is_perspective: u32,
    unused: u32,
}

struct ViewUniform {
    view_projection: mat4x4<f32>,
    lens: LensUniform,
    // Position of the eye and 1, or the direction towards it and 0.
    eye: vec4<f32>,
    sky: vec4<f32>,
    ground: vec4<f32>,
    // Pixels of the viewport, where they begin in the target, and pixels of the target.
    size: vec2<u32>,
    offset: vec2<u32>,
    target_size: vec2<u32>,
    light_count: u32,
    // A bit for each light that casts shadows.
    casting: u32,
    // Columns and rows of tiles in which no hair is, before the first ones in which some may be.
    first_tile: vec2<u32>,
    unused: vec2<u32>,
    lights: array<LightUniform, 16>,
}

// Unit direction from a point towards a light, and in w how much of its radiance arrives.
fn towards(light: LightUniform, point: vec3<f32>) -> vec4<f32> {
    if light.place.w == 0.0 {
        return vec4(light.place.xyz, 1.0);
    }
    let offset = light.place.xyz - point;
    let square = max(dot(offset, offset), 1e-20);
    let reach = light.color.w * light.color.w;
    let direction = offset * inverseSqrt(square);
    let root = saturate(dot(light.cone.xyz, direction) + light.cone.w);
    return vec4(direction, min(reach / square, 1.0) * root * root);
}

// From a point towards the eye, of any length.
fn towards_eye(eye: vec4<f32>, point: vec3<f32>) -> vec3<f32> {
    return eye.xyz - point * eye.w;
}

// Light from everywhere, on a surface that faces `normal`.
fn ambient(sky: vec4<f32>, ground: vec4<f32>, normal: vec3<f32>) -> vec3<f32> {
    return mix(ground.rgb, sky.rgb, 0.5 + 0.5 * normal.y);
}
