//! How the head moves: `--motion`.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use tressfx_core::strands::Bounds;
use tressfx_core::view::Pose;

use crate::cli::Motion;

/// Seconds in which a motion reaches its full size, so that it does not begin with a jerk.
const EASE: f64 = 0.5;

/// The head of a groom with these bounds after `seconds`.
///
/// It turns about the middle of the groom; distances go with its radius.
pub(crate) fn head(motion: Motion, seconds: f64, bounds: &Bounds) -> Pose {
    let ease = ease(seconds);
    let wave = |hertz: f64| (std::f64::consts::TAU * (hertz * seconds).fract()).sin() as f32;
    let radius = bounds.radius();
    let (rotation, shift) = match motion {
        Motion::Still => return Pose::IDENTITY,
        Motion::Shake => {
            (Quat::from_rotation_y(0.45 * ease * wave(1.5)), Vec3::new(0.08 * radius * ease * wave(1.5), 0.0, 0.0))
        }
        Motion::Turn => (Quat::from_rotation_y(0.25 * TAU * ease * wave(0.4)), Vec3::ZERO),
        Motion::Walk => {
            let step = Vec3::new(0.06 * wave(1.0), 0.05 * wave(2.0), 0.04 * wave(2.0));
            (Quat::from_rotation_z(0.05 * ease * wave(1.0)), step * radius * ease)
        }
    };
    let center = bounds.center();
    Pose { rotation, translation: center - rotation * center + shift }
}

/// From 0 to 1 over [`EASE`] seconds, level at both ends.
fn ease(seconds: f64) -> f32 {
    let t = (seconds / EASE).clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 2.0, 1.0) };

    #[test]
    fn every_motion_begins_at_rest_and_stays_near() {
        for motion in [Motion::Still, Motion::Shake, Motion::Turn, Motion::Walk] {
            assert_eq!(head(motion, 0.0, &BOUNDS).transform(Vec3::ZERO), Vec3::ZERO, "{motion:?}");
            let first = head(motion, 1.0 / 144.0, &BOUNDS).transform(Vec3::Z);
            assert!(first.distance(Vec3::Z) < 1e-3, "{motion:?} begins with a jerk");
            for frame in 0..10_000 {
                let pose = head(motion, f64::from(frame) / 60.0, &BOUNDS);
                assert!(pose.transform(BOUNDS.center()).distance(BOUNDS.center()) < 0.2, "{motion:?}");
                assert!((pose.rotation.length() - 1.0).abs() < 1e-5, "{motion:?}");
            }
        }
    }
}
