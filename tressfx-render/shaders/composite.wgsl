// The resolved hair lies over the picture: six vertices for each tile with hair, in the order in which they were found.

import package::view::ViewUniform;

@group(0) @binding(0) var<uniform> view: ViewUniform;
// Tiles with hair.
@group(0) @binding(1) var<storage, read> tiles: array<u32>;
@group(0) @binding(2) var<storage, read> resolved: array<vec2<u32>>;

const TILE: u32 = 8u;

@vertex
fn tile_corner(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    let tile = tiles[vertex / 6u];
    let columns = (view.size.x + TILE - 1u) / TILE;
    // Two triangles with the corners 0 1 2 and 2 1 3, two bits each.
    let corner = (0xda4u >> (2u * (vertex % 6u))) & 3u;
    let pixel = (vec2(tile % columns, tile / columns) + vec2(corner & 1u, corner >> 1u)) * TILE;
    // Tiles at the edge end where the viewport does.
    let place = min(pixel, view.size) + view.offset;
    let clip = vec2<f32>(place) / vec2<f32>(view.target_size) * 2.0 - 1.0;
    return vec4(clip.x, -clip.y, 0.0, 1.0);
}

@fragment
fn composite(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(position.xy) - view.offset;
    let color = resolved[pixel.y * view.size.x + pixel.x];
    return vec4(unpack2x16float(color.x), unpack2x16float(color.y));
}
