//! LDR-FLIP: the difference that a person sees who flips between two pictures on a screen.
//!
//! After P. Andersson, J. Nilsson, T. Akenine-Moeller, M. Oskarsson, K. Astroem and M. D. Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020.

use std::f64::consts::PI;

use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

use crate::channel::Channel;
use crate::color;
use crate::filter::Separable;

/// A screen of 3840 pixels as wide as the viewer is far away (0.7 m): about 67.
pub(crate) const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// A picture as it is perceived.
struct Perceived {
    /// Hunt-adjusted CIELAB without the detail that the eye cannot see.
    colors: Vec<Vec3>,
    /// How strong an edge and how strong a point each pixel is on.
    features: Vec<Vec2>,
}

/// The difference at every pixel, from 0 to 1, row by row. Both pictures have the same size.
pub(crate) fn differences<C: Channel>(a: &[[C; 3]], b: &[[C; 3]], width: usize) -> Vec<f32> {
    let [a, b] = [a, b].map(|rgb| Perceived::new(rgb, width));
    let remap = Remap::new();
    let colors = a.colors.iter().zip(&b.colors).map(|(a, b)| remap.apply(color::hyab(*a, *b)));
    let features = a.features.iter().zip(&b.features).map(|(a, b)| feature_difference(*a, *b));
    colors.zip(features).map(|(color, feature)| color.powf(1.0 - feature)).collect()
}

impl Perceived {
    fn new<C: Channel>(rgb: &[[C; 3]], width: usize) -> Self {
        let light = C::light();
        let linear = |texel: &[C; 3]| Vec3::from_array(texel.map(|level| light[level.into() as usize]));
        let opponents: Vec<Vec4> = rgb.iter().map(|texel| color::opponent(linear(texel))).collect();
        let filtered = Separable::contrast_sensitivity(PIXELS_PER_DEGREE).apply(&opponents, width);
        let colors = filtered.into_iter().map(color::appearance).collect();
        let luminance: Vec<Vec4> = opponents.into_iter().map(|texel| Vec4::splat(color::luminance(texel))).collect();
        let features = Separable::detectors(PIXELS_PER_DEGREE).apply(&luminance, width);
        let features = features.into_iter().map(|found| Vec2::new(found.xy().length(), found.zw().length())).collect();
        Self { colors, features }
    }
}

/// Brings differences of colour into 0 to 1: the small ones, which are most, get most of the range.
struct Remap {
    /// The largest difference of colours that a screen can show, compressed: from green to blue.
    largest: f32,
}

impl Remap {
    const EXPONENT: f32 = 0.7;
    /// This share of the largest difference ...
    const KNEE: f32 = 0.4;
    /// ... gets this share of the range.
    const KNEE_VALUE: f32 = 0.95;

    fn new() -> Self {
        let largest = color::hyab(color::hunt_lab(Vec3::Y), color::hunt_lab(Vec3::Z));
        Self { largest: largest.powf(Self::EXPONENT) }
    }

    fn apply(&self, difference: f32) -> f32 {
        let share = difference.powf(Self::EXPONENT) / self.largest;
        if share < Self::KNEE {
            share * Self::KNEE_VALUE / Self::KNEE
        } else {
            Self::KNEE_VALUE + (share - Self::KNEE) / (1.0 - Self::KNEE) * (1.0 - Self::KNEE_VALUE)
        }
    }
}

/// Of edges or of points, whichever differ more, from 0 to 1.
fn feature_difference(a: Vec2, b: Vec2) -> f32 {
    ((a - b).abs().max_element() * std::f32::consts::FRAC_1_SQRT_2).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remap_keeps_its_ends_its_knee_and_its_order() {
        let remap = Remap::new();
        let uncompressed = |share: f32| (share * remap.largest).powf(1.0 / Remap::EXPONENT);
        for (share, value) in [(0.0, 0.0), (0.4, 0.95), (1.0, 1.0)] {
            assert!((remap.apply(uncompressed(share)) - value).abs() < 1e-5, "{share}");
        }
        let values: Vec<f32> = (0..300).map(|difference| remap.apply(difference as f32)).collect();
        assert!(values.is_sorted());
    }

    #[test]
    fn a_difference_of_one_pixel_stays_near_that_pixel() {
        let even = vec![[128u8; 3]; 64 * 64];
        let mut dotted = even.clone();
        dotted[32 * 64 + 32] = [255; 3];
        let differences = differences(&even, &dotted, 64);
        assert!(differences[32 * 64 + 32] > 0.1);
        assert!(differences[32 * 64 + 53] == 0.0 && differences[0] == 0.0);
    }
}
