// How many vertices and triangles of the surface each node has. One thread a node; the threads of a group are a block, whose sums are kept.

import package::grid::{GROUP, thread_index};
import package::nodes::node_at;
import package::surface::{
    TETRAHEDRA, build, corners_of, crossed_edges, has_cell, inside_corners, inside_of, sides,
};

/// The edges that are crossed, 7 bits; vertices before it in its block, from bit 8 on; triangles before it, from bit 20 on.
@group(0) @binding(1) var<storage, read_write> cells: array<u32>;
/// Vertices and triangles of each block.
@group(0) @binding(2) var<storage, read_write> blocks: array<vec2<u32>>;

/// Vertices, and triangles from bit 16 on: of a lane and of those before it.
var<workgroup> sums: array<u32, GROUP>;

@compute @workgroup_size(GROUP)
fn surface_count(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                 @builtin(local_invocation_index) lane: u32) {
    let index = thread_index(group, groups, lane);
    var edges = 0u;
    var own = 0u;
    if (index < build.nodes) {
        let nodes = sides();
        let node = node_at(index, nodes);
        let inside = inside_corners(node, nodes);
        edges = crossed_edges(inside);
        own = countOneBits(edges);
        if (has_cell(node, nodes)) { own |= triangles_of(inside) << 16u; }
    }
    sums[lane] = own;
    for (var reach = 1u; reach < GROUP; reach *= 2u) {
        workgroupBarrier();
        var before = 0u;
        if (lane >= reach) { before = sums[lane - reach]; }
        workgroupBarrier();
        sums[lane] += before;
    }
    let before = sums[lane] - own;
    if (index < build.nodes) { cells[index] = edges | ((before & 0xffffu) << 8u) | ((before >> 16u) << 20u); }
    let block = index / GROUP;
    if (lane == GROUP - 1u && block < (build.nodes + GROUP - 1u) / GROUP) {
        blocks[block] = vec2(sums[lane] & 0xffffu, sums[lane] >> 16u);
    }
}

/// Triangles of a cell: one where a corner of a tetrahedron is on its own, two where two are.
fn triangles_of(inside: u32) -> u32 {
    var triangles = 0u;
    for (var i = 0u; i < TETRAHEDRA; i++) {
        let count = countOneBits(inside_of(corners_of(i), inside));
        triangles += min(count, 4u - count);
    }
    return triangles;
}
