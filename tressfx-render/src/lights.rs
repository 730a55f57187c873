//! Light on hair and scene.

use glam::Vec3;

/// Lights that a frame can have.
pub const MAX_LIGHTS: usize = 8;

/// Where a light is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightPlace {
    /// Infinitely far.
    Directional {
        /// The direction towards the light, of any length but 0.
        towards: Vec3,
    },
    /// At a point.
    Point {
        /// The point, in the space of the view.
        position: Vec3,
        /// Up to this distance the light has its full colour; beyond it falls with the square of the distance.
        reach: f32,
    },
}

/// One light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it is.
    pub place: LightPlace,
    /// Radiance that a white matte surface facing it would have: linear RGB, not negative.
    pub color: Vec3,
}

impl Light {
    /// A light infinitely far in the direction `towards`.
    pub fn directional(towards: Vec3, color: Vec3) -> Self {
        Self { place: LightPlace::Directional { towards }, color }
    }
}

/// All light of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Lights {
    /// Light from above, linear RGB.
    pub sky: Vec3,
    /// Light from below, linear RGB.
    pub ground: Vec3,
    /// Single lights, at most [`MAX_LIGHTS`].
    pub lights: Vec<Light>,
}

impl Default for Lights {
    /// A portrait studio for a subject that faces +z: a warm key light from the upper right, a cool fill from the left, and a
    /// light from behind that draws the outline.
    fn default() -> Self {
        Self {
            sky: Vec3::new(0.22, 0.24, 0.28),
            ground: Vec3::new(0.09, 0.08, 0.07),
            lights: vec![
                Light::directional(Vec3::new(0.75, 0.8, 0.75), Vec3::new(2.3, 2.1, 1.85)),
                Light::directional(Vec3::new(-0.9, 0.25, 0.6), Vec3::new(0.35, 0.42, 0.55)),
                Light::directional(Vec3::new(-0.45, 0.65, -0.9), Vec3::new(1.1, 1.2, 1.4)),
            ],
        }
    }
}
