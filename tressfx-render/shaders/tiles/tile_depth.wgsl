// The nearness of the farthest that the opaque scene shows in each tile: what is behind it is not referred to. And how the
// slices of the tile are shared out among the ranges of depth: by the vertices in them, with less weight where hair in front of
// them hides them. Eight lanes a tile, one a row of pixels.

import package::grid::GROUP;
import package::screen::{scene_nearness, view};
import package::tiles::{RANGES, TILE, tile_columns, tile_count, tiles};

@group(0) @binding(6) var<storage, read_write> depths: array<f32>;
// A range of a tile: vertices, and then, as bits of a float, the share of the slices up to its end.
@group(0) @binding(7) var<storage, read_write> shares: array<u32>;

// The share of the slices that all ranges have alike, hair or none.
const EVEN: f32 = 0.1;

const TILES: u32 = GROUP / TILE;

var<workgroup> farthest: array<atomic<u32>, TILES>;

// Shares the slices of a tile out.
fn share_out(tile: u32) {
    var weights: array<f32, RANGES>;
    var before = 0.0;
    var sum = 0.0;
    for (var i = 0u; i < RANGES; i++) {
        let vertices = f32(shares[tile * RANGES + i]);
        weights[i] = vertices / (1.0 + before / tiles.layer);
        before += vertices;
        sum += weights[i];
    }
    let even = select(1.0, EVEN, sum > 0.0) / f32(RANGES);
    var share = 0.0;
    for (var i = 0u; i < RANGES; i++) {
        share += even + (1.0 - EVEN) * weights[i] / max(sum, 1e-10);
        shares[tile * RANGES + i] = bitcast<u32>(min(share, 1.0));
    }
}

@compute @workgroup_size(GROUP)
fn tile_depth(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let own = lane / TILE;
    let tile = (group.y * groups.x + group.x) * TILES + own;
    if lane % TILE == 0u {
        atomicStore(&farthest[own], bitcast<u32>(1e30f));
    }
    workgroupBarrier();
    let corner = vec2(tile % tile_columns(), tile / tile_columns()) * TILE;
    let row = corner.y + lane % TILE;
    if tile < tile_count() && row < view.size.y {
        var nearness = 1e30;
        for (var x = corner.x; x < min(corner.x + TILE, view.size.x); x++) {
            nearness = min(nearness, scene_nearness(vec2(x, row)));
        }
        // Numbers that are not negative are in the order of their bits.
        atomicMin(&farthest[own], bitcast<u32>(max(nearness, 0.0)));
    }
    workgroupBarrier();
    if lane % TILE == 0u && tile < tile_count() {
        depths[tile] = bitcast<f32>(atomicLoad(&farthest[own]));
        share_out(tile);
    }
}
