// The nearness of the farthest that the opaque scene shows in each tile: what is behind it is not referred to. Eight lanes a
// tile, one a row of pixels.

import package::grid::GROUP;
import package::screen::{scene_nearness, view};
import package::tiles::{TILE, tile_columns, tile_count};

@group(0) @binding(6) var<storage, read_write> depths: array<f32>;

const TILES: u32 = GROUP / TILE;

var<workgroup> farthest: array<atomic<u32>, TILES>;

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
    }
}
