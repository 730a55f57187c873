//! `hair.sim.wind` in f64.

use glam::DVec3;

use super::Guide;
use super::vector::{DOWN, direction_or, position};
use crate::step::Step;

/// Each vertex is moved by the part of the wind that is across its edge. All edges are as they were before the wind. `strand` is
/// the index of the guide: its wind depends on it.
pub fn wind(step: &Step, guide: &mut Guide, strand: u32) {
    let wind = wind_of(step, strand);
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

/// The mix of the wind's four corners that is the strand's own.
pub(super) fn wind_of(step: &Step, strand: u32) -> DVec3 {
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
