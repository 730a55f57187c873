//! Light on hair and scene.

use glam::Vec3;

/// Lights that a frame can have.
pub const MAX_LIGHTS: usize = 8;

/// Where a light is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightPlace {
    /// Infinitely far.
    Directional {
        /// The direction in the world towards the light, of any length but 0.
        towards: Vec3,
    },
    /// At a point.
    Point {
        /// The point in the world.
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

/// All light of a view; none by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lights {
    /// Light from above, linear RGB.
    pub sky: Vec3,
    /// Light from below, linear RGB.
    pub ground: Vec3,
    /// Single lights, at most [`MAX_LIGHTS`].
    pub lights: Vec<Light>,
}
