// Each bin gets its place among the references, and each tile that has any waits in the queue, by the number of its references.
// Eight lanes a tile, a part of its slices each.

import package::grid::GROUP;
import package::screen::tile_count;
import package::tiles::{ALL_PARTS, BLEND_GRID, CLASSES, Queue, ROW, SLICES, STORE_GRIDS, TileInfo, ViewState, groups_of_a_tile, tiles};

@group(0) @binding(6) var<storage, read_write> bins: array<u32>;
@group(0) @binding(7) var<storage, read_write> queue: Queue;
// Tiles that may have hair and where their pixels are, and six vertices for each of them: the arguments of a draw.
@group(0) @binding(8) var<storage, read_write> hairy: array<vec2<u32>>;
@group(0) @binding(11) var<storage, read_write> tile_vertices: array<atomic<u32>, 4>;

@group(0) @binding(9) var<storage, read_write> grids: array<atomic<u32>>;
@group(0) @binding(10) var<storage, read_write> infos: array<TileInfo>;
@group(0) @binding(4) var<storage, read_write> state: ViewState;

const LANES_OF_A_TILE: u32 = 8u;
const TILES: u32 = GROUP / LANES_OF_A_TILE;
const SLICES_OF_A_LANE: u32 = SLICES / LANES_OF_A_TILE;
// Where sums end, so that they never wrap. There is never room for more than MOST / TILES references.
const MOST: u32 = 0x40000000u;
// No round has this reference.
const NOWHERE: u32 = 0xffffffffu;

var<workgroup> group_references: atomic<u32>;
var<workgroup> group_place: u32;
var<workgroup> group_tile: u32;
// Tiles of the group, and those of them that the composite does not draw yet.
var<workgroup> group_size: atomic<u32>;
var<workgroup> group_unlisted: atomic<u32>;
var<workgroup> sums: array<u32, GROUP>;
var<workgroup> tile_places: array<u32, TILES>;
var<workgroup> class_sizes: array<atomic<u32>, CLASSES>;
var<workgroup> class_places: array<u32, CLASSES>;

// Room for references of a group, at most MOST. What lies beyond the capacity does not exist.
fn request(count: u32) -> u32 {
    // All requests like this one together stay below MOST.
    if count <= MOST / (tile_count() / TILES + 1u) {
        return atomicAdd(&queue.references, count);
    }
    var old = atomicLoad(&queue.references);
    while old < MOST {
        let exchange = atomicCompareExchangeWeak(&queue.references, old, min(old + count, MOST));
        if exchange.exchanged {
            break;
        }
        old = exchange.old_value;
    }
    return old;
}

// The grid that blends holds the groups of so many tiles more. It may be longer than needed, where tiles were few before.
fn lengthen_grid(count: u32) {
    let listed = atomicAdd(&queue.size, count) + count;
    let size = groups_of_a_tile(listed) * listed;
    atomicMax(&grids[BLEND_GRID], min(size, ROW));
    atomicMax(&grids[BLEND_GRID + 1u], (size + ROW - 1u) / ROW);
    atomicMax(&grids[BLEND_GRID + 2u], 1u);
}

// References are stored in the rounds in which tiles begin that have theirs from `first` to `end`.
fn open_rounds(first: u32, end: u32) {
    let last = min((end - 1u) / tiles.window, tiles.rounds - 1u);
    for (var round = first / tiles.window; round <= last; round++) {
        for (var axis = 0u; axis < 3u; axis++) {
            atomicStore(&grids[STORE_GRIDS + 3u * round + axis], tiles.bin_groups[axis]);
        }
    }
}

// What the whole group asks for. One lane comes here.
fn request_of_group() {
    let count = atomicLoad(&group_references);
    group_place = request(count);
    if count == 0u {
        return;
    }
    lengthen_grid(atomicLoad(&group_size));
    open_rounds(group_place, group_place + count);
    let unlisted = atomicLoad(&group_unlisted);
    if unlisted > 0u {
        group_tile = atomicAdd(&state.counters.tiles_with_hair, unlisted);
        atomicMax(&tile_vertices[0], 6u * min(group_tile + unlisted, tiles.slots));
    }
}

