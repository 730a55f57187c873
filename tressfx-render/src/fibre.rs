//! Fibres that scatter light as glass with pigment.

use std::ops::RangeInclusive;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::material::Material;
use crate::scattering::{
    MAX_ABSORPTION, Shape, absorption_of_color, absorption_of_melanin, color_of_absorption, pigmentation,
};

/// What takes light within a fibre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Pigment {
    /// So much that hair in bulk has [`Material::base_color`] and [`Material::tip_color`] (Chiang et al. 2015): dyed hair, and colours that are asked for.
    Color,
    /// The pigments of hair, in parts of 0 to 100, with the absorptions of Donner and Jensen 2006; root and tip are alike.
    Melanin {
        /// Brown to black.
        eumelanin: f32,
        /// Yellow to red.
        pheomelanin: f32,
    },
    /// Absorption in a radius of the fibre, linear RGB, 0 to 1,000,000; root and tip are alike.
    Absorption(Vec3),
}

/// A fibre as a dielectric cylinder with tilted scales and pigment (Marschner et al. 2003, d'Eon et al. 2011, Chiang et al. 2015).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct FibreScattering {
    /// What takes light within.
    pub pigment: Pigment,
    /// How wide highlights are along the fibre, 0 to 1; below 0.05 it is as at 0.05.
    pub roughness: f32,
    /// How wide they are around it, 0 to 1; below 0.18 it is as at 0.18.
    pub azimuthal_roughness: f32,
    /// How much is seen of the light that fibres behind a fibre give back, 0 to 1: 0 is a fibre that is alone, 1 endless hair.
    pub multiple: f32,
}

impl Default for FibreScattering {
    /// Human hair, with the colours of its material.
    fn default() -> Self {
        Self { pigment: Pigment::Color, roughness: 0.3, azimuthal_roughness: 0.3, multiple: 0.7 }
    }
}

impl FibreScattering {
    /// The same with another pigment.
    #[must_use]
    pub fn with_pigment(self, pigment: Pigment) -> Self {
        Self { pigment, ..self }
    }

    /// Names, values and ranges.
    pub(crate) fn checks(&self) -> [(&'static str, f32, RangeInclusive<f32>); 6] {
        let (eumelanin, pheomelanin, absorption) = match self.pigment {
            Pigment::Color => (0.0, 0.0, Vec3::ZERO),
            Pigment::Melanin { eumelanin, pheomelanin } => (eumelanin, pheomelanin, Vec3::ZERO),
            Pigment::Absorption(absorption) => (0.0, 0.0, absorption),
        };
        let absorption = absorption.to_array().into_iter().find(|a| !(0.0..=MAX_ABSORPTION).contains(a)).unwrap_or(0.0);
        [
            ("fibre.pigment.melanin.eumelanin", eumelanin, 0.0..=100.0),
            ("fibre.pigment.melanin.pheomelanin", pheomelanin, 0.0..=100.0),
            ("fibre.pigment.absorption", absorption, 0.0..=MAX_ABSORPTION),
            ("fibre.roughness", self.roughness, 0.0..=1.0),
            ("fibre.azimuthal_roughness", self.azimuthal_roughness, 0.0..=1.0),
            ("fibre.multiple", self.multiple, 0.0..=1.0),
        ]
    }
}

impl Pigment {
    /// Absorption in a radius of the fibre, the same from root to tip; none where it follows the colours of the material.
    fn absorption(self) -> Option<Vec3> {
        match self {
            Self::Color => None,
            Self::Melanin { eumelanin, pheomelanin } => Some(absorption_of_melanin(eumelanin, pheomelanin)),
            Self::Absorption(absorption) => Some(absorption),
        }
    }
}

impl Material {
    /// The colours at root and tip of hair in bulk, linear RGB: those of the material, or what its pigment gives.
    pub fn colors(&self) -> [Vec3; 2] {
        let of = |fibre: FibreScattering| {
            Some([color_of_absorption(fibre.pigment.absorption()?, fibre.azimuthal_roughness); 2])
        };
        self.fibre.and_then(of).unwrap_or([self.base_color, self.tip_color])
    }

    /// Absorption at root and tip in a radius of the fibre; 0 where fibres do not scatter as glass.
    pub(crate) fn absorptions(&self) -> [Vec3; 2] {
        let Some(fibre) = self.fibre else { return [Vec3::ZERO; 2] };
        let of_color = |color| absorption_of_color(color, fibre.azimuthal_roughness);
        fibre.pigment.absorption().map_or([self.base_color, self.tip_color].map(of_color), |absorption| [absorption; 2])
    }

    /// Absorption in a radius of the fibre, as a multiple of the square of the logarithm of the colour that hair in bulk should have; 0 where fibres do not scatter
    /// as glass.
    pub(crate) fn pigmentation(&self) -> f32 {
        self.fibre.map_or(0.0, |fibre| pigmentation(fibre.azimuthal_roughness))
    }

    /// What the table of the fibre depends on; none where fibres do not scatter as glass.
    pub(crate) fn fibre_shape(&self) -> Option<Shape> {
        let FibreScattering { roughness, azimuthal_roughness, .. } = self.fibre?;
        Some(Shape { roughness, azimuthal_roughness, tilt: self.tilt.to_radians() })
    }
}
