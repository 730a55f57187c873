//! `hair.sim.surface_count` on the CPU.

use glam::UVec3;

use super::field::{Field, FieldGrid};

/// What a node has of the zero surface of a field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeSurface {
    /// Its edges to the corners 1 to 7 of its cell that are crossed, a bit each: there is a vertex on each.
    pub edges: u32,
    /// Triangles of its cell.
    pub triangles: u32,
}

/// What each node has of the zero surface. Cells are six tetrahedra each, all around the diagonal from the node (Kuhn 1960); a corner of a cell is a number of three bits:
/// whether it is the further one along x, y and z.
pub fn surface_count(field: &Field) -> Vec<NodeSurface> {
    (0..field.grid.count()).map(|index| node_surface(field, field.grid.node(index))).collect()
}

fn node_surface(field: &Field, node: UVec3) -> NodeSurface {
    let inside = |corner: u32| is_inside(field, node + way_to(corner)).unwrap_or(false);
    let is_crossed = |corner: &u32| is_inside(field, node + way_to(*corner)).is_some_and(|side| side != inside(0));
    let edges = (1..8).filter(is_crossed).map(|corner| 1 << (corner - 1)).sum();
    if !has_cell(&field.grid, node) {
        return NodeSurface { edges, triangles: 0 };
    }
    let of_tetrahedron = |corners: [u32; 4]| {
        let count = corners.into_iter().filter(|corner| inside(*corner)).count() as u32;
        count.min(4 - count)
    };
    NodeSurface { edges, triangles: tetrahedra().map(of_tetrahedron).sum() }
}

/// Whether a node is inside; none where there is no such node.
fn is_inside(field: &Field, node: UVec3) -> Option<bool> {
    node.cmplt(field.grid.nodes).all().then(|| field.distances[field.grid.index(node)] < 0.0)
}

/// Whether all corners of the cell of a node are nodes.
pub(super) fn has_cell(grid: &FieldGrid, node: UVec3) -> bool {
    (node + 1).cmplt(grid.nodes).all()
}

/// From a node to a corner of its cell.
pub(super) fn way_to(corner: u32) -> UVec3 {
    UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2)
}

/// The tetrahedra of a cell: their corners go along one axis after the other.
pub(super) fn tetrahedra() -> impl Iterator<Item = [u32; 4]> {
    (0..6).map(|index| {
        let first = index / 2;
        let second = (first + 1 + index % 2) % 3;
        [0, 1 << first, 1 << first | 1 << second, 7]
    })
}
