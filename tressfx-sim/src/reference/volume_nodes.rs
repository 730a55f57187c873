//! `hair.sim.volume_nodes` in f64.

use glam::DVec3;

use super::VolumeSums;
use crate::volume::VolumeGrid;

/// What a node comes to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VolumeNode {
    /// How the pressure grows along x, y and z: central differences, one-sided at the faces of the grid.
    pub slope: DVec3,
    /// The mean velocity.
    pub velocity: DVec3,
}

/// The slope of the pressure, which is `mass / rest mass - 1` where that is more than 0, and the mean velocity of each node. One without mass has neither.
pub fn volume_nodes(grid: &VolumeGrid, sums: &VolumeSums, rest_masses: &[f64]) -> Vec<VolumeNode> {
    let pressure = |node: [u32; 3]| {
        let index = grid.index(node);
        (sums.0[index].w / rest_masses[index] - 1.0).max(0.0)
    };
    let [width, height, _] = grid.nodes;
    let value = |(index, sum): (usize, &glam::DVec4)| {
        if sum.w <= 0.0 {
            return VolumeNode::default();
        }
        let index = index as u32;
        let node = [index % width, index / width % height, index / (width * height)];
        let slope = |axis: usize| {
            let (mut before, mut behind) = (node, node);
            before[axis] = node[axis].saturating_sub(1);
            behind[axis] = (node[axis] + 1).min(grid.nodes[axis] - 1);
            (pressure(behind) - pressure(before)) / (f64::from(grid.cell) * f64::from(behind[axis] - before[axis]))
        };
        VolumeNode { slope: DVec3::new(slope(0), slope(1), slope(2)), velocity: sum.truncate() / sum.w }
    };
    sums.0.iter().enumerate().map(value).collect()
}
