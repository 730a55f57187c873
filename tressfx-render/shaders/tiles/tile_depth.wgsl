// What is behind the farthest that the opaque scene shows in a tile is not referred to; nor is, where hair is dense, what was hidden
// by hair in the frame before, in the tile and, while hair is restless, in those around it. Whether it is hidden again is seen when the tile is blended. Eight
// lanes a tile, one a row of pixels and one a neighbour.

import package::grid::GROUP;
import package::screen::{scene_nearness, tile_columns, tile_count, view};
import package::tile::TILE;
import package::tiles::{ALL_PARTS, NOTHING_HIDDEN, TileInfo, ViewState, is_restless, tiles};

@group(0) @binding(4) var<storage, read_write> state: ViewState;
@group(0) @binding(6) var<storage, read_write> infos: array<TileInfo>;

const TILES: u32 = GROUP / TILE;

var<workgroup> farthest: array<atomic<u32>, TILES>;
var<workgroup> hidden: array<atomic<u32>, TILES>;

// What was hidden in the tile at a place. What is outside of the picture does not matter.
fn hidden_at(place: vec2<i32>) -> u32 {
    let columns = i32(tile_columns());
    if any(place < vec2(0)) || place.x >= columns || place.y * columns + place.x >= i32(tile_count()) {
        return 0u;
    }
    let hidden = atomicLoad(&state.tiles[u32(place.y * columns + place.x)].hidden);
    return select(hidden, NOTHING_HIDDEN, hidden == 0u);
}

// One of the eight tiles around a tile.
fn neighbor(place: vec2<u32>, lane: u32) -> vec2<i32> {
    // Without the one in the middle.
    let i = lane + u32(lane >= 4u);
    return vec2<i32>(place + vec2(i % 3u, i / 3u)) - 1;
}

@compute @workgroup_size(GROUP)
fn tile_depth(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let own = lane / TILE;
    let tile = (group.y * groups.x + group.x) * TILES + own;
    let place = vec2(tile % tile_columns(), tile / tile_columns());
    if lane % TILE == 0u {
        atomicStore(&farthest[own], bitcast<u32>(1e30f));
        atomicStore(&hidden[own], 0u);
    }
    workgroupBarrier();
    let row = place.y * TILE + lane % TILE;
    if tile < tile_count() && row < view.size.y {
        var nearness = 1e30;
        for (var x = 0u; x < TILE; x++) {
            // At the edge of the picture the last column counts again: with a fixed number of rounds all are read at once.
            nearness = min(nearness, scene_nearness(vec2(min(place.x * TILE + x, view.size.x - 1u), row)));
        }
        // Numbers that are not negative are in the order of their bits.
        atomicMin(&farthest[own], bitcast<u32>(max(nearness, 0.0)));
    }
    if tile < tile_count() && tiles.skips_hidden == 1u {
        var all = hidden_at(vec2<i32>(place));
        if is_restless(atomicLoad(&state.reopened)) {
            all = max(all, hidden_at(neighbor(place, lane % TILE)));
        }
        atomicMax(&hidden[own], all);
    }
    workgroupBarrier();
    if lane % TILE == 0u && tile < tile_count() {
        let scene = bitcast<f32>(atomicLoad(&farthest[own]));
        var seen = scene;
        if tiles.skips_hidden == 1u {
            seen = max(scene, bitcast<f32>(~atomicLoad(&hidden[own])));
        }
        infos[tile] = TileInfo(0.0, seen, scene, 0u, ALL_PARTS, 0u);
    }
}
