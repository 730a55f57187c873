// The segments of a section that are not behind what is seen farthest in all tiles that they may touch. One lane takes some of a strand; it
// is run before and behind `occlusion_depth`.

import package::grid::GROUP;
import package::occlusion::OccludedTile;
import package::points::{ANYWHERE, NOWHERE, SOMEWHERE, point_of, reach_between};
import package::screen::tile_columns;
import package::strands::{Strand, end_at, is_sound_at, section, strand_at};

struct SegmentList {
    count: atomic<u32>,
    segments: array<u32>,
}

// How the list is walked: groups of threads, or vertices of a draw.
struct ListGrid {
    groups: array<atomic<u32>, 3>,
    unused: u32,
    vertices: atomic<u32>,
    instances: u32,
    first: vec2<u32>,
}

@group(0) @binding(6) var<storage, read> tiles: array<OccludedTile>;
@group(0) @binding(7) var<storage, read_write> list: SegmentList;
@group(0) @binding(8) var<storage, read_write> grid: ListGrid;

const LANES: u32 = 256u;
// Segments of a strand that a lane looks at.
const LOOKS: u32 = 4u;
const MOST_GROUPS: u32 = 65535u;

var<workgroup> found: atomic<u32>;
var<workgroup> first: u32;

// Whether something is seen at a nearness in any of these tiles.
fn is_before(nearest: f32, low: vec2<i32>, high: vec2<i32>) -> bool {
    let columns = i32(tile_columns());
    for (var row = low.y; row <= high.y; row++) {
        for (var column = low.x; column <= high.x; column++) {
            if nearest >= tiles[row * columns + column].farthest {
                return true;
            }
        }
    }
    return false;
}

// A vertex on the screen, see `point_of`; nowhere if it is not sound.
fn vertex_at(strand: Strand, vertex: u32) -> vec4<f32> {
    if !is_sound_at(strand, vertex) {
        return NOWHERE;
    }
    return point_of(end_at(strand, vertex));
}

fn may_be_seen(a: vec4<f32>, b: vec4<f32>) -> bool {
    let reach = reach_between(a, b);
    if reach.place != SOMEWHERE {
        return reach.place == ANYWHERE;
    }
    return is_before(reach.nearest, reach.low, reach.high);
}

// Which of the segments of a strand from a vertex on may be seen: a bit for each of LOOKS. They share their vertices, which take most of the time.
fn seen_from(number: u32, first: u32) -> u32 {
    let end = min(first + LOOKS, section.lod.vertices - 1u);
    if first >= end {
        return 0u;
    }
    let strand = strand_at(number);
    var seen = 0u;
    var before = vertex_at(strand, first);
    for (var vertex = first; vertex < end; vertex++) {
        let behind = vertex_at(strand, vertex + 1u);
        seen |= u32(may_be_seen(before, behind)) << (vertex - first);
        before = behind;
    }
    return seen;
}

// Finds a place for all of the group, and threads that walk them.
fn place_all(count: u32) {
    first = atomicAdd(&list.count, count);
    let end = first + count;
    let groups = (end + GROUP - 1u) / GROUP;
    let rows = (groups + MOST_GROUPS - 1u) / MOST_GROUPS;
    atomicMax(&grid.groups[0], (groups + rows - 1u) / rows);
    atomicMax(&grid.groups[1], rows);
    atomicMax(&grid.vertices, 6u * end);
}

@compute @workgroup_size(LANES)
fn occlusion_list(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                  @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        atomicStore(&found, 0u);
    }
    workgroupBarrier();
    let thread = (group.y * groups.x + group.x) * LANES + lane;
    let number = thread % section.lod.strands;
    let vertex = thread / section.lod.strands * LOOKS;
    let seen = seen_from(number, vertex);
    var place = atomicAdd(&found, countOneBits(seen));
    workgroupBarrier();
    let count = atomicLoad(&found);
    if lane == 0u && count > 0u {
        place_all(count);
    }
    workgroupBarrier();
    place += first;
    for (var i = 0u; i < LOOKS; i++) {
        if ((seen >> i) & 1u) == 1u {
            list.segments[place] = (vertex + i) * section.lod.strands + number;
            place++;
        }
    }
}
