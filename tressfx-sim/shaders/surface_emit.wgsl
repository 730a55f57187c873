// The vertices and triangles of the surface, in the order of the nodes. One thread a node. Nothing is written where there is no room for all.

import package::field::{CELL, ORIGIN, header};
import package::grid::{GROUP, thread_index};
import package::nodes::{corner_of, node_at, node_index};
import package::surface::{
    TETRAHEDRA, build, corners_of, distance_at, has_cell, inside_corners, inside_of, sides,
};

@group(0) @binding(1) var<storage, read> cells: array<u32>;
/// Vertices and triangles before each block.
@group(0) @binding(2) var<storage, read> blocks: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> size: array<u32, 6>;
/// Position, 1; normal, 0.
@group(0) @binding(4) var<storage, read_write> surface_vertices: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> surface_indices: array<u32>;

@compute @workgroup_size(GROUP)
fn surface_emit(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) lane: u32) {
    let index = thread_index(group, groups, lane);
    if (index >= build.nodes || size[0] == 0u) { return; }
    let nodes = sides();
    let node = node_at(index, nodes);
    emit_vertices(index, node, nodes);
    if (has_cell(node, nodes)) { emit_triangles(index, node, nodes); }
}

fn emit_vertices(index: u32, node: vec3<u32>, nodes: vec3<u32>) {
    let edges = cells[index] & 0x7fu;
    if (edges == 0u) { return; }
    let origin = vec3(header(build.field, ORIGIN), header(build.field, ORIGIN + 1u), header(build.field, ORIGIN + 2u));
    let here = distance_at(node, nodes);
    let slope = slope_at(node, nodes);
    var at = first_vertex(index);
    for (var corner = 1u; corner < 8u; corner++) {
        if ((edges & (1u << (corner - 1u))) == 0u) { continue; }
        let way = corner_of(corner);
        let other = node + way;
        let share = here / (here - distance_at(other, nodes));
        let place = vec3<f32>(node) + share * vec3<f32>(way);
        let normal = mix(slope, slope_at(other, nodes), share);
        let squared = dot(normal, normal);
        // Where it is flat, as in the middle of a sheet, the edge says which way is out.
        let way_out = normalize(vec3<f32>(way)) * select(1.0, -1.0, here >= 0.0);
        let outside = select(way_out, normal * inverseSqrt(squared), squared > 0.0);
        surface_vertices[2u * at] = vec4(origin + header(build.field, CELL) * place, 1.0);
        surface_vertices[2u * at + 1u] = vec4(outside, 0.0);
        at++;
    }
}

/// How the distance changes around a node, in cells.
fn slope_at(node: vec3<u32>, nodes: vec3<u32>) -> vec3<f32> {
    let low = max(node, vec3(1u)) - 1u;
    let high = min(node + 1u, nodes - 1u);
    let along_x = distance_at(vec3(high.x, node.yz), nodes) - distance_at(vec3(low.x, node.yz), nodes);
    let along_y = distance_at(vec3(node.x, high.y, node.z), nodes) - distance_at(vec3(node.x, low.y, node.z), nodes);
    let along_z = distance_at(vec3(node.xy, high.z), nodes) - distance_at(vec3(node.xy, low.z), nodes);
    return vec3(along_x, along_y, along_z) / header(build.field, CELL);
}

fn emit_triangles(index: u32, node: vec3<u32>, nodes: vec3<u32>) {
    let inside = inside_corners(node, nodes);
    if (inside == 0u || inside == 0xffu) { return; }
    var at = blocks[index / GROUP].y + (cells[index] >> 20u);
    for (var i = 0u; i < TETRAHEDRA; i++) {
        let corners = corners_of(i);
        let bits = inside_of(corners, inside);
        let count = countOneBits(bits);
        if (count == 0u || count == 4u) { continue; }
        // Those inside first, each in their order. Whether that is an odd permutation, and the hand of the tetrahedron, say which way around triangles go.
        var order: vec4<u32>;
        var ins = 0u;
        var outs = count;
        var is_turned = i % 2u == 1u;
        for (var corner = 0u; corner < 4u; corner++) {
            if ((bits & (1u << corner)) != 0u) {
                is_turned = is_turned != ((outs - count) % 2u == 1u);
                order[ins] = corners[corner];
                ins++;
            } else {
                order[outs] = corners[corner];
                outs++;
            }
        }
        if (count == 2u) {
            let a = vertex_on(node, order.x, order.z, nodes);
            let b = vertex_on(node, order.x, order.w, nodes);
            let c = vertex_on(node, order.y, order.w, nodes);
            let d = vertex_on(node, order.y, order.z, nodes);
            emit(at, vec3(a, b, c), is_turned);
            emit(at + 1u, vec3(a, c, d), is_turned);
            at += 2u;
        } else {
            // The one on its own, inside or outside, and the others.
            let lone = select(order.w, order.x, count == 1u);
            let others = select(order.xyz, order.yzw, count == 1u);
            let a = vertex_on(node, lone, others.x, nodes);
            let b = vertex_on(node, lone, others.y, nodes);
            let c = vertex_on(node, lone, others.z, nodes);
            emit(at, vec3(a, b, c), is_turned);
            at++;
        }
    }
}

fn emit(triangle: u32, corners: vec3<u32>, is_turned: bool) {
    let at = 3u * triangle;
    surface_indices[at] = corners.x;
    surface_indices[at + 1u] = select(corners.y, corners.z, is_turned);
    surface_indices[at + 2u] = select(corners.z, corners.y, is_turned);
}

/// The first vertex of a node.
fn first_vertex(index: u32) -> u32 {
    return blocks[index / GROUP].x + ((cells[index] >> 8u) & 0xfffu);
}

/// The vertex on the edge between two corners of a cell: it belongs to the nearer one, and counts those before it.
fn vertex_on(node: vec3<u32>, one: u32, other: u32, nodes: vec3<u32>) -> u32 {
    let owner = node_index(node + corner_of(one & other), nodes);
    let edge = (one ^ other) - 1u;
    return first_vertex(owner) + countOneBits(cells[owner] & ((1u << edge) - 1u));
}
