// The engines' own opaque pass: a bust and the floor that it stands on.

struct Shade {
    view_projection: mat4x4<f32>,
    head: mat4x4<f32>,
    towards: vec4<f32>,
    key: vec4<f32>,
    sky: vec4<f32>,
    ground: vec4<f32>,
    floor: vec4<f32>,
}

@group(0) @binding(0) var<uniform> shade: Shade;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    // In the world, and 1 on the bust.
    @location(0) place: vec4<f32>,
    @location(1) normal: vec3<f32>,
}

@vertex
fn corner(@location(0) position: vec4<f32>, @location(1) normal: vec4<f32>) -> Corner {
    let still = vec4(position.xyz, 1.0);
    let moves = position.w > 0.5;
    let world = select(still, shade.head * still, moves);
    let turned = select(normal, shade.head * normal, moves);
    return Corner(shade.view_projection * world, vec4(world.xyz, position.w), turned.xyz);
}

const CLAY = vec3(0.15, 0.108, 0.088);
const BOARDS = vec3(0.16, 0.15, 0.14);
const DUSK = vec3(0.10, 0.115, 0.14);

@fragment
fn paint(corner: Corner) -> @location(0) vec4<f32> {
    let normal = normalize(corner.normal);
    let from_key = max(dot(normal, shade.towards.xyz), 0.0) * shade.key.rgb;
    let around = mix(shade.ground.rgb, shade.sky.rgb, 0.5 + 0.5 * normal.y);
    let away = length(corner.place.xz - shade.floor.xz) / shade.floor.w;
    // Squares of floor, so that one sees where up is and how far away it goes.
    let square = floor(corner.place.xz / (0.03 * shade.floor.w));
    let odd = abs(square.x + square.y) % 2.0;
    let albedo = select(BOARDS * (0.75 + 0.25 * odd), CLAY, corner.place.w > 0.5);
    let haze = select(smoothstep(0.15, 0.95, away), 0.0, corner.place.w > 0.5);
    return vec4(mix(albedo * (from_key + around), DUSK, haze), 1.0);
}
