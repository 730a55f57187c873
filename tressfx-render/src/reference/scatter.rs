//! What `scattering.wgsl` does: the light that a fibre gives of what arrives.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::scattering::{FibreTable, TURNS, lobe};

/// A fibre of hair at a vertex.
pub(super) struct Fibre<'a> {
    pub(super) tangent: DVec3,
    /// Tilt of the scales in radians.
    pub(super) tilt: f64,
    /// For a radius of the fibre.
    pub(super) absorption: DVec3,
    /// Variances of the lobes.
    pub(super) variances: [f64; 4],
    /// How much of what fibres behind it give back is seen.
    pub(super) multiple: f64,
    pub(super) table: &'a FibreTable,
}

/// The light of lobes of a white fibre that is left on paths through it.
fn colored(lobes: [f64; 4], paths: [f64; 3], absorption: DVec3) -> DVec3 {
    let through = |p: usize| lobes[p] * (-absorption * paths[p - 1]).exp();
    lobes[0] + through(1) + through(2) + through(3)
}

/// Sine and cosine of an angle, turned by another.
fn turned([sine, cosine]: [f64; 2], by: f64) -> [f64; 2] {
    [sine * by.cos() + cosine * by.sin(), cosine * by.cos() - sine * by.sin()]
}

/// How much of light comes back from endless layers, each of which passes `on` and mirrors `back`: what a layer more leaves as it is.
fn bulk(on: f64, back: f64) -> f64 {
    let back = back.max(1e-6);
    let sum = 1.0 + back * back - on * on;
    (sum - (sum * sum - 4.0 * back * back).max(0.0).sqrt()) / (2.0 * back)
}

/// What light that meets a fibre has in common for all directions of the eye.
struct Passed {
    /// Share of light that goes on, and what layers behind give back.
    on: DVec3,
    behind: DVec3,
    /// How much of each lobe leaves a white fibre.
    white: [f64; 4],
}

impl Fibre<'_> {
    fn theta(&self, direction: DVec3) -> [f64; 2] {
        let sine = self.tangent.dot(direction).clamp(-1.0, 1.0);
        [sine, (1.0 - sine * sine).max(0.0).sqrt()]
    }

    fn passed(&self, cos_theta: f64) -> Passed {
        let [shares, paths] = self.table.passed(cos_theta);
        let paths = [paths[4], paths[5], paths[6]];
        let on = colored([shares[0], shares[1], shares[2], shares[3]], paths, self.absorption);
        let back = colored([shares[4], shares[5], shares[6], shares[7]], paths, self.absorption);
        let behind = DVec3::from_array([0, 1, 2].map(|c| bulk(on[c], back[c]) - back[c])).max(DVec3::ZERO);
        Passed { on, behind: self.multiple * behind, white: std::array::from_fn(|p| shares[p] + shares[4 + p]) }
    }

    /// Radiance towards `eye` of a fibre in light from `light` that a white matte surface facing it would have a radiance of 1 in, behind so many
    /// fibres.
    pub(super) fn scatter(&self, eye: DVec3, light: DVec3, fibres: f64) -> DVec3 {
        let (i, r) = (self.theta(light), self.theta(eye));
        let cos_phi = ((eye.dot(light) - i[0] * r[0]) / (i[1] * r[1]).max(1e-6)).clamp(-1.0, 1.0);
        let cos_d = (0.5 + 0.5 * (i[0] * r[0] + i[1] * r[1])).clamp(0.0, 1.0).sqrt();
        let (around, passed) = (self.table.around(cos_phi, cos_d), self.passed(i[1]));
        let (direct, spread) = ((-fibres).exp(), fibres * self.variances[1]);
        let (along_i, along_r) = (self.table.along(i[0]), self.table.along(r[0]));
        let mut lobes: [f64; 4] = std::array::from_fn(|p| {
            let even = passed.white[p] / TAU;
            let turn = TURNS[p] * self.tilt;
            let along = lobe(self.variances[p] + spread, turned(i, turn), turned(r, turn));
            (even + direct * (around[p] - even)) * along
        });
        lobes[1] += along_i[0] * along_r[0] / TAU;
        let back = lobe(2.0 * self.variances[1] + self.variances[2] + spread, i, r) * (1.0 + cos_phi) / TAU;
        let single = colored(lobes, [around[4], around[5], around[6]], self.absorption);
        let scale = PI * i[1] / (along_i[7] * along_r[7]).sqrt();
        scale * passed.on.powf(fibres) * (single + back * passed.behind)
    }

    /// Radiance towards `eye` in light of radiance 1 from everywhere, behind so many fibres.
    pub(super) fn under_sky(&self, eye: DVec3, fibres: f64) -> DVec3 {
        let theta = self.theta(eye);
        let [_, b, c, d, through, back, rest, _] = self.table.along(theta[0]);
        let single = colored([1.0 - b - c - d, b, c, d], [through, back, rest], self.absorption);
        let passed = self.passed(theta[1]);
        passed.on.powf(fibres) * (single + passed.behind)
    }
}

