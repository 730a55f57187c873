// Between which depths the hair of each tile becomes opaque, by its mass. Whether it does is found out behind it, pixel by pixel. One thread a tile.

import package::grid::{GROUP, thread_index};
import package::occlusion::{MASS_UNIT, NEVER, OccludedTile, SLICES, occlusion};
import package::screen::{nearness_at, scene_nearness, tile_columns, tile_count, view};
import package::tile::TILE;

@group(0) @binding(6) var<storage, read> masses: array<u32>;
@group(0) @binding(7) var<storage, read_write> tiles: array<OccludedTile>;

// As multiples of the mass that would close all pixels of a tile if they had the same: where hair is expected to begin to be opaque,
// and where it is opaque in all pixels but of tiles that hair does not fill.
const FIRST: f32 = 1.0;
const LAST: f32 = 2.7;

// The farthest that the opaque scene shows in a tile.
fn scene_of(tile: u32) -> f32 {
    let corner = TILE * vec2(tile % tile_columns(), tile / tile_columns());
    var nearness = NEVER;
    for (var i = 0u; i < TILE * TILE; i++) {
        // At the edge of the picture its last pixels count again.
        nearness = min(nearness, scene_nearness(min(corner + vec2(i % TILE, i / TILE), view.size - 1u)));
    }
    return max(nearness, 0.0);
}

// The nearness behind a number of slices, which need not be whole.
fn nearness_behind(slices: f32) -> f32 {
    return max(nearness_at(occlusion.nearest + slices / (f32(SLICES) - 0.5) * occlusion.depth), 0.0);
}

@compute @workgroup_size(GROUP)
fn occlusion_guess(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                   @builtin(local_invocation_index) lane: u32) {
    let tile = thread_index(group, groups, lane);
    if tile >= tile_count() {
        return;
    }
    let closing = occlusion.closing * MASS_UNIT * f32(TILE * TILE);
    var sum = 0.0;
    var near = 0.0;
    var far = 0.0;
    for (var slice = 0u; slice < SLICES; slice++) {
        let mass = f32(masses[tile * SLICES + slice]);
        let before = sum;
        sum += mass;
        if before < FIRST * closing && sum >= FIRST * closing {
            near = nearness_behind(f32(slice) + (FIRST * closing - before) / mass);
        }
        if sum >= FIRST * closing && before < LAST * closing && mass > 0.0 {
            far = nearness_behind(f32(slice) + min((LAST * closing - before) / mass, 1.0));
        }
    }
    let scene = scene_of(tile);
    far = max(far, scene);
    let is_dense = near > far;
    // Only hair before the last depth of tiles that are dense is looked at.
    tiles[tile] = OccludedTile(near, select(0.0, far, is_dense), select(NEVER, far, is_dense), 0u);
}
