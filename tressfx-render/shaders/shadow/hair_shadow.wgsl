// What hair leaves of the sky and of lights at any point: for strands, and for the surfaces of an engine. The bindings have numbers of their
// own, above those of the shader that imports this.

import package::frames::{BY_SKY, OPEN, SKY, ShadowGrid, cell_at, in_frame, place_in};
import package::grids::{grid_of, has_hair, shadow};
import package::view::towards;

@group(0) @binding(18) var<storage, read> cells: array<u32>;
@group(0) @binding(19) var<storage, read> sky: array<vec2<u32>>;

// What an optical depth of 1 is counted as.
const UNIT: f32 = 4096.0;

fn sky_in(grid: ShadowGrid, at: vec3<i32>) -> vec4<f32> {
    let cell = sky[cell_at(grid, at)];
    return vec4(unpack2x16float(cell.x), unpack2x16float(cell.y));
}

// Between the middles of eight cells.
fn sky_at(point: vec3<f32>) -> vec4<f32> {
    let grid = grid_of(SKY);
    let at = place_in(grid, in_frame(shadow.frames[SKY], point)) - 0.5;
    let corner = vec3<i32>(floor(at));
    let share = at - floor(at);
    var sum = vec4(0.0);
    for (var i = 0; i < 8; i++) {
        let step = vec3(i & 1, (i >> 1u) & 1, i >> 2u);
        let weight = select(1.0 - share, share, step == vec3(1));
        sum += weight.x * weight.y * weight.z * sky_in(grid, corner + step);
    }
    return sum;
}

// What a row of cells takes before a place in one of them.
fn taken_before(grid: ShadowGrid, texel: vec2<i32>, along: f32) -> f32 {
    let layer = clamp(i32(floor(along)), 0, i32(grid.size.z) - 1);
    let within = clamp(along - f32(layer), 0.0, 1.0);
    let up_to = f32(cells[cell_at(grid, vec3(texel, layer))]);
    var before = 0.0;
    if layer > 0 {
        before = f32(cells[cell_at(grid, vec3(texel, layer - 1))]);
    }
    return mix(before, up_to, within);
}

// The share of a light that arrives, between the middles of four rows of cells.
fn light_at(index: u32, point: vec3<f32>) -> f32 {
    let grid = grid_of(index);
    let at = place_in(grid, in_frame(shadow.frames[index], point));
    let across = at.xy - 0.5;
    let corner = vec2<i32>(floor(across));
    let share = across - floor(across);
    var taken = 0.0;
    for (var i = 0; i < 4; i++) {
        let step = vec2(i & 1, i >> 1u);
        let weight = select(1.0 - share, share, step == vec2(1));
        taken += weight.x * weight.y * taken_before(grid, corner + step, at.z);
    }
    return exp(-taken / UNIT);
}

// Of light from everywhere, from the direction `d`, the share `w + (x, y, z) . d` arrives.
fn hair_sky(point: vec3<f32>) -> vec4<f32> {
    if shadow.first != SKY || !has_hair(SKY) {
        return vec4(0.0, 0.0, 0.0, 1.0);
    }
    return sky_at(point);
}

// The share of a light that arrives; `open` is what `hair_sky` says.
fn hair_light(light: u32, point: vec3<f32>, open: vec4<f32>) -> f32 {
    let frame = shadow.of_light[light / 4u][light % 4u];
    if frame == BY_SKY {
        return saturate(open.w + dot(open.xyz, towards(shadow.lights[light], point).xyz));
    }
    if frame == OPEN || !has_hair(frame) {
        return 1.0;
    }
    return light_at(frame, point);
}
