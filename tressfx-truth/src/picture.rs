//! What comes out.

use glam::{DVec3, DVec4};

/// How far the mean over the samples is from the mean over the square of each pixel, as the two halves of the samples tell:
/// if they were independent, the difference of the halves, divided by two, would have the size of the error of the whole.
/// Evenly spread samples do better than that, so it is an estimate from above.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SamplingError {
    /// Root of the mean square over all pixels and the four channels of premultiplied linear colour and alpha.
    pub rms: f64,
    /// The largest of any channel of a pixel.
    pub max: f64,
}

/// A picture of hair over nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub(crate) size: [u32; 2],
    pub(crate) pixels: Vec<DVec4>,
    pub(crate) error: Option<SamplingError>,
    pub(crate) shadow_rays: u64,
}

impl Picture {
    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Premultiplied linear RGB and alpha, row by row from the top.
    pub fn pixels(&self) -> &[DVec4] {
        &self.pixels
    }

    /// The error of sampling; none of a single sample.
    pub fn error(&self) -> Option<SamplingError> {
        self.error
    }

    /// How many rays went towards light.
    pub fn shadow_rays(&self) -> u64 {
        self.shadow_rays
    }

    /// The picture over a scene: linear RGB, row by row from the top. Pixels beyond the shorter of both are left out.
    pub fn over(&self, scene: &[DVec3]) -> Vec<DVec3> {
        self.pixels.iter().zip(scene).map(|(hair, scene)| hair.truncate() + (1.0 - hair.w) * *scene).collect()
    }
}

/// The sum over the samples of a pixel, in two halves.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum([DVec4; 2]);

/// How many samples there are, in two halves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Halves {
    counts: [u32; 2],
}

impl Halves {
    pub(crate) fn new(samples: u32) -> Self {
        Self { counts: [samples / 2, samples - samples / 2] }
    }

    /// Whether each half has a sample.
    pub(crate) fn tell_error(&self) -> bool {
        self.counts[0] > 0
    }

    pub(crate) fn samples(&self) -> u32 {
        self.counts[0] + self.counts[1]
    }

    pub(crate) fn add(&self, sum: &mut Sum, sample: u32, color: DVec4) {
        sum.0[usize::from(sample >= self.counts[0])] += color;
    }

    pub(crate) fn mean(&self, sum: &Sum) -> DVec4 {
        (sum.0[0] + sum.0[1]) / f64::from(self.samples())
    }

    /// The estimated error of the mean: the standard deviation of the mean of n values is as large as that of the difference
    /// of the means of p and q of them, p + q = n, times sqrt(p q) / n.
    pub(crate) fn error(&self, sum: &Sum) -> DVec4 {
        let [p, q] = self.counts.map(f64::from);
        (sum.0[0] / p - sum.0[1] / q).abs() * (p * q).sqrt() / (p + q)
    }
}

/// The errors of some pixels, summed up.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errors {
    square: f64,
    max: f64,
}

impl Errors {
    pub(crate) fn add(&mut self, error: DVec4) {
        self.square += error.length_squared();
        self.max = self.max.max(error.max_element());
    }

    pub(crate) fn with(self, other: Self) -> Self {
        Self { square: self.square + other.square, max: self.max.max(other.max) }
    }

    /// In two figures, for a picture of so many pixels.
    pub(crate) fn summary(self, pixels: usize) -> SamplingError {
        SamplingError { rms: (self.square / (4 * pixels).max(1) as f64).sqrt(), max: self.max }
    }
}
