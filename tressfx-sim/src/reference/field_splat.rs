//! `hair.sim.field_splat` in f64.

use glam::{DVec3, UVec3};

use super::field::{FieldGrid, Triangle, nearest_on};

/// Cells from the surface.
const BAND: f64 = 1.5;

/// The nearest triangle of each node within 1.5 cells of the surface, by distance and then by index. Triangles are in cells.
pub fn field_splat(grid: &FieldGrid, triangles: &[Triangle]) -> Vec<Option<u32>> {
    let mut band: Vec<Option<(f64, u32)>> = vec![None; grid.count()];
    let end = grid.nodes.as_dvec3() - 1.0;
    for (index, triangle) in triangles.iter().enumerate() {
        if !triangle.iter().all(|corner| corner.is_finite()) {
            continue;
        }
        let [a, b, c] = *triangle;
        let least = (a.min(b).min(c) - BAND).max(DVec3::ZERO).ceil().as_uvec3();
        let last = (a.max(b).max(c) + BAND).min(end).floor().as_uvec3();
        for z in least.z..=last.z {
            for y in least.y..=last.y {
                for x in least.x..=last.x {
                    let node = UVec3::new(x, y, z);
                    let distance = nearest_on(triangle, node.as_dvec3()).distance(node.as_dvec3());
                    let kept = &mut band[grid.index(node)];
                    if distance < BAND && kept.is_none_or(|(known, _)| distance < known) {
                        *kept = Some((distance, index as u32));
                    }
                }
            }
        }
    }
    band.into_iter().map(|kept| kept.map(|(_, index)| index)).collect()
}
