//! Filters of FLIP over whole pictures. Four channels go through at once, each with kernels of its own.

use std::f64::consts::PI;

use glam::{DVec2, Vec4, vec4};

/// A filter along the rows and then along the columns; a picture goes on beyond its edges as its outermost pixels.
pub(crate) struct Separable {
    across: Vec<Vec4>,
    down: Vec<Vec4>,
}

/// A Gaussian of contrast sensitivity as the paper writes it: its height before scaling, and its width.
struct Gaussian {
    a: f64,
    b: f64,
}

impl Gaussian {
    fn at(&self, degrees: f64) -> f64 {
        (-PI * PI * degrees * degrees / self.b).exp()
    }
}

impl Separable {
    /// Blurs away the detail that the eye cannot see, for the channels Y, Cx and the two parts of Cz.
    pub(crate) fn contrast_sensitivity(pixels_per_degree: f64) -> Self {
        let gaussians = [(1.0, 0.0047), (1.0, 0.0053), (34.1, 0.04), (13.5, 0.025)].map(|(a, b)| Gaussian { a, b });
        let widest = (0.04 / (2.0 * PI * PI)).sqrt();
        let places = places(3.0 * widest * pixels_per_degree);
        let sums = gaussians.each_ref().map(|gaussian| places.iter().map(|x| gaussian.at(x / pixels_per_degree)).sum());
        let shares = shares(&gaussians, sums);
        let down = places.iter().map(|x| {
            let weight = |channel: usize| (gaussians[channel].at(x / pixels_per_degree) / sums[channel]) as f32;
            Vec4::from_array([0, 1, 2, 3].map(weight))
        });
        let down: Vec<Vec4> = down.collect();
        Self { across: down.iter().map(|weight| weight * shares).collect(), down }
    }

    /// Finds edges and points of the luminance, which all four channels hold: what comes out is an edge across and
    /// down, and a point across and down.
    pub(crate) fn detectors(pixels_per_degree: f64) -> Self {
        const FEATURE_DEGREES: f64 = 0.082;
        let deviation = 0.5 * FEATURE_DEGREES * pixels_per_degree;
        let places = places(3.0 * deviation);
        let gaussian = |x: &f64| (-x * x / (2.0 * deviation * deviation)).exp();
        let smooth = balanced(places.iter().map(gaussian).collect());
        let edge = balanced(places.iter().map(|x| -x * gaussian(x)).collect());
        let point = balanced(places.iter().map(|x| (x * x / (deviation * deviation) - 1.0) * gaussian(x)).collect());
        let at = |i: usize| (edge[i], smooth[i], point[i]);
        let kernel = |pack: fn((f32, f32, f32)) -> Vec4| (0..places.len()).map(at).map(pack).collect();
        Self {
            across: kernel(|(edge, smooth, point)| vec4(edge, smooth, point, smooth)),
            down: kernel(|(edge, smooth, point)| vec4(smooth, edge, smooth, point)),
        }
    }

    /// The filtered picture.
    pub(crate) fn apply(&self, pixels: &[Vec4], width: usize) -> Vec<Vec4> {
        self.along_columns(&self.along_rows(pixels, width), width)
    }

    fn along_rows(&self, pixels: &[Vec4], width: usize) -> Vec<Vec4> {
        let radius = self.across.len() / 2;
        let mut filtered = Vec::with_capacity(pixels.len());
        let mut padded = Vec::with_capacity(width + 2 * radius);
        for row in pixels.chunks_exact(width) {
            padded.clear();
            padded.resize(radius, row[0]);
            padded.extend_from_slice(row);
            padded.resize(width + 2 * radius, row[width - 1]);
            let weigh = |window: &[Vec4]| window.iter().zip(&self.across).map(|(pixel, weight)| pixel * weight).sum();
            filtered.extend(padded.windows(self.across.len()).map(|window| -> Vec4 { weigh(window) }));
        }
        filtered
    }

    fn along_columns(&self, pixels: &[Vec4], width: usize) -> Vec<Vec4> {
        let (radius, height) = (self.down.len() / 2, pixels.len() / width);
        let mut filtered = vec![Vec4::ZERO; pixels.len()];
        for (y, sums) in filtered.chunks_exact_mut(width).enumerate() {
            for (tap, weight) in self.down.iter().enumerate() {
                let from = (y + tap).saturating_sub(radius).min(height - 1);
                let row = &pixels[from * width..][..width];
                sums.iter_mut().zip(row).for_each(|(sum, pixel)| *sum += pixel * weight);
            }
        }
        filtered
    }
}

/// Whole numbers from `-radius` to `radius`.
fn places(radius: f64) -> Vec<f64> {
    let radius = radius.ceil() as i32;
    (-radius..=radius).map(f64::from).collect()
}

/// What each channel's kernel sums to: one, and one over both parts of Cz. In two dimensions a sum is squared.
fn shares(gaussians: &[Gaussian; 4], sums: [f64; 4]) -> Vec4 {
    let volume = |channel: usize| {
        let Gaussian { a, b } = gaussians[channel];
        a * (PI / b).sqrt() * sums[channel] * sums[channel]
    };
    let parts = DVec2::new(volume(2), volume(3));
    let parts = (parts / parts.element_sum()).as_vec2();
    vec4(1.0, 1.0, parts.x, parts.y)
}

/// Scales the weights above zero to a sum of 1 and those below to a sum of -1.
fn balanced(weights: Vec<f64>) -> Vec<f32> {
    let above: f64 = weights.iter().filter(|weight| **weight > 0.0).sum();
    let below: f64 = weights.iter().filter(|weight| **weight < 0.0).sum();
    weights.iter().map(|weight| (weight / if *weight > 0.0 { above } else { -below }) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flip::PIXELS_PER_DEGREE;

    #[test]
    fn an_even_picture_stays_and_has_no_features() {
        let pixels = vec![vec4(0.25, 0.5, 1.0, 1.0); 5 * 4];
        for pixel in Separable::contrast_sensitivity(PIXELS_PER_DEGREE).apply(&pixels, 5) {
            assert!(vec4(pixel.x, pixel.y, pixel.z + pixel.w, 0.0).abs_diff_eq(vec4(0.25, 0.5, 1.0, 0.0), 1e-5));
        }
        for pixel in Separable::detectors(PIXELS_PER_DEGREE).apply(&vec![Vec4::ONE; 20], 5) {
            assert!(pixel.abs_diff_eq(Vec4::ZERO, 1e-5), "{pixel}");
        }
    }

    #[test]
    fn a_step_is_an_edge_across_itself_only() {
        let filter = Separable::detectors(PIXELS_PER_DEGREE);
        let step: Vec<Vec4> = (0..40 * 30).map(|i| Vec4::splat(if i % 40 < 20 { 0.0 } else { 1.0 })).collect();
        let middle = filter.apply(&step, 40)[15 * 40 + 20];
        assert!((0.8..=1.0).contains(&middle.x.abs()), "{middle}");
        assert!(middle.y.abs() < 1e-5 && middle.w.abs() < 1e-5, "{middle}");
    }

    #[test]
    fn the_kernels_are_as_wide_as_the_paper_says() {
        assert_eq!(Separable::contrast_sensitivity(PIXELS_PER_DEGREE).down.len(), 2 * 10 + 1);
        assert_eq!(Separable::detectors(PIXELS_PER_DEGREE).down.len(), 2 * 9 + 1);
    }
}
