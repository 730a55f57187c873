//! `hair.sim.field_grid` in f64.

use glam::{DVec3, UVec3};

use super::field::FieldGrid;

/// The grid of so many nodes around a box and 3 cells more. Cells are cubes.
pub fn field_grid(bounds: Option<[DVec3; 2]>, nodes: UVec3) -> FieldGrid {
    let [least, most] = bounds.unwrap_or_default();
    let spaces = nodes.as_dvec3() - 1.0;
    let far = least.abs().max(most.abs()).max_element();
    let cell = ((most - least) / (spaces - 6.0)).max_element().max(1e-5 * far).max(1e-12);
    FieldGrid { origin: 0.5 * (least + most) - 0.5 * cell * spaces, cell, nodes }
}
