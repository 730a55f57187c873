//! Light on hair and scene.

use glam::Vec3;
use tressfx_core::id::TextureId;
use tressfx_core::view::View;

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

/// The depth of the opaque scene as a light sees it: an engine's shadow map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpaqueDepth {
    /// [`Format::Depth32F`](tressfx_core::backend::Format::Depth32F), in the order of depth of the view.
    pub depth: TextureId,
    /// From the light.
    pub view: View,
    /// How much farther than the scene hair may be and still be lit, in the unit of the world.
    pub bias: f32,
}

/// One light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it is.
    pub place: LightPlace,
    /// Radiance that a white matte surface facing it would have: linear RGB, not negative.
    pub color: Vec3,
    /// Whether hair casts its shadow on hair in this light, where the renderer makes shadows.
    pub casts: bool,
    /// What casts its shadow on hair beside hair. Where nothing is known, light does not pass behind the roots of strands.
    pub opaque: Option<OpaqueDepth>,
}

impl Light {
    /// A light infinitely far in the direction `towards`, with shadows.
    pub fn directional(towards: Vec3, color: Vec3) -> Self {
        Self { place: LightPlace::Directional { towards }, color, casts: true, opaque: None }
    }

    /// A light at a point, with shadows; it has its full colour up to the distance `reach`.
    pub fn point(position: Vec3, reach: f32, color: Vec3) -> Self {
        Self { place: LightPlace::Point { position, reach }, color, casts: true, opaque: None }
    }

    /// The same with shadows of an opaque scene.
    #[must_use]
    pub fn opaque(self, opaque: OpaqueDepth) -> Self {
        Self { opaque: Some(opaque), ..self }
    }

    /// The same, with or without shadows.
    #[must_use]
    pub fn casts(self, casts: bool) -> Self {
        Self { casts, ..self }
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
