//! What a section of hair is made of.

use std::ops::RangeInclusive;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::copies::MAX_COPIES;
use crate::fibre::FibreScattering;

/// A highlight of a fibre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Highlight {
    /// How bright it is, 0 to 4.
    pub strength: f32,
    /// How narrow it is: the exponent of a cosine, 1 to 1000.
    pub exponent: f32,
}

/// How the hair of a section looks. Lengths are in metres, colours linear RGB.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Material {
    /// Radius of a fibre. Human hair has 0.00002 to 0.00006; more where one strand stands for many. None fits it to the
    /// groom: see [`StrandInfo::fitting_radius`](crate::StrandInfo::fitting_radius).
    pub fibre_radius: Option<f32>,
    /// Width at the tip as a share of the width at the root.
    pub tip_width: f32,
    /// Strands that are drawn for each one, itself among them, 1 to 32: thicker hair that costs neither simulation nor memory of its own. A radius that is fitted to a
    /// groom is divided by it, down to 60 micrometres.
    pub copies: u32,
    /// How far copies are moved away from their strand at most, along each axis.
    pub copy_spread: f32,
    /// Opacity of a fibre at the root.
    pub opacity: f32,
    /// Opacity of a fibre at the tip.
    pub tip_opacity: f32,
    /// Colour at the root.
    pub base_color: Vec3,
    /// Colour at the tip; from `tip_start` on it changes evenly.
    pub tip_color: Vec3,
    /// Share of a strand's length, from the root, that has the colour of the root.
    pub tip_start: f32,
    /// How much of the colours that strands bring along ([`OwnLook`](crate::OwnLook)) is seen in the place of those of the material.
    pub own_colors: f32,
    /// How much the brightness differs from strand to strand.
    pub variation: f32,
    /// How much the hue differs from strand to strand: redder or bluer.
    pub hue_variation: f32,
    /// Share of light that is scattered in all directions around the fibre (Kajiya and Kay).
    pub diffuse: f32,
    /// Light that the surface mirrors, white, shifted towards the root (Marschner's R).
    pub primary: Highlight,
    /// Light that went through the fibre and back, coloured, shifted towards the tip (Marschner's TRT).
    pub secondary: Highlight,
    /// Tilt of the cuticle's scales in degrees: what shifts the highlights.
    pub tilt: f32,
    /// How much the tilt differs from strand to strand: it breaks the highlights up.
    pub tilt_variation: f32,
    /// How much of the shadow that falls on the hair is seen: 0 lights every strand as if it were alone.
    pub self_shadow: f32,
    /// The share of light that a fibre takes from what is behind it, 0 to 1. Hair scatters most light forwards.
    pub shadow_alpha: f32,
    /// How much darker hair is at its root, where little light gets to.
    pub root_shade: f32,
    /// Share of a strand's length, from the root, over which that darkness fades.
    pub root_extent: f32,
    /// Fibres that scatter light as glass with pigment, in the place of `diffuse`, `primary` and `secondary` (Kajiya and Kay).
    pub fibre: Option<FibreScattering>,
}

impl Default for Material {
    /// Chestnut brown.
    fn default() -> Self {
        Self {
            fibre_radius: None,
            tip_width: 0.15,
            copies: 1,
            copy_spread: 0.001,
            opacity: 0.9,
            tip_opacity: 0.8,
            base_color: Vec3::new(0.105, 0.048, 0.024),
            tip_color: Vec3::new(0.20, 0.10, 0.05),
            tip_start: 0.0,
            own_colors: 1.0,
            variation: 0.35,
            hue_variation: 0.0,
            diffuse: 0.42,
            primary: Highlight { strength: 0.15, exponent: 90.0 },
            secondary: Highlight { strength: 1.6, exponent: 20.0 },
            tilt: 4.0,
            tilt_variation: 0.5,
            self_shadow: 1.0,
            shadow_alpha: 0.3,
            root_shade: 0.35,
            root_extent: 0.2,
            fibre: None,
        }
    }
}

/// A parameter that is out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("material: {parameter} is {value}, it must be from {} to {}", range.start(), range.end())]
pub struct MaterialError {
    /// Its name, as in a file.
    pub parameter: &'static str,
    /// Its value.
    pub value: f32,
    /// Where it may be.
    pub range: RangeInclusive<f32>,
}

impl Material {
    /// The same material but for what `change` sets.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// Checks that every parameter is in its range.
    ///
    /// # Errors
    /// The first that is not, or is NaN.
    pub fn validate(&self) -> Result<(), MaterialError> {
        let color = |color: Vec3| color.to_array().into_iter().find(|c| !(0.0..=1.0).contains(c)).unwrap_or(0.0);
        let checks = [
            ("fibre_radius", self.fibre_radius.unwrap_or(0.01), 1e-6..=0.01),
            ("tip_width", self.tip_width, 0.0..=1.0),
            ("copies", self.copies as f32, 1.0..=MAX_COPIES as f32),
            ("copy_spread", self.copy_spread, 0.0..=0.1),
            ("opacity", self.opacity, 0.0..=1.0),
            ("tip_opacity", self.tip_opacity, 0.0..=1.0),
            ("base_color", color(self.base_color), 0.0..=1.0),
            ("tip_color", color(self.tip_color), 0.0..=1.0),
            ("tip_start", self.tip_start, 0.0..=1.0),
            ("own_colors", self.own_colors, 0.0..=1.0),
            ("variation", self.variation, 0.0..=1.0),
            ("hue_variation", self.hue_variation, 0.0..=1.0),
            ("diffuse", self.diffuse, 0.0..=4.0),
            ("primary.strength", self.primary.strength, 0.0..=4.0),
            ("primary.exponent", self.primary.exponent, 1.0..=1000.0),
            ("secondary.strength", self.secondary.strength, 0.0..=4.0),
            ("secondary.exponent", self.secondary.exponent, 1.0..=1000.0),
            ("tilt", self.tilt, -30.0..=30.0),
            ("tilt_variation", self.tilt_variation, 0.0..=1.0),
            ("self_shadow", self.self_shadow, 0.0..=1.0),
            ("shadow_alpha", self.shadow_alpha, 0.0..=1.0),
            ("root_shade", self.root_shade, 0.0..=1.0),
            ("root_extent", self.root_extent, 0.001..=1.0),
        ];
        let of_fibre = self.fibre.iter().flat_map(FibreScattering::checks);
        match checks.into_iter().chain(of_fibre).find(|(_, value, range)| !range.contains(value)) {
            Some((parameter, value, range)) => Err(MaterialError { parameter, value, range }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_in_range_and_what_is_not_is_named() {
        Material::default().validate().unwrap();
        let error = Material { opacity: 1.5, ..Material::default() }.validate().unwrap_err();
        assert_eq!(error.to_string(), "material: opacity is 1.5, it must be from 0 to 1");
        let error = Material { base_color: Vec3::new(0.1, -0.2, 0.3), ..Material::default() }.validate().unwrap_err();
        assert_eq!((error.parameter, error.value), ("base_color", -0.2));
        assert!(Material { tilt: f32::NAN, ..Material::default() }.validate().is_err());
    }
}
