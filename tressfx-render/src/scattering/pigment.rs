//! What takes light within a fibre. Absorptions are for a radius of the fibre, linear RGB.

use glam::{DVec3, Vec3};

/// Beyond this nothing passes.
pub(crate) const MAX_ABSORPTION: f32 = 1e6;

/// Absorption of one part of eumelanin and of pheomelanin: Donner and Jensen 2006, as d'Eon et al. 2011 have it for a fibre.
const EUMELANIN: Vec3 = Vec3::new(0.419, 0.697, 1.37);
const PHEOMELANIN: Vec3 = Vec3::new(0.187, 0.4, 1.05);

/// Absorption of so much of both pigments.
pub(crate) fn absorption_of_melanin(eumelanin: f32, pheomelanin: f32) -> Vec3 {
    eumelanin * EUMELANIN + pheomelanin * PHEOMELANIN
}

/// How much light in a dense volume of fibres depends on how they spread it: the fit of Chiang et al. 2015.
fn spread(azimuthal_roughness: f32) -> f64 {
    let b = f64::from(azimuthal_roughness.clamp(0.0, 1.0));
    [5.969, -0.215, 2.532, -10.73, 5.574, 0.245].iter().rev().fold(0.0, |sum, term| sum * b + term)
}

/// The absorption with which a dense volume of fibres has a colour, at most [`MAX_ABSORPTION`].
pub(crate) fn absorption_of_color(color: Vec3, azimuthal_roughness: f32) -> Vec3 {
    let root = color.as_dvec3().to_array().map(|c| c.min(1.0).ln() / spread(azimuthal_roughness));
    Vec3::from_array(root.map(|root| (root * root).min(f64::from(MAX_ABSORPTION)) as f32))
}

/// The absorption with which a dense volume of fibres has a colour, divided by the square of the logarithm of the colour.
pub(crate) fn pigmentation(azimuthal_roughness: f32) -> f32 {
    spread(azimuthal_roughness).powi(-2) as f32
}

/// The colour of a dense volume of fibres of an absorption.
pub(crate) fn color_of_absorption(absorption: Vec3, azimuthal_roughness: f32) -> Vec3 {
    let root = DVec3::from_array(absorption.as_dvec3().to_array().map(f64::sqrt));
    (-root * spread(azimuthal_roughness)).exp().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_color_comes_back() {
        for color in [Vec3::new(0.6, 0.3, 0.1), Vec3::new(0.01, 0.02, 0.99), Vec3::ONE] {
            for roughness in [0.0, 0.3, 1.0] {
                let again = color_of_absorption(absorption_of_color(color, roughness), roughness);
                assert!((again - color).abs().max_element() < 1e-6, "{color} {again}");
            }
        }
        let (color, half) = (Vec3::splat(0.5), 0.5f32.ln());
        assert!((absorption_of_color(color, 0.3).x / (pigmentation(0.3) * half * half) - 1.0).abs() < 1e-6);
        assert_eq!(absorption_of_color(Vec3::ZERO, 0.3), Vec3::splat(MAX_ABSORPTION));
        assert_eq!(absorption_of_color(Vec3::ONE, 0.3), Vec3::ZERO);
        assert_eq!(absorption_of_melanin(1.0, 2.0), EUMELANIN + 2.0 * PHEOMELANIN);
    }
}
