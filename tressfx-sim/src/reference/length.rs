//! `hair.sim.length` in f64.

use glam::DVec3;

use super::Guide;
use super::vector::{NO_LENGTH, direction_or, position};
use crate::step::Step;

const DOWN: DVec3 = DVec3::NEG_Y;
const REACTION: f64 = 0.9;

/// Wind, then `sweeps` sweeps of the distance constraints, then exact lengths from the root to the tip, which velocities answer
/// for. Says whether the strand was non-finite and had to be reset. `strand` is the index of the guide: its wind depends on it.
pub fn length(step: &Step, guide: &mut Guide, strand: u32, sweeps: u32) -> bool {
    blow(guide, wind_of(step, strand));
    for _ in 0..sweeps {
        sweep(guide);
    }
    let last = guide.vertices() - 1;
    let swept = guide.positions.to_vec();
    pull(guide, (0..=last).collect());
    answer(guide, &swept);
    if guide.is_pinned(last) {
        for _ in 0..4 {
            pull(guide, (0..=last).rev().collect());
            pull(guide, (0..=last).collect());
        }
    }
    let finite = guide.positions.iter().all(|point| point.is_finite());
    if !finite {
        for i in 0..=last {
            guide.positions[i] = step.in_world(position(guide.rest[i]));
            guide.previous[i] = guide.positions[i];
        }
    }
    !finite
}

/// Each edge is moved by the part of the wind that is across it. All edges are as they were before the wind.
fn blow(guide: &mut Guide, wind: DVec3) {
    let mut direction = DOWN;
    for i in 0..guide.vertices() {
        if let Some(next) = guide.positions.get(i + 1) {
            direction = direction_or(*next - guide.positions[i], direction);
        }
        if !guide.is_pinned(i) {
            guide.positions[i] += wind - wind.dot(direction) * direction;
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

/// Velocities answer for the placing of the vertices, and are drawn to the mean of their neighbours'.
fn answer(guide: &mut Guide, swept: &[DVec3]) {
    let vertices = guide.vertices();
    let smoothing = ((vertices * vertices) as f64 / 1000.0).min(0.25);
    let ways: Vec<DVec3> = (0..vertices).map(|i| guide.positions[i] - guide.previous[i]).collect();
    let free: Vec<bool> = (0..vertices).map(|i| !guide.is_pinned(i)).collect();
    for i in (0..vertices - 1).filter(|&i| free[i]) {
        let neighbours = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter(|&j| free[j]);
        let zigzag: DVec3 = neighbours.map(|j| ways[j] - ways[i]).sum();
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

/// The mix of the wind's four corners that is the strand's own.
fn wind_of(step: &Step, strand: u32) -> DVec3 {
    let bits = scrambled(strand);
    let (x, y) = (f64::from(bits & 0xffff) / 65535.0, f64::from(bits >> 16) / 65535.0);
    let [a, b, c, d] = step.wind.map(position);
    (a * (1.0 - x) + b * x) * (1.0 - y) + (c * (1.0 - x) + d * x) * y
}

fn scrambled(value: u32) -> u32 {
    let x = (value ^ (value >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}
