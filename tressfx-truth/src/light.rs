//! Light as it is handed in.

use glam::Vec3;
use tressfx_core::view::Pose;

use crate::error::TruthError;

/// From where a light comes, for the shadows in it. How bright it is, the colours of a [`LitSection`] say.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Light {
    /// Infinitely far.
    Directional {
        /// The direction in the world towards the light, of any length but 0.
        towards: Vec3,
    },
    /// At a point. What is behind it shades nothing.
    Point {
        /// The point in the world.
        position: Vec3,
    },
    /// Nothing shades it.
    Shadowless,
}

/// What a section looks like in light that nothing shades, and how it shades.
#[derive(Clone, Copy, Debug)]
pub struct LitSection<'a> {
    /// For each light, in their order, the colours (linear RGB) in its light alone, a vertex of every strand in the order of
    /// [`Section::colors`](crate::Section::colors).
    pub lights: &'a [Vec<[f32; 3]>],
    /// The colours under a sky that is white all around, in the same order.
    pub sky: &'a [[f32; 3]],
    /// Share of light, 0 to 1, that a strand takes where a ray passes it.
    pub shadow_alpha: f32,
    /// How much of the shadow on this section is seen, 0 to 1: where light arrives with the share `t`, `t` is replaced by
    /// `mix(1, t, self_shadow)`.
    pub self_shadow: f32,
}

/// Triangles that let no light through, seen from either side.
#[derive(Clone, Copy, Debug)]
pub struct OpaqueMesh<'a> {
    /// Vertices.
    pub positions: &'a [Vec3],
    /// Three for each triangle.
    pub indices: &'a [u32],
    /// From the positions to the world.
    pub pose: Pose,
}

/// How much light is taken to come through strands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum ShadowMethod {
    /// What a ray finds: the truth.
    #[default]
    Traced,
    /// By the distance behind the nearest fibre that a light sees, as TressFX 4.1 approximates deep shadows; what is opaque is traced, and strands
    /// do not shade the sky.
    NearestFibre {
        /// Distance from one fibre to the next one behind it, in radii of the thickest fibre; 0.4 in TressFX 4.1.
        spacing: f64,
    },
}

/// All light, and what is in its way beside the strands.
#[derive(Clone, Copy, Debug)]
pub struct Illumination<'a> {
    /// Single lights.
    pub lights: &'a [Light],
    /// Radiance from straight above, the y axis of the world: linear RGB. Towards the ground it changes with `y`:
    /// `mix(ground, sky, 0.5 + 0.5 * y)` for a direction of length 1.
    pub sky: Vec3,
    /// Radiance from straight below.
    pub ground: Vec3,
    /// One for each section of the strands, in their order.
    pub sections: &'a [LitSection<'a>],
    /// What is opaque.
    pub meshes: &'a [OpaqueMesh<'a>],
    /// How much comes through strands.
    pub shadows: ShadowMethod,
}

impl Light {
    fn is_sound(&self) -> bool {
        match self {
            Self::Directional { towards } => towards.is_finite() && *towards != Vec3::ZERO,
            Self::Point { position } => position.is_finite(),
            Self::Shadowless => true,
        }
    }
}

impl Illumination<'_> {
    /// Checks everything but the meshes, for sections of so many vertices.
    pub(crate) fn check(&self, vertices: &[usize]) -> Result<(), TruthError> {
        if let Some(light) = self.lights.iter().position(|light| !light.is_sound()) {
            return Err(TruthError::Light(light));
        }
        let is_radiance = |color: Vec3| color.is_finite() && color.min_element() >= 0.0;
        if !is_radiance(self.sky) || !is_radiance(self.ground) {
            return Err(TruthError::Sky);
        }
        if let ShadowMethod::NearestFibre { spacing } = self.shadows
            && !(spacing > 0.0 && spacing.is_finite())
        {
            return Err(TruthError::Spacing);
        }
        if self.sections.len() != vertices.len() {
            return Err(TruthError::Sections { found: self.sections.len(), expected: vertices.len() });
        }
        let sections = self.sections.iter().zip(vertices).enumerate();
        sections
            .into_iter()
            .try_for_each(|(index, (section, &vertices))| section.check(index, self.lights.len(), vertices))
    }
}

impl LitSection<'_> {
    /// `section` is its place among the others, for messages.
    fn check(&self, section: usize, lights: usize, vertices: usize) -> Result<(), TruthError> {
        let length = |what, found, expected| match found == expected {
            true => Ok(()),
            false => Err(TruthError::Length { section, what, found, expected }),
        };
        length("lights", self.lights.len(), lights)?;
        for colors in self.lights.iter().map(Vec::as_slice).chain([self.sky]) {
            length("colours in a light", colors.len(), vertices)?;
            if let Some(index) = colors.iter().position(|color| !color.iter().all(|x| x.is_finite())) {
                return Err(TruthError::Number { section, what: "colour in a light", index });
            }
        }
        let shares = [("shadow_alpha", self.shadow_alpha), ("self_shadow", self.self_shadow)];
        match shares.into_iter().find(|(_, share)| !(0.0..=1.0).contains(share)) {
            Some((what, _)) => Err(TruthError::Share { section, what }),
            None => Ok(()),
        }
    }
}

impl OpaqueMesh<'_> {
    /// `mesh` is its place among the others, for messages.
    pub(crate) fn check(&self, mesh: usize) -> Result<(), TruthError> {
        let error = |what: String| Err(TruthError::Mesh { mesh, what });
        if !self.indices.len().is_multiple_of(3) {
            return error(format!("{} indices are no whole triangles", self.indices.len()));
        }
        if let Some(index) = self.indices.iter().find(|&&index| index as usize >= self.positions.len()) {
            return error(format!("vertex {index} of {}", self.positions.len()));
        }
        if let Some(vertex) = self.positions.iter().position(|position| !position.is_finite()) {
            return error(format!("vertex {vertex} is not finite"));
        }
        self.pose.validate().or_else(|found| error(found.to_string()))
    }
}
