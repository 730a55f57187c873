// Fragments become the optical depth of the parts of their pixel.

import package::fragment::Fragment;
import package::occlusion::{BIT, OccludedTile, PARTS, occlusion, part_of};
import package::screen::view;
import package::sums::{OPTICAL_UNIT, optical_depth};
import package::tile::tile_of;

@group(0) @binding(6) var<storage, read> tiles: array<OccludedTile>;
// PARTS a pixel.
@group(0) @binding(7) var<storage, read_write> opticals: array<atomic<u32>>;

struct Sink {
    unused: u32,
}

fn take(sink: ptr<function, Sink>, pixel: vec2<u32>, fragment: Fragment) {
    let tile = tiles[tile_of(pixel, view.size)];
    if tile.far == 0.0 || fragment.nearness < tile.far {
        return;
    }
    let place = (pixel.y * view.size.x + pixel.x) * PARTS + part_of(tile, fragment.nearness);
    let closing = u32(occlusion.closing * BIT);
    // What closes a pixel by itself need not become more.
    if atomicLoad(&opticals[place]) < closing {
        atomicAdd(&opticals[place], min(u32(f32(optical_depth(fragment.alpha)) * (BIT / OPTICAL_UNIT)), closing));
    }
}
