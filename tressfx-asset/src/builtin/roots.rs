//! Where strands grow.

use std::f32::consts::TAU;

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use tressfx_core::shape::Ellipsoid;

use super::animal;
use super::body::Body;
use super::style::{Look, Region};

/// The root of a strand.
pub(super) struct Root {
    /// On the surface of the head.
    pub(super) position: Vec3,
    /// Outward unit normal of the surface.
    pub(super) normal: Vec3,
    /// From the centre, in multiples of the head's radii; the normal of an animal's skin.
    pub(super) direction: Vec3,
    /// Where hair is combed to, where that depends on more than the style.
    pub(super) flow: Option<Vec3>,
    /// Length as a multiple of the style's.
    pub(super) length: f32,
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
        let place = [start[0] + index / PLASTIC, start[1] + index / (PLASTIC * PLASTIC)].map(|at| at.fract() as f32);
        let jitter = 0.05 * (random.random::<f32>() - 0.5);
        roots.extend(match &body.head {
            Some(head) => on_head(look.region, head, place, jitter)
                .filter(|root| look.region != Region::Face || body.is_free(root.position)),
            // Of one part only a strip of the sequence is seen, in which it is no longer even around.
            None => animal::root(&body.parts, [place[0], random.random()]),
        });
    }
    roots
}

/// The root at a place of a head, both of its numbers from 0 to 1; none where no hair grows.
fn on_head(region: Region, head: &Ellipsoid, place: [f32; 2], jitter: f32) -> Option<Root> {
    let (height, around) = (1.0 - 2.0 * place[0], TAU * place[1]);
    let ring = (1.0 - height * height).max(0.0).sqrt();
    let direction = Vec3::new(around.sin() * ring, height, around.cos() * ring);
    let (flow, length) = match region {
        Region::Everywhere => (None, 1.0),
        Region::Scalp => (height + jitter > hairline(direction)).then_some((None, 1.0))?,
        Region::Face => beard(direction, jitter).map(|(flow, length)| (Some(flow), length))?,
    };
    let position = head.center + direction * head.radii;
    Some(Root { position, normal: head.normal(position), direction, flow, length })
}

/// Where hair of a beard, a moustache or a brow is combed to in a direction of the head, and its length as a multiple of the style's.
fn beard(direction: Vec3, jitter: f32) -> Option<(Vec3, f32)> {
    let Vec3 { x, y, z } = direction;
    let side = x.abs();
    let is_brow = z > 0.0
        && (0.14..0.56).contains(&side)
        && (y - 0.22 + 0.5 * (side - 0.32).powi(2)).abs() < 0.028 + 0.3 * jitter;
    if is_brow {
        return Some((Vec3::new(x.signum(), 0.25 - 0.6 * (side - 0.14), -0.3), 0.3));
    }
    // From the side-burns along the jaw to the chin, around the mouth.
    let upper = -0.12 - 0.36 * (z.max(0.0)).powi(2) + jitter;
    let is_beard = z > -0.12 + jitter && y < upper && y > -0.95;
    let is_moustache = z > 0.0 && side < 0.34 + jitter && (-0.47..-0.36).contains(&(y + 0.2 * side));
    let is_mouth = z > 0.0 && (side / 0.3).powi(2) + ((y + 0.535) / 0.075).powi(2) < 1.0 + 2.0 * jitter;
    if is_mouth {
        return None;
    }
    if is_moustache {
        return Some((Vec3::new(1.6 * x.signum(), -1.0, 0.0), 0.45));
    }
    is_beard.then(|| (Vec3::new(0.0, -1.0, 0.25), 0.35 + 0.65 * (-1.4 * y - 0.2).clamp(0.0, 1.0)))
}

/// The height of the hairline in a direction: high at the forehead (+z), at the ears in the middle, low at the nape.
fn hairline(direction: Vec3) -> f32 {
    let ring = direction.x.hypot(direction.z).max(1e-6);
    let forwards = direction.z / ring;
    0.02 + 0.5 * forwards - 0.02 * forwards * forwards
}
