//! Colours as FLIP sees them. XYZ is relative to the white of the screen, so that white is (1, 1, 1).

use glam::{Mat3, Vec3, Vec4, vec3, vec4};

/// Linear BT.709 to CIE XYZ, each row over its sum: what the primaries and the white point D65 (0.3127, 0.3290) give.
const TO_XYZ: Mat3 = Mat3::from_cols_array(&[
    0.433_887_35,
    0.212_639,
    0.017_750_04,
    0.376_224,
    0.715_168_7,
    0.109_447_62,
    0.189_888_65,
    0.072_192_31,
    0.872_802_3,
]);

/// The inverse of `TO_XYZ`.
const FROM_XYZ: Mat3 = Mat3::from_cols_array(&[
    3.080_399,
    -0.921_223_36,
    0.052_873_94,
    -1.537_383_2,
    1.875_967_5,
    -0.203_976_96,
    -0.543_015_9,
    0.045_255_86,
    1.151_103,
]);

/// The light of a level, 0 to 1, by the sRGB transfer function (IEC 61966-2-1).
pub(crate) fn linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// YCxCz of linear light: luminance, red against green, yellow against blue. The last comes twice, for its contrast
/// sensitivity is the sum of two Gaussians.
pub(crate) fn opponent(linear: Vec3) -> Vec4 {
    let Vec3 { x, y, z } = TO_XYZ * linear;
    let yellow_blue = 200.0 * (y - z);
    vec4(116.0 * y - 16.0, 500.0 * (x - y), yellow_blue, yellow_blue)
}

/// The luminance of an opponent colour, from 0 to 1.
pub(crate) fn luminance(opponent: Vec4) -> f32 {
    (opponent.x + 16.0) / 116.0
}

/// What a screen can show of a filtered opponent colour, in Hunt-adjusted CIELAB. The two parts of Cz are summed here.
pub(crate) fn appearance(filtered: Vec4) -> Vec3 {
    let y = luminance(filtered);
    let xyz = vec3(y + filtered.y / 500.0, y, y - (filtered.z + filtered.w) / 200.0);
    hunt_lab((FROM_XYZ * xyz).clamp(Vec3::ZERO, Vec3::ONE))
}

/// CIELAB of linear light, its chroma scaled by lightness: the darker, the less colourful (Hunt effect).
pub(crate) fn hunt_lab(linear: Vec3) -> Vec3 {
    let Vec3 { x, y, z } = (TO_XYZ * linear).map(lab_curve);
    let lightness = 116.0 * y - 16.0;
    let chroma = 0.01 * lightness;
    vec3(lightness, chroma * 500.0 * (x - y), chroma * 200.0 * (y - z))
}

/// The cube root of CIELAB with its straight foot.
fn lab_curve(t: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

/// The distance HyAB: large differences of lightness and of chroma add up rather than hide each other.
pub(crate) fn hyab(a: Vec3, b: Vec3) -> f32 {
    let Vec3 { x: lightness, y, z } = a - b;
    lightness.abs() + y.hypot(z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrices_undo_each_other_and_keep_white() {
        assert!((TO_XYZ * FROM_XYZ).abs_diff_eq(Mat3::IDENTITY, 1e-5));
        assert!((TO_XYZ * Vec3::ONE).abs_diff_eq(Vec3::ONE, 1e-6));
    }

    #[test]
    fn an_unfiltered_color_keeps_its_appearance() {
        let half = vec4(1.0, 1.0, 0.5, 0.5);
        for linear in [Vec3::ZERO, Vec3::ONE, vec3(0.2, 0.7, 0.1), vec3(1.0, 0.0, 0.5)] {
            assert!(appearance(half * opponent(linear)).abs_diff_eq(hunt_lab(linear), 2e-3), "{linear}");
        }
    }

    #[test]
    fn known_colors_have_known_coordinates() {
        assert_eq!((linear(0.0), linear(1.0)), (0.0, 1.0));
        assert!((linear(188.0 / 255.0) - 0.503).abs() < 1e-3);
        assert!(hunt_lab(Vec3::ONE).abs_diff_eq(vec3(100.0, 0.0, 0.0), 1e-3));
        // CIELAB of the green primary is (87.73, -86.18, 83.18); chroma is scaled by 0.8773.
        assert!(hunt_lab(Vec3::Y).abs_diff_eq(vec3(87.73, -75.61, 72.98), 0.1), "{}", hunt_lab(Vec3::Y));
        assert_eq!(hyab(vec3(1.0, 3.0, 0.0), vec3(3.0, 0.0, 4.0)), 7.0);
    }
}
