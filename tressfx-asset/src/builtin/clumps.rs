//! Clumps: strands that share a lock, its waves and its tip.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use rand::{Rng, RngExt};
use rand_pcg::Pcg32;
use rayon::prelude::*;
use tressfx_core::shape::Capsule;

use super::body::Body;
use super::growth;
use super::roots::Root;
use super::style::{Look, Wave};

/// One strand in so many keeps to itself.
const FLYAWAY: f32 = 0.03;
/// Shares of the pull to its clump that are tried on a strand.
const PULLS: [f32; 4] = [1.0, 0.6, 0.3, 0.0];
/// An edge is looked at between so many parts.
const SAMPLES: u16 = 8;
/// Random streams of the clumps begin here; those of the strands at 0.
const CLUMP_STREAMS: u64 = 1 << 32;

/// A lock: the strand in its middle, and what all its strands wind around together.
struct Clump {
    root: Vec3,
    points: Vec<Vec3>,
    /// Two axes across each edge of the middle, carried along it without twist.
    axes: Vec<[Vec3; 2]>,
    phase: f32,
    /// Of the style's pitch.
    pitch: f32,
}

/// Grows all strands: the points of all, concatenated. None is inside the body.
pub(super) fn grow(look: &Look, body: &Body, roots: &[Root], vertices: usize, seed: u64) -> Vec<[f32; 3]> {
    let count = (roots.len() / look.clump_size).clamp(1, look.most_clumps);
    let clump = |(index, root): (usize, &Root)| {
        let mut random = Pcg32::new(seed, CLUMP_STREAMS + index as u64);
        let points = growth::grow(look, body, root, vertices, &mut random);
        let (phase, pitch) = (TAU * random.random::<f32>(), 0.85 + 0.3 * random.random::<f32>());
        Clump { root: root.position, axes: axes(&points), points, phase, pitch }
    };
    let clumps: Vec<Clump> = roots[..count].par_iter().enumerate().map(clump).collect();
    let capsules = body.capsules();
    let strand = |index: usize, root: &Root| {
        let mut random = Pcg32::new(seed, index as u64);
        let own = growth::grow(look, body, root, vertices, &mut random);
        let clump = nearest(&clumps, look, root);
        let pull = if random.random::<f32>() > FLYAWAY { look.clumping } else { 0.0 };
        let finish = |pull: f32| {
            let mut points = own.clone();
            draw_to(&mut points, clump, look, pull);
            wind(&mut points, &look.wave, clump, &mut random.clone());
            points[1..].iter_mut().for_each(|point| *point = body.clear(*point));
            points
        };
        // A lock on the other side of a shoulder would draw a strand through it: the less it is drawn, the more it goes around.
        let points = PULLS.into_iter().map(|share| finish(share * pull)).find(|points| !is_cut(points, &capsules));
        points.unwrap_or(own)
    };
    let mut all = vec![[0.0; 3]; roots.len() * vertices];
    all.par_chunks_mut(vertices).zip(roots).enumerate().for_each(|(index, (points, root))| {
        points.iter_mut().zip(strand(index, root)).for_each(|(point, grown)| *point = grown.into());
    });
    all
}

/// Whether a strand goes through any of these.
fn is_cut(points: &[Vec3], capsules: &[Capsule]) -> bool {
    let inside = |point: Vec3| capsules.iter().any(|capsule| capsule.distance(point) < 0.0);
    let samples =
        |edge: &[Vec3]| (1..SAMPLES).any(|i| inside(edge[0].lerp(edge[1], f32::from(i) / f32::from(SAMPLES))));
    points.windows(2).any(samples)
}

/// The clump whose root is nearest, on the same side of the parting.
fn nearest<'a>(clumps: &'a [Clump], look: &Look, root: &Root) -> &'a Clump {
    let side = |position: Vec3| position.x < look.parting;
    let cost = |clump: &Clump| {
        let across = if side(clump.root) == side(root.position) { 0.0 } else { 1.0 };
        across + clump.root.distance_squared(root.position)
    };
    clumps.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(&clumps[0])
}

/// Draws a strand to the middle of its clump, the more the nearer to the tip; there by the share `most`.
fn draw_to(points: &mut [Vec3], clump: &Clump, look: &Look, most: f32) {
    let offset = points[0] - clump.root;
    let last = (points.len() - 1) as f32;
    for (vertex, (point, &middle)) in points.iter_mut().zip(&clump.points).enumerate() {
        let s = vertex as f32 / last;
        let near = (s / look.clump_onset).min(1.0);
        let pull = most * near * near * (3.0 - 2.0 * near);
        let width = 1.0 + (look.clump_width - 1.0) * s;
        *point = point.lerp(middle + offset * width, pull);
    }
}

/// Axes across the edges of a strand, carried along it without twist.
fn axes(points: &[Vec3]) -> Vec<[Vec3; 2]> {
    let mut tangent = (points[1] - points[0]).normalize_or(Vec3::Y);
    let (mut u, mut v) = tangent.any_orthonormal_pair();
    let carried = points.windows(2).map(|pair| {
        let next = (pair[1] - pair[0]).normalize_or(tangent);
        let turn = Quat::from_rotation_arc(tangent, next);
        (tangent, u, v) = (next, turn * u, turn * v);
        [u, v]
    });
    carried.collect()
}

/// Winds a strand around its own middle line, side by side with the other strands of its clump.
fn wind(points: &mut [Vec3], wave: &Wave, clump: &Clump, random: &mut impl Rng) {
    let phase = clump.phase + wave.looseness * (random.random::<f32>() - 0.5);
    let radius = wave.radius * (1.0 + 0.6 * wave.looseness * (random.random::<f32>() - 0.5));
    let mut before = points[0];
    let mut arc = 0.0;
    for (point, [u, v]) in points[1..].iter_mut().zip(&clump.axes) {
        arc += before.distance(*point);
        before = *point;
        let grown = (arc / wave.onset).min(1.0);
        let angle = phase + TAU * arc / (wave.pitch * clump.pitch);
        *point += (u * angle.cos() + v * (wave.roundness * angle.sin())) * (radius * grown * grown);
    }
}
