// The two triangles of a tile.

import package::tile::{TILE, place_of_tile};

// One of six vertices in clip space, of a view of so many pixels that begins at `offset` in its target.
fn corner_of_tile(tile: u32, vertex: u32, size: vec2<u32>, offset: vec2<u32>, target_size: vec2<u32>) -> vec4<f32> {
    // Corners 0 1 2 and 2 1 3, two bits each.
    let corner = (0xda4u >> (2u * vertex)) & 3u;
    let pixel = (place_of_tile(tile, size) + vec2(corner & 1u, corner >> 1u)) * TILE;
    // Tiles at the edge end where the viewport does.
    let place = min(pixel, size) + offset;
    let clip = vec2<f32>(place) / vec2<f32>(target_size) * 2.0 - 1.0;
    return vec4(clip.x, -clip.y, 0.0, 1.0);
}
