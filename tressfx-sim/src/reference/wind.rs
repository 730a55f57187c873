//! The wind of a strand: `shaders/wind.wgsl`.

use glam::DVec3;

use super::vector::position;
use crate::step::Step;

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
