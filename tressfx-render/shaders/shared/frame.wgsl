// What every pass of a frame knows: the camera and the lights.

const MAX_LIGHTS: u32 = 8u;

struct Light {
    // Unit direction towards the light and 0, or position of a point light and 1.
    place: vec4<f32>,
    // Radiance on a surface that faces it; for a point light at the distance in w, beyond which it falls off.
    color: vec4<f32>,
}

struct Frame {
    view: mat4x4<f32>,
    view_projection: mat4x4<f32>,
    eye: vec4<f32>,
    sky: vec4<f32>,
    ground: vec4<f32>,
    size: vec2<u32>,
    // Pixels that a length of one view unit at distance one is long.
    focal: f32,
    near: f32,
    // A depth z stands for the distance w with 1/w = (z - depth_offset) * depth_scale, in either order of depth.
    depth_offset: f32,
    depth_scale: f32,
    light_count: u32,
    node_capacity: u32,
    lights: array<Light, 8>,
}

// Unit direction from a point towards a light, and in w how much of its radiance arrives.
fn towards(light: Light, point: vec3<f32>) -> vec4<f32> {
    if light.place.w == 0.0 {
        return vec4(light.place.xyz, 1.0);
    }
    let offset = light.place.xyz - point;
    let square = max(dot(offset, offset), 1e-20);
    let reach = light.color.w * light.color.w;
    return vec4(offset * inverseSqrt(square), min(reach / square, 1.0));
}

// Light from everywhere, on a surface that faces `normal`.
fn ambient(sky: vec4<f32>, ground: vec4<f32>, normal: vec3<f32>) -> vec3<f32> {
    return mix(ground.rgb, sky.rgb, 0.5 + 0.5 * normal.y);
}