/// Fibres that leave so much of light where each takes `alpha`.
pub(super) fn fibres(share: f64, alpha: f64) -> f64 {
    share.min(1.0).ln() / (1.0 - alpha.clamp(1e-4, 0.999)).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fibre::{FibreScattering, Pigment};
    use crate::material::Material;
    use crate::scattering::variances;

    const TILTS: [f32; 3] = [0.0, 4.0, -8.0];

    fn material(roughness: f32, azimuthal_roughness: f32, tilt: f32) -> Material {
        let fibre = FibreScattering { pigment: Pigment::Color, roughness, azimuthal_roughness, multiple: 0.0 };
        Material { fibre: Some(fibre), tilt, ..Material::default() }
    }

    fn fibre<'a>(table: &'a FibreTable, material: &Material, absorption: f64) -> Fibre<'a> {
        Fibre {
            tangent: DVec3::Z,
            tilt: f64::from(material.tilt.to_radians()),
            absorption: DVec3::splat(absorption),
            multiple: 0.0,
            variances: variances(f64::from(material.fibre.unwrap().roughness)),
            table,
        }
    }

    fn direction(theta: f64, phi: f64) -> DVec3 {
        DVec3::new(theta.cos() * phi.cos(), theta.cos() * phi.sin(), theta.sin())
    }

    /// The integral of light of radiance 1 from everywhere, direction by direction.
    fn everywhere(fibre: &Fibre, eye: DVec3) -> f64 {
        const STEPS: [u32; 2] = [240, 160];
        let mut sum = 0.0;
        for (i, j) in (0..STEPS[0]).flat_map(|i| (0..STEPS[1]).map(move |j| (i, j))) {
            let theta = PI * ((f64::from(i) + 0.5) / f64::from(STEPS[0]) - 0.5);
            let phi = TAU * (f64::from(j) + 0.5) / f64::from(STEPS[1]);
            // A light is given by the radiance of a matte surface: its irradiance over PI.
            let light = theta.cos() / PI * PI * TAU / f64::from(STEPS[0] * STEPS[1]);
            sum += light * fibre.scatter(eye, direction(theta, phi), 0.0).x;
        }
        sum
    }

    #[test]
    fn a_white_fibre_in_a_white_furnace_is_white() {
        let mut worst = 0.0f64;
        for roughness in [0.1, 0.3, 0.6, 1.0] {
            for (azimuthal, tilt) in [0.0, 0.3, 1.0].into_iter().zip(TILTS) {
                let material = material(roughness, azimuthal, tilt);
                let table = FibreTable::of(&material).unwrap();
                let fibre = fibre(&table, &material, 0.0);
                for theta in [-1.5, -1.2, -0.7, -0.2, 0.0, 0.4, 1.0, 1.3, 1.5] {
                    let eye = direction(theta, 0.3);
                    worst = worst.max((everywhere(&fibre, eye) - 1.0).abs());
                }
            }
        }
        eprintln!("white furnace: off by at most {worst:.4}");
        assert!(worst < 0.01, "{worst}");
    }

    #[test]
    fn what_a_fibre_gives_under_a_sky_is_the_sum_over_all_directions() {
        let material = material(0.3, 0.3, 4.0);
        let table = FibreTable::of(&material).unwrap();
        for absorption in [0.05, 0.2, 0.5, 1.0, 3.0] {
            let fibre = fibre(&table, &material, absorption);
            for theta in [-1.3, -0.6, 0.0, 0.5, 1.1] {
                let eye = direction(theta, 0.3);
                let (sky, sum) = (fibre.under_sky(eye, 0.0).x, everywhere(&fibre, eye));
                assert!((sky - sum).abs() < 0.02 && sky <= 1.0, "{absorption} {theta}: {sky} {sum}");
            }
        }
    }

    #[test]
    fn light_and_eye_may_change_places() {
        for (roughness, tilt) in [0.1, 0.4, 0.8].into_iter().zip(TILTS) {
            let material = material(roughness, 0.3, tilt);
            let table = FibreTable::of(&material).unwrap();
            let fibre = fibre(&table, &material, 0.3);
            let mut worst = 0.0f64;
            for k in 0..2000u32 {
                let angle = |factor: f64, range: f64| range * ((f64::from(k) * factor).fract() - 0.5);
                let [a, b] =
                    [direction(angle(0.618, PI), angle(0.324, TAU)), direction(angle(0.755, PI), angle(0.569, TAU))];
                // For a unit of the light that falls on the length of a fibre.
                let on = |direction: DVec3| (1.0 - direction.z * direction.z).sqrt();
                let (there, back) = (fibre.scatter(a, b, 0.0).x / on(b), fibre.scatter(b, a, 0.0).x / on(a));
                worst = worst.max((there - back).abs() / there.max(1e-9));
            }
            assert!(worst < 1e-9, "{tilt}: {worst}");
        }
    }

    /// Where light from `theta_i` is mirrored to most, in the plane of light and fibre.
    fn brightest(fibre: &Fibre, theta_i: f64) -> f64 {
        let light = direction(theta_i, 0.0);
        let at = |k: u32| PI * (f64::from(k) / 4000.0 - 0.5);
        let seen = |k: &u32| fibre.scatter(direction(at(*k), 0.0), light, 0.0).x;
        at((1..4000).max_by(|a, b| seen(a).total_cmp(&seen(b))).unwrap())
    }

    /// What keeps white fibres white must not take the tilt away (Marschner et al. 2003: the highlight moves by twice the tilt).
    #[test]
    fn scales_that_tilt_move_the_highlight() {
        let highlights = |tilt: f32| {
            let material = material(0.1, 0.3, tilt);
            let table = FibreTable::of(&material).unwrap();
            // Pigment takes all that goes through.
            let fibre = fibre(&table, &material, 100.0);
            [-0.8, -0.3, 0.0, 0.5, 0.9].map(|theta| brightest(&fibre, theta))
        };
        let straight = highlights(0.0);
        for tilt in [-4.0, 2.0, 4.0f32] {
            let shift = -2.0 * f64::from(tilt.to_radians());
            let shares: Vec<f64> =
                highlights(tilt).iter().zip(straight).map(|(at, before)| (at - before) / shift).collect();
            assert!(shares.iter().all(|share| (share - 1.0).abs() < 0.15), "{tilt}: {shares:?} of {shift}");
        }
    }

    #[test]
    fn any_absorption_and_any_roughness_give_numbers() {
        for (roughness, azimuthal) in [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (f32::NAN, f32::NAN)] {
            let material = material(roughness, azimuthal, 4.0);
            let table = FibreTable::of(&material).unwrap();
            assert!(
                table
                    .packed()
                    .iter()
                    .flatten()
                    .all(|pair| [pair & 0xffff, pair >> 16].iter().all(|half| half & 0x7c00 != 0x7c00))
            );
            let mut last = f64::INFINITY;
            for absorption in [0.0, 0.1, 10.0, 1e6] {
                let fibre = fibre(&table, &material, absorption);
                let all = [-PI / 2.0, -0.3, 0.0, 0.31, PI / 2.0].map(|theta| {
                    [0.0, 1.0, PI]
                        .map(|phi| fibre.scatter(direction(0.3, 0.0), direction(theta, phi), 0.0).x)
                        .iter()
                        .sum::<f64>()
                });
                let sum: f64 = all.iter().sum();
                assert!(sum.is_finite() && sum >= 0.0 && sum <= last, "{roughness} {absorption}: {all:?}");
                last = sum;
            }
        }
    }

    /// Light between layers as a random walk: a step on, a step back, or gone.
    fn walked(on: f64, back: f64, layers: usize) -> [f64; 2] {
        // The share of light that leaves towards either end, followed step by step.
        let mut going = vec![[0.0; 2]; layers];
        going[0][0] = 1.0;
        let (mut returned, mut through) = (0.0, 0.0);
        for _ in 0..4000 {
            let mut next = vec![[0.0; 2]; layers];
            for (layer, [ahead, behind]) in going.into_iter().enumerate() {
                let (forth, back) = (on * ahead + back * behind, back * ahead + on * behind);
                *next.get_mut(layer + 1).map_or(&mut through, |next| &mut next[0]) += forth;
                *if layer > 0 { &mut next[layer - 1][1] } else { &mut returned } += back;
            }
            going = next;
        }
        [returned, through]
    }

    #[test]
    fn layers_give_back_what_a_random_walk_between_them_does() {
        for (on, back) in [(0.5, 0.1), (0.7, 0.2), (0.85, 0.1), (0.05, 0.04), (0.8, 0.15)] {
            let [returned, _] = walked(on, back, 60);
            assert!((bulk(on, back) - returned).abs() < 1e-3, "{on} {back}: {} {returned}", bulk(on, back));
            // A few layers pass more than what goes straight on, since light is mirrored twice.
            let [_, through] = walked(on, back, 5);
            assert!(through >= on.powi(5) && through < on.powi(5) + 0.15, "{on} {back}: {through}");
        }
        assert!((bulk(0.85, 0.15) - 1.0).abs() < 1e-6, "white layers give all back");
        assert_eq!(fibres(0.7f64.powi(3), 0.3).round(), 3.0);
    }
}
