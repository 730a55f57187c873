// How many vertices and triangles are before each block, and how many there are. One group: each lane sums up the blocks of its part, then
// what is before it is known.

import package::grid::GROUP;
import package::surface::build;

/// Vertices and triangles of each block; those before it, afterwards.
@group(0) @binding(1) var<storage, read_write> blocks: array<vec2<u32>>;
/// What a draw is told (indices, 1, 0, 0), then vertices and triangles. No indices where there is no room for all.
@group(0) @binding(2) var<storage, read_write> size: array<u32, 6>;

const LANES: u32 = 256u;

var<workgroup> sums: array<vec2<u32>, LANES>;

@compute @workgroup_size(LANES)
fn surface_scan(@builtin(local_invocation_index) lane: u32) {
    let count = (build.nodes + GROUP - 1u) / GROUP;
    let each = (count + LANES - 1u) / LANES;
    let first = min(lane * each, count);
    let last = min(first + each, count);
    var own = vec2(0u);
    for (var block = first; block < last; block++) { own += blocks[block]; }
    sums[lane] = own;
    for (var reach = 1u; reach < LANES; reach *= 2u) {
        workgroupBarrier();
        var before = vec2(0u);
        if (lane >= reach) { before = sums[lane - reach]; }
        workgroupBarrier();
        sums[lane] += before;
    }
    var before = sums[lane] - own;
    for (var block = first; block < last; block++) {
        let here = blocks[block];
        blocks[block] = before;
        before += here;
    }
    if (lane == LANES - 1u) {
        let total = sums[lane];
        let has_room = total.x <= build.vertex_room && total.y <= build.triangle_room;
        size = array<u32, 6>(select(0u, 3u * total.y, has_room), 1u, 0u, 0u, total.x, total.y);
    }
}
