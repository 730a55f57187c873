//! The grid of hair against hair.

use glam::{DVec3, Vec3};
use tressfx_core::strands::Strands;

/// A grid of nodes in the space of the head, around all that strands can reach from their roots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeGrid {
    /// The first node, relative to the centre of the groom.
    pub origin: Vec3,
    /// From node to node.
    pub cell: f32,
    /// Nodes along x, y and z, 2 at least.
    pub nodes: [u32; 3],
}

/// A cell is no smaller than this share of the largest coordinate: below that rounding has no places between nodes,
const ROUNDING: f32 = 1e-5;
/// nor than this.
const SMALLEST: f32 = 1e-12;

impl VolumeGrid {
    /// With so many cells along its longest side.
    pub(crate) fn around(strands: &[&Strands], center: Vec3, cells: u32) -> Self {
        let (mut least, mut most) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for strands in strands {
            let vertices = strands.vertices as usize;
            for (rest, lengths) in strands.rest.chunks(vertices).zip(strands.rest_lengths.chunks(vertices)) {
                let (root, length) = (rest[0].truncate() - center, lengths.iter().sum::<f32>());
                (least, most) = (least.min(root - length), most.max(root + length));
            }
        }
        if !(least.is_finite() && most.is_finite()) {
            (least, most) = (Vec3::ZERO, Vec3::ZERO);
        }
        let far = least.abs().max(most.abs()).max_element();
        let cell = ((most - least).max_element() / cells as f32).max(ROUNDING * far).max(SMALLEST);
        // Half a cell around them, so that the furthest is inside in spite of rounding.
        let nodes = ((most - least) / cell).ceil().as_uvec3() + 2;
        let origin = 0.5 * (least + most) - 0.5 * cell * (nodes - 1).as_vec3();
        Self { origin, cell, nodes: nodes.to_array() }
    }

    /// How many nodes it has.
    pub fn node_count(&self) -> u32 {
        self.nodes.iter().product()
    }

    /// The place of a node among all.
    pub fn index(&self, node: [u32; 3]) -> usize {
        ((node[2] * self.nodes[1] + node[1]) * self.nodes[0] + node[0]) as usize
    }

    /// The corners of the cell that a point of the head's space is in, with their trilinear weights; `None` outside of the grid.
    pub fn corners(&self, point: DVec3) -> Option<[(usize, f64); 8]> {
        let scaled = (point - self.origin.as_dvec3()) / f64::from(self.cell);
        let end = DVec3::from(self.nodes.map(|nodes| f64::from(nodes - 1)));
        if !(scaled.cmpge(DVec3::ZERO).all() && scaled.cmplt(end).all()) {
            return None;
        }
        let node = scaled.floor();
        let share = (scaled - node).to_array();
        let first = node.as_uvec3().to_array();
        Some(std::array::from_fn(|corner| {
            let offset: [u32; 3] = std::array::from_fn(|axis| (corner as u32 >> axis) & 1);
            let along = |axis: usize| if offset[axis] == 1 { share[axis] } else { 1.0 - share[axis] };
            (self.index(std::array::from_fn(|axis| first[axis] + offset[axis])), along(0) * along(1) * along(2))
        }))
    }
}
