// The zero surface of a field, by marching tetrahedra: each cell is six tetrahedra around its diagonal (Kuhn 1960), the same in all cells, so that neighbours have
// the same edges and no case is ambiguous. Edges go from a node to the seven other corners of its cell, and belong to that node.

import package::field::{FIRST, HEADER, NODES, fields};
import package::nodes::{corner_of, node_index};

struct SurfaceBuild {
    /// The index of the field.
    field: u32,
    /// How many nodes it has.
    nodes: u32,
    /// Vertices and triangles that there is room for.
    vertex_room: u32,
    triangle_room: u32,
}

@group(0) @binding(0) var<uniform> build: SurfaceBuild;

/// Tetrahedra of a cell.
const TETRAHEDRA: u32 = 6u;

/// Nodes along x, y and z.
fn sides() -> vec3<u32> {
    let at = HEADER * build.field + NODES;
    return vec3(fields[at], fields[at + 1u], fields[at + 2u]);
}

fn distance_at(node: vec3<u32>, nodes: vec3<u32>) -> f32 {
    return bitcast<f32>(fields[fields[HEADER * build.field + FIRST] + node_index(node, nodes)]);
}

/// The corners of the cell of a node that are inside, a bit each. Corners beyond the last node are as the node is.
fn inside_corners(node: vec3<u32>, nodes: vec3<u32>) -> u32 {
    let is_inside = distance_at(node, nodes) < 0.0;
    var inside = u32(is_inside);
    for (var corner = 1u; corner < 8u; corner++) {
        let at = node + corner_of(corner);
        var corner_is_inside = is_inside;
        if (all(at < nodes)) { corner_is_inside = distance_at(at, nodes) < 0.0; }
        inside |= u32(corner_is_inside) << corner;
    }
    return inside;
}

/// The edges of a node that the surface crosses, a bit each: that of corner `i` is bit `i - 1`.
fn crossed_edges(inside: u32) -> u32 {
    return (select(inside, ~inside, (inside & 1u) == 1u) >> 1u) & 0x7fu;
}

/// The corners of a tetrahedron, each further than the one before. Those of an even index are right-handed.
fn corners_of(tetrahedron: u32) -> vec4<u32> {
    let first = tetrahedron / 2u;
    let second = (first + 1u + tetrahedron % 2u) % 3u;
    return vec4(0u, 1u << first, (1u << first) | (1u << second), 7u);
}

/// The corners of a tetrahedron that are inside, a bit each in their order.
fn inside_of(corners: vec4<u32>, inside: u32) -> u32 {
    return dot((vec4(inside) >> corners) & vec4(1u), vec4(1u, 2u, 4u, 8u));
}

fn has_cell(node: vec3<u32>, nodes: vec3<u32>) -> bool {
    return all(node + 1u < nodes);
}
