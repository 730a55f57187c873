//! `hair.sim.field_seed` in f64.

use super::field::{FieldGrid, Nearest, Triangle, nearest_on};

/// The nearest point of each node of which the nearest triangle is known.
pub fn field_seed(grid: &FieldGrid, triangles: &[Triangle], band: &[Option<u32>]) -> Vec<Nearest> {
    let seed = |(node, index): (usize, &Option<u32>)| {
        index.map(|index| (nearest_on(&triangles[index as usize], grid.node(node).as_dvec3()), index))
    };
    band.iter().enumerate().map(seed).collect()
}
