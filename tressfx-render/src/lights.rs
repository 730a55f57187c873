//! Light on hair and scene.

use glam::Vec3;
use tressfx_core::id::TextureId;
use tressfx_core::view::View;

/// Lights that a frame can have.
pub const MAX_LIGHTS: usize = 16;

/// Of so many lights, the first ones, it is stored at each vertex how much arrives. Shadows in the light of others are taken from what arrives from
/// everywhere, in their direction, when a vertex is shaded: they cost no memory and no pass.
pub const STORED_LIGHTS: usize = 8;

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
        /// Up to this distance the light has its full colour; beyond it falls with the square of the distance. With a reach of a metre, the
        /// colour of a light of `I` candela is `I / pi`, in candela a square metre.
        reach: f32,
        /// What it shines into; none for all directions.
        cone: Option<Cone>,
    },
}

/// What a spot light shines into. Between both angles light fades as glTF's `KHR_lights_punctual` proposes: with the square of what is
/// linear in the cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The direction in the world in which the light shines, of any length but 0.
    pub along: Vec3,
    /// Radians from it up to which light is full.
    pub inner: f32,
    /// Radians from which on there is none: more than `inner`, at most pi.
    pub outer: f32,
}

impl Cone {
    /// Whether a light can have it.
    pub(crate) fn is_valid(&self) -> bool {
        let Self { along, inner, outer } = *self;
        along.is_finite() && along != Vec3::ZERO && inner >= 0.0 && inner < outer && outer <= std::f32::consts::PI
    }

    /// A vector whose product with the unit direction towards the light, and a number that added to that is the root of the share of the
    /// light, before it is cut to between 0 and 1.
    pub(crate) fn ramp(&self) -> (Vec3, f32) {
        // A ramp that is no steeper than glTF allows.
        let scale = 1.0 / (self.inner.cos() - self.outer.cos()).max(0.001);
        (-self.along.normalize_or_zero() * scale, -self.outer.cos() * scale)
    }
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
    /// What casts its shadow on hair beside hair, for one of the first [`STORED_LIGHTS`]. Where nothing is known, light does not pass behind the roots of strands.
    pub opaque: Option<OpaqueDepth>,
}

impl Light {
    /// A light infinitely far in the direction `towards`, with shadows.
    pub fn directional(towards: Vec3, color: Vec3) -> Self {
        Self { place: LightPlace::Directional { towards }, color, casts: true, opaque: None }
    }

    /// A light at a point, with shadows; it has its full colour up to the distance `reach`.
    pub fn point(position: Vec3, reach: f32, color: Vec3) -> Self {
        Self { place: LightPlace::Point { position, reach, cone: None }, color, casts: true, opaque: None }
    }

    /// A light at a point that shines into a cone, with shadows; it has its full colour up to the distance `reach`.
    pub fn spot(position: Vec3, reach: f32, cone: Cone, color: Vec3) -> Self {
        Self { place: LightPlace::Point { position, reach, cone: Some(cone) }, ..Self::point(position, reach, color) }
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
    /// Single lights, at most [`MAX_LIGHTS`]. Those whose shadows matter most come first.
    pub lights: Vec<Light>,
}

impl Lights {
    /// A bit for each light that casts shadows.
    pub(crate) fn casting(&self) -> u32 {
        let lights = self.lights.iter().take(MAX_LIGHTS).enumerate();
        lights.fold(0, |bits, (index, light)| bits | u32::from(light.casts) << index)
    }
}
