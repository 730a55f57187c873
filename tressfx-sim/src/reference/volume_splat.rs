//! `hair.sim.volume_splat` in f64.

use glam::{DVec3, DVec4};
use tressfx_core::strands::Strands;

use super::volume::vertex_masses;
use crate::volume::VolumeGrid;

/// Of each node the momentum, and as the last number the mass.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeSums(pub Vec<DVec4>);

impl VolumeSums {
    /// Nothing at any node.
    pub fn new(grid: &VolumeGrid) -> Self {
        Self(vec![DVec4::ZERO; grid.node_count() as usize])
    }

    /// The mass of all guides.
    pub fn whole_mass(strands: &Strands) -> f64 {
        vertex_masses(strands).iter().sum()
    }
}

/// Spreads a vertex over the nodes around it. One that is outside of the grid counts nothing.
pub fn volume_splat(grid: &VolumeGrid, sums: &mut VolumeSums, place: DVec3, mass: f64, velocity: DVec3) {
    for (node, weight) in grid.corners(place).into_iter().flatten() {
        sums.0[node] += weight * mass * velocity.extend(1.0);
    }
}
