//! `hair.render.shadow_sum`.

use super::shadow::ShadowCells;

/// The optical depth of skin.
const SKIN_DEPTH: f64 = 16.0;

/// What is taken up to the end of each cell, along the way of a light.
pub fn shadow_sum(counted: &ShadowCells) -> Vec<f64> {
    let row = (counted.grid.size[0] * counted.grid.size[1]) as usize;
    let mut sums: Vec<f64> =
        counted.cells.iter().map(|cell| cell.depth + if cell.is_skin { SKIN_DEPTH } else { 0.0 }).collect();
    (row..sums.len()).for_each(|cell| sums[cell] += sums[cell - row]);
    sums
}
