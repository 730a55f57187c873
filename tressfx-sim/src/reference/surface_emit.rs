//! `hair.sim.surface_emit` in f64.

use glam::{DVec3, IVec3, UVec3};

use super::field::Field;
use super::surface_count::{NodeSurface, has_cell, surface_count, tetrahedra, way_to};
use super::surface_scan::surface_scan;

/// The zero surface of a field: the position and the normal of each vertex, and triangles, counter-clockwise seen from outside.
pub fn surface_emit(field: &Field) -> (Vec<[DVec3; 2]>, Vec<[u32; 3]>) {
    let counts = surface_count(field);
    let firsts = surface_scan(&counts);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (index, node) in counts.iter().enumerate() {
        let place = field.grid.node(index);
        let crossed = (1..8u32).filter(|corner| node.edges >> (corner - 1) & 1 == 1);
        vertices.extend(crossed.map(|corner| vertex(field, place, way_to(corner))));
        if node.triangles > 0 && has_cell(&field.grid, place) {
            triangles.extend(triangles_of(field, place, &counts, &firsts));
        }
    }
    (vertices, triangles)
}

/// Where the surface crosses an edge.
fn vertex(field: &Field, node: UVec3, way: UVec3) -> [DVec3; 2] {
    let at = |node: UVec3| field.distances[field.grid.index(node)];
    let share = at(node) / (at(node) - at(node + way));
    let place = node.as_dvec3() + share * way.as_dvec3();
    let normal = slope(field, node).lerp(slope(field, node + way), share);
    let out = if at(node) < 0.0 { way.as_dvec3() } else { -way.as_dvec3() };
    [field.grid.origin + field.grid.cell * place, normal.normalize_or(out.normalize())]
}

/// How the distance changes around a node.
fn slope(field: &Field, node: UVec3) -> DVec3 {
    let along = |axis: usize| {
        let step = IVec3::AXES[axis];
        let beside =
            |step: IVec3| (node.as_ivec3() + step).clamp(IVec3::ZERO, field.grid.nodes.as_ivec3() - 1).as_uvec3();
        field.distances[field.grid.index(beside(step))] - field.distances[field.grid.index(beside(-step))]
    };
    DVec3::new(along(0), along(1), along(2)) / field.grid.cell
}

/// The triangles of a cell. They face the way from the corners that are inside to the others.
fn triangles_of(field: &Field, node: UVec3, counts: &[NodeSurface], firsts: &[[u32; 2]]) -> Vec<[u32; 3]> {
    let distance = |corner: u32| field.distances[field.grid.index(node + way_to(corner))];
    let vertex_on = |[one, other]: [u32; 2]| {
        let owner = field.grid.index(node + way_to(one & other));
        let before = counts[owner].edges & ((1 << ((one ^ other) - 1)) - 1);
        firsts[owner][0] + before.count_ones()
    };
    let middle = |[one, other]: [u32; 2]| (way_to(one) + way_to(other)).as_dvec3();
    let mut found = Vec::new();
    for corners in tetrahedra() {
        let (ins, outs): (Vec<u32>, Vec<u32>) = corners.into_iter().partition(|corner| distance(*corner) < 0.0);
        let polygons: Vec<[[u32; 2]; 3]> = match (&ins[..], &outs[..]) {
            (&[lone], &[a, b, c]) | (&[a, b, c], &[lone]) => vec![[[lone, a], [lone, b], [lone, c]]],
            (&[a, b], &[c, d]) => vec![[[a, c], [a, d], [b, d]], [[a, c], [b, d], [b, c]]],
            _ => continue,
        };
        let mean = |corners: &[u32]| {
            corners.iter().map(|corner| way_to(*corner).as_dvec3()).sum::<DVec3>() / corners.len() as f64
        };
        let out = mean(&outs) - mean(&ins);
        for polygon in polygons {
            let [a, b, c] = polygon.map(middle);
            let is_turned = (b - a).cross(c - a).dot(out) < 0.0;
            let [a, b, c] = polygon.map(vertex_on);
            found.push(if is_turned { [a, c, b] } else { [a, b, c] });
        }
    }
    found
}
