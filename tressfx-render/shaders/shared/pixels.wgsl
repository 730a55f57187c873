// The end of a technique that has one thread a pixel, in groups of 8 x 8: it counts the pixels with hair, lists their tile for
// the composite, and writes their colours.

import package::counters::Counters;
import package::view::ViewUniform;

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(4) var<storage, read_write> counters: Counters;
// Premultiplied colour and alpha as four half floats, a pixel.
@group(0) @binding(5) var<storage, read_write> resolved: array<vec2<u32>>;
// Tiles of 8 x 8 pixels with hair.
@group(0) @binding(6) var<storage, read_write> tiles: array<u32>;
// Six vertices for each of them: the arguments of a draw.
@group(0) @binding(7) var<storage, read_write> tile_vertices: array<atomic<u32>, 4>;

var<workgroup> hairy: atomic<u32>;

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
        tiles[atomicAdd(&tile_vertices[0], 6u) / 6u] = tile;
    }
    return count;
}

fn write_pixel(index: u32, color: vec4<f32>) {
    resolved[index] = vec2(pack2x16float(color.rg), pack2x16float(color.ba));
}
