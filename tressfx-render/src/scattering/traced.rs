//! The lobes around a fibre against rays that are traced through a cylinder, as vectors in space.

use glam::DVec3;

use super::FibreTable;
use super::azimuthal::{Across, detector, detector_width};
use super::dielectric::ETA;
use super::table::{LOBES, Shape};

/// Light that leaves: its lobe, its angle around the fibre, and how much it is.
type Exit = (usize, f64, f64);

/// Directions inside or outside and the share that is mirrored, for light that goes along `ray` and meets a surface with the normal `normal`
/// on its side; the index changes by `ratio`.
fn meet(ray: DVec3, normal: DVec3, ratio: f64) -> (DVec3, DVec3, f64) {
    let mirrored = ray - 2.0 * ray.dot(normal) * normal;
    // What is across the normal shrinks by the ratio (Snell), and the length stays 1.
    let across = (ray - ray.dot(normal) * normal) / ratio;
    let broken = across - (1.0 - across.length_squared()).max(0.0).sqrt() * normal;
    let (cos_i, cos_t) = (-ray.dot(normal), -broken.dot(normal));
    // Amplitudes of both polarisations for indices 1 and `ratio`.
    let s = (cos_i - ratio * cos_t) / (cos_i + ratio * cos_t);
    let p = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t);
    (mirrored, broken, 0.5 * (s * s + p * p))
}

/// All light of a ray from the angle 0 that leans by `theta`, at `h` from the middle.
fn trace(h: f64, theta: f64, absorption: f64, leave: &mut impl FnMut(Exit)) {
    let ray = -DVec3::new(theta.cos(), 0.0, theta.sin());
    let mut point = DVec3::new((1.0 - h * h).sqrt(), h, 0.0);
    let (mirrored, mut inside, share) = meet(ray, point, ETA);
    leave((0, mirrored.y.atan2(mirrored.x), share));
    let mut left = 1.0 - share;
    for bounce in 1..40 {
        // To the other side of the cylinder.
        let flat = inside.truncate();
        let distance = -2.0 * point.truncate().dot(flat) / flat.length_squared();
        point += distance * inside;
        left *= (-absorption * distance).exp();
        let normal = DVec3::new(-point.x, -point.y, 0.0);
        let (mirrored, outside, share) = meet(inside, normal, 1.0 / ETA);
        assert!((outside.z - ray.z).abs() < 1e-9, "it leaves on the cone on which it came");
        leave((bounce.min(LOBES - 1), outside.y.atan2(outside.x), left * (1.0 - share)));
        left *= share;
        inside = mirrored;
    }
}

fn exits(theta: f64, absorption: f64) -> Vec<Exit> {
    const RAYS: u32 = 4000;
    let mut exits = Vec::new();
    for k in 0..RAYS {
        let h = 2.0 * (f64::from(k) + 0.5) / f64::from(RAYS) - 1.0;
        trace(h, theta, absorption, &mut |(p, phi, share)| exits.push((p, phi, share / f64::from(RAYS))));
    }
    exits
}

#[test]
fn each_lobe_has_the_light_of_traced_rays() {
    for (theta, absorption) in [(0.0, 0.0), (0.3, 0.2), (0.8, 1.0), (1.2, 0.5), (1.45, 0.1)] {
        let exits = exits(theta, absorption);
        let across = Across::new(f64::cos(theta));
        for (p, share) in across.shares(absorption).into_iter().enumerate() {
            let traced: f64 = exits.iter().filter(|exit| exit.0 == p).map(|exit| exit.2).sum();
            assert!((share - traced).abs() < 1e-3, "{p} at {theta}: {share} {traced}");
        }
        for width in [0.2, 0.5, 1.0].map(detector_width) {
            for phi in (0..12).map(|k| 0.3 * f64::from(k)) {
                let [lobes] = across.lobes(phi, width, [absorption]);
                for (p, lobe) in lobes.into_iter().enumerate().take(LOBES - 1) {
                    let seen = exits.iter().filter(|exit| exit.0 == p);
                    let traced: f64 = seen.map(|&(_, at, share)| share * detector(phi - at, width)).sum();
                    assert!((lobe - traced).abs() < 2e-3, "{p} at {theta}, {phi}: {lobe} {traced}");
                }
            }
        }
    }
}

#[test]
fn the_table_is_near_the_integral_at_any_absorption() {
    let mut worst = [0.0f64; 4];
    for azimuthal_roughness in [0.2f32, 0.3, 0.6, 1.0] {
        let table = FibreTable::new(&Shape { roughness: 0.3, azimuthal_roughness, tilt: 0.05 });
        let width = detector_width(f64::from(azimuthal_roughness));
        for cos_d in [0.35, 0.62, 0.81, 0.97] {
            let across = Across::new(cos_d);
            for phi in (0..20).map(|k| 0.02 + 0.16 * f64::from(k)) {
                let entry = table.around(phi.cos(), cos_d);
                for (k, absorption) in [0.0, 0.1, 0.5, 2.0].into_iter().enumerate() {
                    let [lobes] = across.lobes(phi, width, [absorption]);
                    let through = |p: usize| entry[p] * (-absorption * entry[3 + p]).exp();
                    let found = entry[0] + through(1) + through(2) + through(3);
                    worst[k] = worst[k].max((found - lobes.iter().sum::<f64>()).abs());
                }
            }
        }
    }
    eprintln!("absorption 0, 0.1, 0.5 and 2: largest error {worst:.4?} for a unit of angle");
    // Light that leaves evenly by all angles is 0.16 for a unit of angle.
    assert!(worst.into_iter().all(|worst| worst < 0.02), "{worst:?}");
}