// A tile with so many references from `first` on is to be blended, or is left out where its pixels have no room.
fn list_tile(tile: u32, slot: u32, first: u32, count: u32) {
    if slot >= tiles.slots {
        infos[tile].first = NOWHERE;
        infos[tile].waiting = 0u;
        // Those behind all rounds are counted by `tile_blend`.
        atomicAdd(&state.counters.dropped, min(first + count, tiles.covered) - min(first, tiles.covered));
        return;
    }
    infos[tile].first = first;
    infos[tile].slot = slot + 1u;
    hairy[slot] = vec2(tile, slot);
}

@compute @workgroup_size(GROUP)
fn tile_alloc(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let own = lane % TILES;
    let part = lane / TILES;
    let tile = (group.y * groups.x + group.x) * TILES + own;
    if lane == 0u {
        atomicStore(&group_references, 0u);
        atomicStore(&group_size, 0u);
        atomicStore(&group_unlisted, 0u);
    }
    if lane < CLASSES {
        atomicStore(&class_sizes[lane], 0u);
    }
    var in_bins: array<u32, SLICES_OF_A_LANE>;
    var sum = 0u;
    var info: TileInfo;
    if tile < tile_count() {
        info = infos[tile];
    }
    if info.waiting != 0u {
        for (var i = 0u; i < SLICES_OF_A_LANE; i++) {
            in_bins[i] = bins[(part * SLICES_OF_A_LANE + i) * tile_count() + tile];
        }
        for (var i = 0u; i < SLICES_OF_A_LANE; i++) {
            sum = min(sum + min(in_bins[i], MOST), MOST);
        }
    }
    sums[lane] = sum;
    workgroupBarrier();
    // Of the slices before those of this lane, and of all.
    var before = 0u;
    var count = 0u;
    for (var i = 0u; i < LANES_OF_A_TILE; i++) {
        if i == part {
            before = count;
        }
        count = min(count + sums[i * TILES + own], MOST);
    }
    let load_class = min(firstLeadingBit(max(count, 1u)) / 2u, CLASSES - 1u);
    var position = 0u;
    var place_of_tile = 0u;
    if part == 0u && info.waiting == ALL_PARTS {
        // It is known again when the tile has been blended.
        atomicStore(&state.tiles[tile].hidden, 0u);
    }
    if part == 0u && count > 0u {
        // A tile with more than this ends behind the last reference that there is room for.
        tile_places[own] = atomicAdd(&group_references, min(count, MOST / TILES));
        position = atomicAdd(&class_sizes[load_class], 1u);
        atomicAdd(&group_size, 1u);
        if info.slot == 0u {
            place_of_tile = atomicAdd(&group_unlisted, 1u);
        }
    }
    workgroupBarrier();
    if lane == 0u {
        request_of_group();
    }
    if lane < CLASSES && atomicLoad(&class_sizes[lane]) > 0u {
        class_places[lane] = atomicAdd(&queue.sizes[lane], atomicLoad(&class_sizes[lane]));
    }
    workgroupBarrier();
    // Nor has a tile that is blended already, or a lane beyond the last tile.
    if count == 0u {
        return;
    }
    let first = group_place + tile_places[own];
    var place = first + before;
    for (var i = 0u; i < SLICES_OF_A_LANE; i++) {
        bins[(part * SLICES_OF_A_LANE + i) * tile_count() + tile] = place;
        place = min(place + min(in_bins[i], MOST), 2u * MOST);
    }
    if part == 0u {
        list_tile(tile, select(info.slot - 1u, group_tile + place_of_tile, info.slot == 0u), first, count);
        queue.tiles[load_class * tile_count() + class_places[load_class] + position] = tile;
    }
}
