// Each bin gets its place among the references, and each tile that has any waits in the queue, by the number of its references.
// Eight lanes a tile, a part of its slices each.

import package::grid::GROUP;
import package::tiles::{CLASSES, QUARTERS, Queue, ROW, SLICES, WaitingTile, tile_count};

@group(0) @binding(6) var<storage, read_write> bins: array<u32>;
@group(0) @binding(7) var<storage, read_write> queue: Queue;
// Tiles that may have hair, and six vertices for each of them: the arguments of a draw.
@group(0) @binding(8) var<storage, read_write> hairy: array<u32>;
@group(0) @binding(11) var<storage, read_write> tile_vertices: array<atomic<u32>, 4>;

// The grid of groups that takes a quarter of a tile each.
@group(0) @binding(9) var<storage, read_write> groups_of_tiles: array<atomic<u32>, 3>;

// Nearness of the nearest vertex, a tile.
@group(0) @binding(10) var<storage, read> nearests: array<f32>;

// The first reference of a tile.
@group(0) @binding(12) var<storage, read_write> firsts: array<u32>;

const PARTS: u32 = 8u;
const TILES: u32 = GROUP / PARTS;
const SLICES_OF_A_LANE: u32 = SLICES / PARTS;
// Where sums end, so that they never wrap. There is never room for more than MOST / TILES references.
const MOST: u32 = 0x40000000u;

var<workgroup> group_references: atomic<u32>;
var<workgroup> group_place: u32;
var<workgroup> group_tile: u32;
var<workgroup> group_size: atomic<u32>;
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

// The draw holds so many tiles more, and the grid their quarters. Returns how many tiles there were.
fn lengthen(tiles: u32) -> u32 {
    if tiles == 0u {
        return 0u;
    }
    let before = atomicAdd(&tile_vertices[0], 6u * tiles) / 6u;
    let size = QUARTERS * (before + tiles);
    atomicMax(&groups_of_tiles[0], min(size, ROW));
    atomicMax(&groups_of_tiles[1], (size + ROW - 1u) / ROW);
    atomicMax(&groups_of_tiles[2], 1u);
    return before;
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
    }
    if lane < CLASSES {
        atomicStore(&class_sizes[lane], 0u);
    }
    var in_bins: array<u32, SLICES_OF_A_LANE>;
    var sum = 0u;
    if tile < tile_count() {
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
    for (var i = 0u; i < PARTS; i++) {
        if i == part {
            before = count;
        }
        count = min(count + sums[i * TILES + own], MOST);
    }
    let load_class = min(firstLeadingBit(max(count, 1u)) / 2u, CLASSES - 1u);
    var position = 0u;
    var place_of_tile = 0u;
    if part == 0u && count > 0u {
        // A tile with more than this ends behind the last reference that there is room for.
        tile_places[own] = atomicAdd(&group_references, min(count, MOST / TILES));
        position = atomicAdd(&class_sizes[load_class], 1u);
        place_of_tile = atomicAdd(&group_size, 1u);
    }
    workgroupBarrier();
    if lane == 0u {
        group_place = request(atomicLoad(&group_references));
        group_tile = lengthen(atomicLoad(&group_size));
    }
    if lane < CLASSES && atomicLoad(&class_sizes[lane]) > 0u {
        class_places[lane] = atomicAdd(&queue.sizes[lane], atomicLoad(&class_sizes[lane]));
    }
    workgroupBarrier();
    // Nor has a lane beyond the last tile.
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
        firsts[tile] = first;
        hairy[group_tile + place_of_tile] = tile;
        queue.tiles[load_class * tile_count() + class_places[load_class] + position] =
            WaitingTile(tile, first, nearests[tile], 0u);
    }
}
