//! `hair.sim.moved` in f64.

use glam::DVec3;

/// How far a strand has moved since it was measured before: the largest distance of a vertex, as a share of the length of the strand.
pub fn moved(positions: &[DVec3], measured: &[DVec3], rest_lengths: &[f32]) -> f64 {
    let farthest = positions.iter().zip(measured).map(|(here, there)| here.distance(*there)).fold(0.0, f64::max);
    farthest / rest_lengths.iter().map(|&length| f64::from(length)).sum::<f64>().max(1e-20)
}
