// The end of a technique that has one thread a pixel, in groups of 8 x 8: it counts the pixels with hair, lists their tile for
// the composite, and writes their colours.

import package::counters::Counters;
import package::tile::{TILE, resolved_index, tile_of};
import package::view::ViewUniform;

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(4) var<storage, read_write> counters: Counters;
// Premultiplied colour and alpha as four half floats, a pixel: tile after tile.
@if(!hair_output)
@group(0) @binding(5) var<storage, read_write> resolved: array<vec2<u32>>;
// Three words a pixel: the same, and the key of the fragment whose depth the pixel has.
@if(hair_output)
@group(0) @binding(5) var<storage, read_write> resolved: array<u32>;
// Tiles of 8 x 8 pixels with hair, and where their pixels are: in the place of the tile.
@group(0) @binding(6) var<storage, read_write> tiles: array<vec2<u32>>;
// Six vertices for each of them: the arguments of a draw.
@group(0) @binding(7) var<storage, read_write> tile_vertices: array<atomic<u32>, 4>;

var<workgroup> hairy: atomic<u32>;

// The pixel of a thread: there is one group a tile, of those in which hair may be.
fn pixel_of(thread: vec2<u32>) -> vec2<u32> {
    return TILE * view.first_tile + thread;
}

fn is_inside(pixel: vec2<u32>) -> bool {
    return all(pixel < view.size);
}

fn index_of(pixel: vec2<u32>) -> u32 {
    return pixel.y * view.size.x + pixel.x;
}

// How many pixels of the group have hair; none of the tile's pixels is written where there are none. All lanes come here.
fn count_hairy(has_hair: bool, tile: u32, lane: u32) -> u32 {
    if lane == 0u {
        atomicStore(&hairy, 0u);
    }
    workgroupBarrier();
    if has_hair {
        atomicAdd(&hairy, 1u);
    }
    workgroupBarrier();
    let count = atomicLoad(&hairy);
    if lane == 0u && count > 0u {
        atomicAdd(&counters.pixels_with_hair, count);
        atomicAdd(&counters.tiles_with_hair, 1u);
        tiles[atomicAdd(&tile_vertices[0], 6u) / 6u] = vec2(tile);
    }
    return count;
}

@if(!hair_output)
fn write_pixel(pixel: vec2<u32>, color: vec4<f32>) {
    resolved[resolved_index(tile_of(pixel, view.size), pixel)] = vec2(pack2x16float(color.rg), pack2x16float(color.ba));
}

@if(hair_output)
fn write_seen_pixel(pixel: vec2<u32>, color: vec4<f32>, seen: u32) {
    let first = 3u * resolved_index(tile_of(pixel, view.size), pixel);
    resolved[first] = pack2x16float(color.rg);
    resolved[first + 1u] = pack2x16float(color.ba);
    resolved[first + 2u] = seen;
}
