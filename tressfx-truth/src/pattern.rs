//! Where in a pixel its rays go through.

use glam::{DVec2, DVec3, UVec2};

/// The root of x^3 = x + 1, which Roberts' two-dimensional sequence is made from.
const PLASTIC: f64 = 1.324_717_957_244_746;

/// The root of x^4 = x + 1, which the three-dimensional one is made from.
const FOURTH: f64 = 1.220_744_084_605_759_6;

/// The first `count` sample points of a pixel, in pixels from the upper left corner of the picture: an R2 sequence, shifted
/// by a hash of the pixel. They are the same in every run, and the first of more points are the same as fewer.
pub fn sample_points(pixel: [u32; 2], count: u32) -> impl Iterator<Item = DVec2> {
    points(pixel, 0..count)
}

/// Points of which the numbers are in a range.
pub(crate) fn points(pixel: [u32; 2], numbers: std::ops::Range<u32>) -> impl Iterator<Item = DVec2> {
    let step = DVec2::new(1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC));
    let corner = UVec2::from_array(pixel).as_dvec2();
    let shift = shift(pixel);
    numbers.map(move |i| corner + (shift + step * f64::from(i)).fract())
}

/// Three numbers in [0, 1) for each ray of a range: what is left to chance along it. They are an R3 sequence, shifted as the
/// points are, by another hash. Each alone is spread most evenly in the first, and least in the second.
pub(crate) fn chances(pixel: [u32; 2], numbers: std::ops::Range<u32>) -> impl Iterator<Item = DVec3> {
    let step = DVec3::new(1.0 / FOURTH, 1.0 / FOURTH.powi(2), 1.0 / FOURTH.powi(3));
    let (first, second) = (mix(word(pixel)), mix(mix(word(pixel))));
    let shift = DVec3::new(unit(first), unit(first >> 32), unit(second));
    numbers.map(move |i| (shift + step * f64::from(i)).fract())
}

/// Two numbers in [0, 1) that look random.
fn shift(pixel: [u32; 2]) -> DVec2 {
    let word = word(pixel);
    DVec2::new(unit(word), unit(word >> 32))
}

/// A hash of a pixel.
fn word(pixel: [u32; 2]) -> u64 {
    let key = (u64::from(pixel[1]) << 32) | u64::from(pixel[0]);
    mix(mix(key ^ 0x9e37_79b9_7f4a_7c15))
}

/// The lower half of a word as a number in [0, 1).
fn unit(bits: u64) -> f64 {
    (bits & 0xffff_ffff) as f64 / 4_294_967_296.0
}

/// The finalizer of SplitMix64 (Stafford's variant 13).
fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_in_their_pixel_and_spread_evenly() {
        for pixel in [[0, 0], [7, 3], [1919, 1079]] {
            let corner = UVec2::from_array(pixel).as_dvec2();
            let points: Vec<_> = sample_points(pixel, 64).map(|point| point - corner).collect();
            assert!(points.iter().all(|point| point.cmpge(DVec2::ZERO).all() && point.cmplt(DVec2::ONE).all()));
            for line in 1..8 {
                let share = f64::from(line) / 8.0;
                let (left, above) = (points.iter().filter(|p| p.x < share), points.iter().filter(|p| p.y < share));
                assert!((left.count() as f64 / 64.0 - share).abs() < 0.05, "{pixel:?} {share}");
                assert!((above.count() as f64 / 64.0 - share).abs() < 0.05, "{pixel:?} {share}");
            }
        }
    }

    #[test]
    fn neighboring_pixels_have_other_points() {
        let firsts: Vec<DVec2> = (0..64).map(|i| shift([i % 8, i / 8])).collect();
        let mean = firsts.iter().sum::<DVec2>() / 64.0;
        assert!((mean - 0.5).abs().max_element() < 0.1, "{mean}");
        for (i, a) in firsts.iter().enumerate() {
            assert!(firsts[..i].iter().all(|b| a.distance(*b) > 1e-4));
        }
    }
}
