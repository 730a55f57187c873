//! `hair.sim.volume_push` in f64.

use glam::DVec3;

use super::{VolumeForces, VolumeNode};
use crate::volume::VolumeGrid;

/// Compression spreads by no more than this share of a cell in a sub-step: with a whole cell the strands of a block that is pressed together swing by
/// centimetres a second for ever.
const FARTHEST_SOUND: f64 = 0.5;
/// It pushes no vertex further than this share.
const LONGEST_PUSH: f64 = 0.1;

/// By what a vertex is displaced in a sub-step of `length` seconds by what its velocity changes by. Nothing outside of the grid.
///
/// Friction leaves the sum of mass times velocity as it is: the mean of a node is taken, and given, with the same weights.
pub fn volume_push(
    grid: &VolumeGrid,
    nodes: &[VolumeNode],
    forces: &VolumeForces,
    length: f64,
    place: DVec3,
    velocity: DVec3,
) -> DVec3 {
    let Some(corners) = grid.corners(place) else { return DVec3::ZERO };
    let mean = |of: fn(&VolumeNode) -> DVec3| -> DVec3 {
        corners.iter().map(|&(node, weight)| weight * of(&nodes[node])).sum()
    };
    let cell = f64::from(grid.cell);
    let sound = (forces.sound_speed * length).min(FARTHEST_SOUND * cell);
    let push = -sound * sound * mean(|node| node.slope);
    let share = forces.friction * length / (1.0 + forces.friction * length);
    push.clamp_length_max(LONGEST_PUSH * cell) + share * length * (mean(|node| node.velocity) - velocity)
}
