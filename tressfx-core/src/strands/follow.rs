//! Follow strands: copies of a guide, each moved by an offset across the root's direction.

use std::f32::consts::TAU;

use glam::{Quat, Vec3, Vec4};
use rand::RngExt;
use rand_pcg::Pcg32;

/// Where the follow strands are placed around a guide.
#[derive(Clone, Copy)]
pub(super) struct Disc {
    pub(super) follows: u32,
    pub(super) radius: f32,
    pub(super) seed: u64,
}

impl Disc {
    /// The offsets of a guide's follow strands: uniform in a disc across the root. Every strand of the file has a random
    /// stream of its own, so that neither the order of the guides nor other strands change its offsets.
    pub(super) fn offsets(self, root_frame: Quat, file_strand: u32) -> impl Iterator<Item = Vec4> {
        let mut random = Pcg32::new(self.seed, file_strand.into());
        let (y, z) = (root_frame * Vec3::Y, root_frame * Vec3::Z);
        (0..self.follows).map(move |_| {
            // The square root makes the density uniform by area.
            let radius = self.radius * random.random::<f32>().sqrt();
            let (sin, cos) = (TAU * random.random::<f32>()).sin_cos();
            ((y * cos + z * sin) * radius).extend(0.0)
        })
    }
}

/// Factor of an offset at a vertex: it grows along the strand, from 1 at the root to `1 + tip_separation` at the tip.
pub(super) fn spread(tip_separation: f32, vertex: usize, vertices: u32) -> f32 {
    1.0 + tip_separation * vertex as f32 / (vertices - 1) as f32
}
