//! `hair.sim.lengths` in f64.

use glam::DVec3;

use super::Guide;
use super::vector::{DOWN, NO_LENGTH, direction_or};
use crate::step::Step;

const REACTION: f64 = 0.9;

/// So many sweeps of the distance constraints, then exact lengths from the root to the tip, for which velocities are corrected.
pub fn lengths(step: &Step, guide: &mut Guide, sweeps: u32) {
    for _ in 0..sweeps {
        sweep(guide);
    }
    let last = guide.vertices() - 1;
    let swept = guide.positions.to_vec();
    pull(guide, (0..=last).collect());
    correct_velocities(guide, &swept, step.smoothing.into());
    if guide.is_pinned(last) {
        for _ in 0..4 {
            pull(guide, (0..=last).rev().collect());
            pull(guide, (0..=last).collect());
        }
    }
}

/// One Gauss-Seidel sweep of the distance constraints from the root to the tip.
fn sweep(guide: &mut Guide) {
    for i in 0..guide.vertices() - 1 {
        let (a, b) = (guide.inverse_mass(i), guide.inverse_mass(i + 1));
        let edge = guide.positions[i + 1] - guide.positions[i];
        if a + b == 0.0 || edge.length_squared() <= NO_LENGTH {
            continue;
        }
        let correction = edge * ((1.0 - f64::from(guide.rest_lengths[i]) / edge.length()) / (a + b));
        guide.positions[i] += a * correction;
        guide.positions[i + 1] -= b * correction;
    }
}

/// Corrects velocities for the placing of the vertices, and moves displacements towards the mean of their neighbours'.
fn correct_velocities(guide: &mut Guide, swept: &[DVec3], smoothing: f64) {
    let vertices = guide.vertices();
    let displacements: Vec<DVec3> = (0..vertices).map(|i| guide.positions[i] - guide.previous[i]).collect();
    let free: Vec<bool> = (0..vertices).map(|i| !guide.is_pinned(i)).collect();
    for i in (0..vertices - 1).filter(|&i| free[i]) {
        let neighbors = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter(|&j| free[j]);
        let zigzag: DVec3 = neighbors.map(|j| displacements[j] - displacements[i]).sum();
        guide.previous[i] += REACTION * (guide.positions[i + 1] - swept[i + 1]) - smoothing * zigzag;
    }
}

/// Places every movable vertex at its rest length from the one before it in `order`.
fn pull(guide: &mut Guide, order: Vec<usize>) {
    let mut direction = DOWN;
    for pair in order.windows(2) {
        let (parent, i) = (guide.positions[pair[0]], pair[1]);
        direction = direction_or(guide.positions[i] - parent, direction);
        if !guide.is_pinned(i) {
            guide.positions[i] = parent + f64::from(guide.rest_lengths[pair[0].min(i)]) * direction;
        }
    }
}
