//! Wind: four directions in a cone, mixed differently for every strand, in gusts.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use crate::error::SimError;
use crate::params::within;

/// A wind. It pushes each edge with the part that is across it; how strongly is [`SimParams::wind_drag`].
///
/// After the porting guide of TressFX: strands get different directions, so that the hair keeps its volume, and the strength
/// swings as a squared sine, so that it waves. Its four directions stand evenly around the mean one, each strand mixes them
/// with weights of its own that sum to 1, and the swing follows simulated time.
///
/// [`SimParams::wind_drag`]: crate::SimParams::wind_drag
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Wind {
    /// Along the axis of the cone, in world space, and as long as the mean speed, m/s.
    pub velocity: Vec3,
    /// Half angle of the cone of directions, radians, from 0 to pi/2.
    pub half_angle: f32,
    /// Seconds from gust to gust.
    pub gust_period: f32,
}

impl Default for Wind {
    /// No wind; a half angle of 40 degrees, a gust every 2 s.
    fn default() -> Self {
        Self { velocity: Vec3::ZERO, half_angle: 40f32.to_radians(), gust_period: 2.0 }
    }
}

impl Wind {
    /// A wind with the default cone and gusts; `velocity` in m/s.
    pub fn new(velocity: Vec3) -> Self {
        Self { velocity, ..Self::default() }
    }

    /// Checks it.
    ///
    /// # Errors
    /// What is not finite or out of range.
    pub fn validate(&self) -> Result<(), SimError> {
        if !self.velocity.is_finite() {
            return Err(SimError::NonFinite { name: "wind.velocity" });
        }
        within("wind.half_angle", self.half_angle, 0.0..=FRAC_PI_2)?;
        Ok(within("wind.gust_period", self.gust_period, 0.001..=1e6)?)
    }

    /// The velocities at the corners of the cone at a simulated time, m/s, in the order in which the kernel mixes them:
    /// opposite corners are 0 and 3, 1 and 2.
    pub fn corners(&self, seconds: f64) -> [Vec3; 4] {
        let swing = (std::f64::consts::PI * seconds / f64::from(self.gust_period)).sin();
        let strength = self.velocity.length() * (0.5 + swing * swing) as f32;
        // From two vectors, so that every direction is reached, -x too.
        let turn = Quat::from_rotation_arc(Vec3::X, self.velocity.normalize_or(Vec3::X));
        let (sin, cos) = self.half_angle.sin_cos();
        [0.0, 0.5, 1.5, 1.0].map(|around: f32| {
            let (across, up) = (around * PI).sin_cos();
            strength * (turn * Vec3::new(cos, sin * up, sin * across))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_are_on_a_cone_around_every_direction() {
        for direction in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Z, Vec3::new(-1.0, 2.0, 0.5).normalize()] {
            let wind = Wind::new(direction * 3.0);
            let corners = wind.corners(0.3);
            let strength = corners[0].length();
            for corner in corners {
                assert!((corner.length() - strength).abs() < 1e-5);
                assert!((corner.normalize().dot(direction) - wind.half_angle.cos()).abs() < 1e-5);
            }
            let mean = corners.into_iter().sum::<Vec3>() / 4.0;
            assert!(mean.normalize().dot(direction) > 0.99999, "{direction} -> {mean}");
            assert!(((corners[0] + corners[3]).normalize() - direction).length() < 1e-4, "opposite corners");
        }
    }

    #[test]
    fn the_strength_swings_with_time_around_its_mean() {
        let wind = Wind { half_angle: 0.0, ..Wind::new(Vec3::X * 2.0) };
        let samples = 1000;
        let speeds = (0..samples).map(|i| wind.corners(f64::from(i) * 2.0 / f64::from(samples))[0].length());
        assert!((speeds.sum::<f32>() / samples as f32 - 2.0).abs() < 1e-3);
        assert!((wind.corners(0.0)[0].length() - 1.0).abs() < 1e-6);
        assert!((wind.corners(1.0)[0].length() - 3.0).abs() < 1e-6);
    }

    #[test]
    fn nonsense_is_refused_by_name() {
        assert!(Wind::new(Vec3::NAN).validate().unwrap_err().to_string().contains("wind.velocity"));
        let error = Wind { gust_period: 0.0, ..Wind::default() }.validate().unwrap_err();
        assert!(error.to_string().contains("wind.gust_period = 0 must be from 0.001"), "{error}");
    }
}
