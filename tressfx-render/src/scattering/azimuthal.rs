//! The lobes around the fibre, averaged over its width.

use std::f64::consts::{PI, TAU};

use super::dielectric::Crossing;
use super::table::LOBES;

/// Places across the fibre that are looked at.
const PLACES: usize = 160;

/// Smaller widths fall between the entries of the table.
const MIN_WIDTH: f64 = 0.05;

/// Width of the detector of a roughness from 0 to 1: the fit of Chiang et al. 2015.
pub(crate) fn detector_width(roughness: f64) -> f64 {
    // NaN too becomes a number.
    let beta = if roughness > 0.0 { roughness.min(1.0) } else { 0.0 };
    (0.626_657_069 * (0.265 * beta + 1.194 * beta * beta + 5.372 * beta.powi(22))).max(MIN_WIDTH)
}

/// A logistic distribution on the circle: normalised between `-PI` and `PI`.
pub(crate) fn detector(angle: f64, width: f64) -> f64 {
    let angle = angle - TAU * (angle / TAU).round();
    let e = (-angle.abs() / width).exp();
    let within = 2.0 / (1.0 + (-PI / width).exp()) - 1.0;
    e / (width * (1.0 + e).powi(2) * within)
}

/// `N` of each lobe around the fibre at several absorptions.
#[derive(Clone, Debug)]
pub(crate) struct Across {
    /// The crossing, and the share of the width that it stands for.
    crossings: Vec<(Crossing, f64)>,
}

impl Across {
    pub(crate) fn new(cos_theta_d: f64) -> Self {
        // Even in angle, since what is mirrored turns with the angle.
        let crossing = |k: usize| {
            let gamma = PI * ((k as f64 + 0.5) / PLACES as f64 - 0.5);
            (Crossing::new(gamma.sin(), cos_theta_d), 0.5 * gamma.cos() * PI / PLACES as f64)
        };
        let mut crossings: Vec<_> = (0..PLACES).map(crossing).collect();
        let sum: f64 = crossings.iter().map(|(_, weight)| weight).sum();
        crossings.iter_mut().for_each(|(_, weight)| *weight /= sum);
        Self { crossings }
    }

    /// Share of the light that leaves by each lobe.
    pub(crate) fn shares(&self, absorption: f64) -> [f64; LOBES] {
        let mut sums = [0.0; LOBES];
        for (crossing, weight) in &self.crossings {
            sums.iter_mut().zip(crossing.shares(absorption)).for_each(|(sum, share)| *sum += weight * share);
        }
        sums
    }

    /// How much light of each lobe leaves by the angle `phi`, for a unit of angle.
    pub(crate) fn lobes<const N: usize>(&self, phi: f64, width: f64, absorptions: [f64; N]) -> [[f64; LOBES]; N] {
        let mut sums = [[0.0; LOBES]; N];
        for (crossing, weight) in &self.crossings {
            let seen: [f64; 3] = [0, 1, 2].map(|p| weight * detector(phi - crossing.turn(p), width));
            let seen = [seen[0], seen[1], seen[2], weight / TAU];
            for (sums, absorption) in sums.iter_mut().zip(absorptions) {
                let shares = crossing.shares(absorption);
                (0..LOBES).for_each(|p| sums[p] += seen[p] * shares[p]);
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_detector_sees_all() {
        for width in [0.05, 0.3, 1.0, 4.3] {
            let sum: f64 = (0..10_000).map(|k| detector(f64::from(k) * TAU / 1e4 + 7.0, width)).sum();
            assert!((sum * TAU / 1e4 - 1.0).abs() < 1e-6, "{width}: {sum}");
        }
    }
}
