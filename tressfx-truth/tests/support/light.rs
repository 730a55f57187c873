//! Light for hair of which the colours in it are known.

use glam::Vec3;
use tressfx_core::view::{Pose, View};
use tressfx_truth::{Illumination, Light, LitSection, OpaqueMesh, Picture, ShadowMethod, Truth, TruthError};

use super::{Hair, samples};

/// A section with its light, of one colour in each light.
#[derive(Clone, Debug)]
pub(crate) struct LitHair {
    pub(crate) hair: Hair,
    pub(crate) lights: Vec<Vec<[f32; 3]>>,
    pub(crate) sky: Vec<[f32; 3]>,
    pub(crate) shadow_alpha: f32,
    pub(crate) self_shadow: f32,
}

/// What hair is lit by.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lamps {
    pub(crate) lights: Vec<Light>,
    pub(crate) sky: Vec3,
    pub(crate) ground: Vec3,
    pub(crate) triangles: Vec<Vec3>,
    pub(crate) pose: Pose,
    pub(crate) shadows: ShadowMethod,
}

impl LitHair {
    /// Shadows are seen whole.
    pub(crate) fn new(hair: Hair, lights: &[[f32; 3]], sky: [f32; 3], shadow_alpha: f32) -> Self {
        let each = |color: [f32; 3]| vec![color; hair.positions.len()];
        let (lights, sky) = (lights.iter().map(|color| each(*color)).collect(), each(sky));
        Self { hair, lights, sky, shadow_alpha, self_shadow: 1.0 }
    }
}

impl Lamps {
    pub(crate) fn from(light: Light) -> Self {
        Self { lights: vec![light], ..Self::default() }
    }
}

/// Hair in its light, ready to be rendered.
pub(crate) fn lit(view: &View, hair: &[&LitHair], lamps: &Lamps) -> Result<Truth, TruthError> {
    let sections: Vec<_> = hair.iter().map(|lit| lit.hair.section()).collect();
    let lights: Vec<_> = hair
        .iter()
        .map(|LitHair { lights, sky, shadow_alpha, self_shadow, .. }| LitSection {
            lights,
            sky,
            shadow_alpha: *shadow_alpha,
            self_shadow: *self_shadow,
        })
        .collect();
    let indices: Vec<u32> = (0..lamps.triangles.len() as u32).collect();
    let mesh = OpaqueMesh { positions: &lamps.triangles, indices: &indices, pose: lamps.pose };
    let light = Illumination {
        lights: &lamps.lights,
        sky: lamps.sky,
        ground: lamps.ground,
        sections: &lights,
        meshes: &[mesh],
        shadows: lamps.shadows,
    };
    Truth::new(view, &sections, None)?.lit_by(&light)
}

pub(crate) fn render_lit(view: &View, hair: &[&LitHair], lamps: &Lamps, count: u32) -> Picture {
    lit(view, hair, lamps).unwrap().render(samples(count), &|_| ())
}
