//! `hair.sim.field_sign` in f64.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::field::{FieldGrid, Nearest};
use super::field_crossings::{is_left, part_of, parts, twice_area};

/// The signed distance of each node: negative where the generalised winding number (Jacobson et al. 2013) is more than a half. It is the sum of crossings
/// along z, and of the solid angles between -z and each open edge: from vertex to vertex, so many times.
pub fn field_sign(
    grid: &FieldGrid,
    positions: &[Vec3],
    known: &[Nearest],
    crossings: &[i32],
    open_edges: &[[i32; 3]],
) -> Vec<f64> {
    let parts = parts(grid);
    let corner = |vertex: i32| (positions[vertex as usize].as_dvec3() - grid.origin) / grid.cell;
    let edges: Vec<_> =
        open_edges.iter().map(|&[from, to, times]| (corner(from), corner(to), f64::from(times))).collect();
    let signed = |(index, nearest): (usize, &Nearest)| {
        let node = grid.node(index);
        let behind = (node.z..grid.nodes.z).map(|z| crossings[grid.index(node.with_z(z))]);
        let mut winding = f64::from(behind.sum::<i32>());
        for &(from, to, times) in &edges {
            winding += times * turn_of(from, to, node.as_dvec3(), parts);
        }
        let distance = nearest.map_or(1e10, |(point, _)| grid.cell * point.distance(node.as_dvec3()));
        if winding > 0.5 { -distance } else { distance }
    };
    known.iter().enumerate().map(signed).collect()
}

/// The solid angle of the triangle of an edge and -z, in whole spheres (Van Oosterom, Strackee 1983).
fn turn_of(from: DVec3, to: DVec3, point: DVec3, parts: i32) -> f64 {
    let line = part_of(point, parts);
    let [a, b] = [from, to].map(|end| part_of(end, parts)).map(|place| [place[0] - line[0], place[1] - line[1]]);
    let scale = f64::from(parts).recip();
    let place =
        |parts: [i64; 2], end: DVec3| DVec3::new(parts[0] as f64 * scale, parts[1] as f64 * scale, end.z - point.z);
    let size = (twice_area(a, b).abs() as f64 * scale * scale).max(1e-12);
    let volume = if is_left(a, b) { -size } else { size };
    let (a, b) = (place(a, from), place(b, to));
    let under = a.length() * b.length() + a.dot(b) - a.length() * b.z - b.length() * a.z;
    volume.atan2(under) / TAU
}
