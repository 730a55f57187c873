//! Clumps: strands that share a lock, its waves and its tip.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use rand::{Rng, RngExt};
use rand_pcg::Pcg32;

use super::body::Body;
use super::growth;
use super::roots::Root;
use super::style::{Look, Wave};

/// More clumps than this would cost time and not be told apart.
const MOST_CLUMPS: usize = 600;
/// One strand in so many keeps to itself.
const FLYAWAY: f32 = 0.03;
/// Random streams of the clumps begin here; those of the strands at 0.
const CLUMP_STREAMS: u64 = 1 << 32;

/// A lock: the strand in its middle and the phase of its waves.
struct Clump {
    root: Vec3,
    points: Vec<Vec3>,
    phase: f32,
}

/// Grows all strands: the points of all, concatenated. None is inside the body.
pub(super) fn grow(look: &Look, body: &Body, roots: &[Root], vertices: usize, seed: u64) -> Vec<[f32; 3]> {
    let count = (roots.len() / look.clump_size).clamp(1, MOST_CLUMPS);
    let clump = |(index, root): (usize, &Root)| {
        let mut random = Pcg32::new(seed, CLUMP_STREAMS + index as u64);
        let points = growth::grow(look, body, root, vertices, &mut random);
        Clump { root: root.position, points, phase: TAU * random.random::<f32>() }
    };
    let clumps: Vec<Clump> = roots[..count].iter().enumerate().map(clump).collect();
    let mut all = Vec::with_capacity(roots.len() * vertices);
    for (index, root) in roots.iter().enumerate() {
        let mut random = Pcg32::new(seed, index as u64);
        let mut points = growth::grow(look, body, root, vertices, &mut random);
        let clump = nearest(&clumps, look, root);
        if random.random::<f32>() > FLYAWAY {
            draw_to(&mut points, clump, look);
        }
        wind(&mut points, &look.wave, clump.phase, &mut random);
        let tail = points[1..].iter().map(|&point| body.clear(point).to_array());
        all.extend(std::iter::once(root.position.to_array()).chain(tail));
    }
    all
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

/// Draws a strand to the middle of its clump, the more the nearer to the tip.
fn draw_to(points: &mut [Vec3], clump: &Clump, look: &Look) {
    let offset = points[0] - clump.root;
    let last = (points.len() - 1) as f32;
    for (vertex, (point, &middle)) in points.iter_mut().zip(&clump.points).enumerate() {
        let s = vertex as f32 / last;
        let pull = look.clumping * s * s * (3.0 - 2.0 * s);
        let width = 1.0 + (look.clump_width - 1.0) * s;
        *point = point.lerp(middle + offset * width, pull);
    }
}

/// Winds a strand around its own middle line, in axes that are carried along it without twist.
fn wind(points: &mut [Vec3], wave: &Wave, phase: f32, random: &mut impl Rng) {
    let phase = phase + 0.9 * (random.random::<f32>() - 0.5);
    let radius = wave.radius * (0.75 + 0.5 * random.random::<f32>());
    let pitch = wave.pitch * (0.94 + 0.12 * random.random::<f32>());
    let middle = points.to_vec();
    let mut tangent = (middle[1] - middle[0]).normalize_or(Vec3::Y);
    let (mut u, mut v) = tangent.any_orthonormal_pair();
    let mut arc = 0.0;
    for (point, pair) in points[1..].iter_mut().zip(middle.windows(2)) {
        let next = (pair[1] - pair[0]).normalize_or(tangent);
        let turn = Quat::from_rotation_arc(tangent, next);
        (tangent, u, v) = (next, turn * u, turn * v);
        arc += pair[0].distance(pair[1]);
        let grown = (arc / wave.onset).min(1.0);
        let angle = phase + TAU * arc / pitch;
        *point += (u * angle.cos() + v * (wave.roundness * angle.sin())) * (radius * grown * grown);
    }
}
