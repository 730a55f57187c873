// Each bin gets its place among the references, and each tile that has any waits in the queue, by the number of its references.
// One thread a tile.

import package::grid::{GROUP, thread_index};
import package::screen::view;
import package::tiles::{CLASSES, Queue, ROW, SLICES, tile_count};

@group(0) @binding(6) var<storage, read_write> bins: array<u32>;
@group(0) @binding(7) var<storage, read_write> queue: Queue;
// Pixels with hair, a tile.
@group(0) @binding(8) var<storage, read_write> hairy: array<u32>;

// The grid of groups that takes a tile each.
@group(0) @binding(9) var<storage, read_write> groups_of_tiles: array<atomic<u32>, 3>;

// Where sums end, so that they never wrap. There is never room for more than MOST / GROUP references.
const MOST: u32 = 0x40000000u;

var<workgroup> group_references: atomic<u32>;
var<workgroup> group_place: u32;
var<workgroup> group_size: atomic<u32>;
var<workgroup> class_sizes: array<atomic<u32>, CLASSES>;
var<workgroup> class_places: array<u32, CLASSES>;

// Room for references of a group. What lies beyond the capacity does not exist.
fn request(count: u32) -> u32 {
    var old = atomicLoad(&queue.references);
    while old < MOST {
        let exchange = atomicCompareExchangeWeak(&queue.references, old, min(old + min(count, MOST), MOST));
        if exchange.exchanged {
            break;
        }
        old = exchange.old_value;
    }
    return old;
}

// The grid holds so many tiles more.
fn lengthen(tiles: u32) {
    if tiles > 0u {
        let size = atomicAdd(&queue.size, tiles) + tiles;
        atomicMax(&groups_of_tiles[0], min(size, ROW));
        atomicMax(&groups_of_tiles[1], (size + ROW - 1u) / ROW);
        atomicMax(&groups_of_tiles[2], 1u);
    }
}

fn references_of(tile: u32) -> u32 {
    var sum = 0u;
    for (var slice = 0u; slice < SLICES; slice++) {
        sum = min(sum + min(bins[slice * tile_count() + tile], MOST), MOST);
    }
    return sum;
}

@compute @workgroup_size(GROUP)
fn tile_alloc(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let tile = thread_index(group, groups, lane);
    if lane == 0u {
        atomicStore(&group_references, 0u);
        atomicStore(&group_size, 0u);
    }
    if lane < CLASSES {
        atomicStore(&class_sizes[lane], 0u);
    }
    workgroupBarrier();
    var count = 0u;
    if tile < tile_count() {
        count = references_of(tile);
    }
    // A tile with more than this ends behind the last reference that there is room for.
    let before = atomicAdd(&group_references, min(count, MOST / GROUP));
    let load_class = min(firstLeadingBit(max(count, 1u)), CLASSES - 1u);
    var position = 0u;
    if count > 0u {
        position = atomicAdd(&class_sizes[load_class], 1u);
        atomicAdd(&group_size, 1u);
    }
    workgroupBarrier();
    if lane == 0u {
        group_place = request(atomicLoad(&group_references));
        lengthen(atomicLoad(&group_size));
    }
    if lane < CLASSES {
        class_places[lane] = atomicAdd(&queue.sizes[lane], atomicLoad(&class_sizes[lane]));
    }
    workgroupBarrier();
    if tile >= tile_count() {
        return;
    }
    let first = group_place + before;
    var place = first;
    for (var slice = 0u; slice < SLICES; slice++) {
        let in_bin = bins[slice * tile_count() + tile];
        bins[slice * tile_count() + tile] = place;
        place = min(place + min(in_bin, MOST), 2u * MOST);
    }
    if count > 0u {
        queue.tiles[load_class * tile_count() + class_places[load_class] + position] = vec2(tile, first);
    } else {
        hairy[tile] = 0u;
    }
}
