// What is seen farthest in each pixel: the opaque scene, or hair from the depth on at which it has become opaque; and the farthest of
// each tile. One group a tile of the region where hair may be.

import package::occlusion::{BIT, NEVER, OccludedTile, PARTS, end_of_part, occlusion};
import package::screen::{scene_nearness, view};
import package::tile::{TILE, tile_of};

@group(0) @binding(6) var<storage, read_write> tiles: array<OccludedTile>;
@group(0) @binding(7) var<storage, read> opticals: array<u32>;
@group(0) @binding(8) var occluded: texture_storage_2d<r32float, write>;

var<workgroup> farthest: atomic<u32>;

// The nearness from which on hair is opaque in a pixel; 0 where it is nowhere.
fn closed_at(tile: OccludedTile, pixel: vec2<u32>) -> f32 {
    let first = (pixel.y * view.size.x + pixel.x) * PARTS;
    let closing = u32(occlusion.closing * BIT);
    var sum = 0u;
    for (var part = 0u; part < PARTS; part++) {
        sum += opticals[first + part];
        if sum >= closing {
            return end_of_part(tile, part);
        }
    }
    return 0.0;
}

@compute @workgroup_size(8, 8)
fn occlusion_depth(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) own: vec3<u32>,
                   @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        atomicStore(&farthest, bitcast<u32>(NEVER));
    }
    workgroupBarrier();
    let corner = TILE * (view.first_tile + group.xy);
    let pixel = corner + own.xy;
    let place = tile_of(corner, view.size);
    let tile = tiles[place];
    if all(pixel < view.size) {
        var seen = max(scene_nearness(pixel), 0.0);
        if tile.far > 0.0 {
            seen = max(seen, closed_at(tile, pixel));
        }
        textureStore(occluded, pixel, vec4(seen, 0.0, 0.0, 0.0));
        // Numbers that are not negative are in the order of their bits.
        atomicMin(&farthest, bitcast<u32>(seen));
    }
    workgroupBarrier();
    if lane == 0u {
        tiles[place].farthest = bitcast<f32>(atomicLoad(&farthest));
    }
}
