//! Where strands grow.

use std::f32::consts::TAU;

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use super::body::Body;
use super::style::{Look, Region};

/// The root of a strand.
pub(super) struct Root {
    /// On the surface of the head.
    pub(super) position: Vec3,
    /// Outward unit normal of the surface.
    pub(super) normal: Vec3,
    /// From the centre, in multiples of the head's radii.
    pub(super) direction: Vec3,
}

/// Roots evenly over the region. They follow the R2 sequence (Roberts 2018, "The unreasonable effectiveness of quasirandom
/// sequences"), of which every prefix is an even sample, so the first ones serve as the middles of the clumps.
pub(super) fn roots(look: &Look, body: &Body, count: usize, seed: u64) -> Vec<Root> {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let mut random = Pcg32::seed_from_u64(seed);
    let start: [f64; 2] = [random.random(), random.random()];
    let mut roots = Vec::with_capacity(count);
    let mut index = 0.0;
    while roots.len() < count {
        index += 1.0;
        let height = 1.0 - 2.0 * (start[0] + index / PLASTIC).fract() as f32;
        let around = TAU * (start[1] + index / (PLASTIC * PLASTIC)).fract() as f32;
        let ring = (1.0 - height * height).max(0.0).sqrt();
        let direction = Vec3::new(around.sin() * ring, height, around.cos() * ring);
        let jitter = 0.05 * (random.random::<f32>() - 0.5);
        if look.region == Region::Everywhere || height + jitter > hairline(direction) {
            let position = body.head.center + direction * body.head.radii;
            roots.push(Root { position, normal: body.head.normal(position), direction });
        }
    }
    roots
}

/// The height of the hairline in a direction: high at the forehead (+z), at the ears in the middle, low at the nape.
fn hairline(direction: Vec3) -> f32 {
    let ring = direction.x.hypot(direction.z).max(1e-6);
    let forwards = direction.z / ring;
    0.02 + 0.5 * forwards - 0.02 * forwards * forwards
}
