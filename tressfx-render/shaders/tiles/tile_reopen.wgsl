// Tiles in which hair behind some nearness was left out, and which let light through to it, are drawn again with all of it. For all other
// tiles nothing is referred to any more. One thread a tile.

import package::blocks::{SharedBlocks, block_of, block_word};
import package::grid::{GROUP, thread_index};
import package::screen::tile_count;
import package::tiles::{ALLOC_GRID, COUNT_GRID, SLICES, TileInfo, ViewState, is_cut, tiles};

@group(0) @binding(4) var<storage, read_write> state: ViewState;
@group(0) @binding(6) var<storage, read_write> infos: array<TileInfo>;
@group(0) @binding(7) var<storage, read_write> bins: array<u32>;
@group(0) @binding(9) var<storage, read_write> grids_again: array<atomic<u32>>;
@group(0) @binding(13) var<storage, read_write> blocks: SharedBlocks;

// Nothing is as near.
const NEAREST: f32 = 1e30;

fn open_grids() {
    for (var axis = 0u; axis < 3u; axis++) {
        atomicStore(&grids_again[COUNT_GRID + axis], tiles.bin_groups[axis]);
        atomicStore(&grids_again[ALLOC_GRID + axis], tiles.alloc_groups[axis]);
    }
}

@compute @workgroup_size(GROUP)
fn tile_reopen(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let tile = thread_index(group, groups, lane);
    if tile >= tile_count() {
        return;
    }
    let info = infos[tile];
    if info.waiting == 0u || !is_cut(info) {
        infos[tile].waiting = 0u;
        infos[tile].farthest = NEAREST;
        return;
    }
    atomicStore(&state.reopened, tiles.frame);
    infos[tile].farthest = info.scene;
    atomicStore(&blocks.are_drawn_again, 1u);
    atomicMax(&blocks.words[block_of(tile)], block_word(info.scene));
    for (var slice = 0u; slice < SLICES; slice++) {
        bins[slice * tile_count() + tile] = 0u;
    }
    open_grids();
}
