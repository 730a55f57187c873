//! A pony tail: hair that is drawn back over the skull into a tie, and hair that hangs from the tie.
//!
//! A strand is held at its ends alone, so the hair of the skull ends in the tie, with its tip held, and as many strands again
//! begin there.

use std::f32::consts::TAU;

use glam::Vec3;
use rand::{Rng, RngExt};
use rand_pcg::Pcg32;

use tressfx_core::shape::{Capsule, Ellipsoid};

use super::body::Body;
use super::clumps;
use super::growth::in_cube;
use super::roots::{self, Root};
use super::style::Look;

/// The tie's direction from the middle of the head, in multiples of the head's radii.
const DIRECTION: Vec3 = Vec3::new(0.0, 0.42, -0.907);
/// Its ring: radius of the middle line, half of its thickness, height of the middle line over the skull.
const RING: f32 = 0.0135;
const THICKNESS: f32 = 0.0042;
const HEIGHT: f32 = 0.0125;
/// Capsules of the ring.
const SEGMENTS: usize = 16;
/// Radius of the bundle of hair in the tie.
const BUNDLE: f32 = 0.0085;
/// Strands of the skull, of twenty.
const ON_SKULL: usize = 11;
/// Hair lies so far above the skull at least, and so much higher where it has come all the way from the forehead.
const LOWEST: f32 = 0.0012;
const LAYERS: f32 = 0.0045;
/// The way to the tie is followed in so many steps.
const STEPS: usize = 64;
/// Random streams of the tail begin here; those of the skull at 0.
const TAIL_SEED: u64 = 0x7461_696c;

/// What hair is drawn into: a ring at the back of the head.
pub(super) struct Tie {
    center: Vec3,
    /// Away from the head.
    axis: Vec3,
    /// Unit vectors across the axis.
    across: [Vec3; 2],
}

/// All strands, and what they are held by.
pub(super) struct Tail {
    pub(super) roots: Vec<Root>,
    /// All vertices, concatenated.
    pub(super) points: Vec<[f32; 3]>,
    /// Of each vertex; 0 where it is held.
    pub(super) inverse_mass: Vec<f32>,
}

impl Tie {
    pub(super) fn on(head: &Ellipsoid) -> Self {
        let position = head.center + DIRECTION.normalize() * head.radii;
        let axis = head.normal(position);
        let (u, v) = axis.any_orthonormal_pair();
        Self { center: position + axis * HEIGHT, axis, across: [u, v] }
    }

    /// Its ring as capsules.
    pub(super) fn ring(&self) -> Vec<Capsule> {
        let place = |index: usize| self.center + self.outwards(index as f32 / SEGMENTS as f32) * RING;
        let segment =
            |index| Capsule { a: place(index), b: place(index + 1), radius_a: THICKNESS, radius_b: THICKNESS };
        (0..SEGMENTS).map(segment).collect()
    }

    /// Across the axis at an angle of so many turns.
    fn outwards(&self, turns: f32) -> Vec3 {
        let (sin, cos) = (TAU * turns).sin_cos();
        self.across[0] * cos + self.across[1] * sin
    }
}

/// Grows all strands, first those of the skull. No vertex is inside of the body.
pub(super) fn grow(look: &Look, body: &Body, tie: &Tie, count: usize, vertices: usize, seed: u64) -> Tail {
    let on_skull = (count * ON_SKULL).div_ceil(20);
    let mut roots = roots::roots(look, body, on_skull, seed);
    let mut points = Vec::with_capacity(count * vertices);
    for (index, root) in roots.iter().enumerate() {
        let mut random = Pcg32::new(seed, index as u64);
        points.extend(over_skull(body, tie, root, vertices, &mut random).iter().map(Vec3::to_array));
    }
    let tail: Vec<Root> = (on_skull..count).map(|index| tail_root(tie, index, seed)).collect();
    if !tail.is_empty() {
        points.extend(clumps::grow(look, body, &tail, vertices, seed ^ TAIL_SEED));
    }
    let mut inverse_mass = vec![1.0; count * vertices];
    for (index, strand) in inverse_mass.chunks_mut(vertices).enumerate() {
        strand[..2].fill(0.0);
        if index < on_skull {
            strand[vertices - 2..].fill(0.0);
        }
    }
    roots.extend(tail);
    Tail { roots, points, inverse_mass }
}

/// A root in the tie, from which a strand hangs.
fn tail_root(tie: &Tie, index: usize, seed: u64) -> Root {
    let mut random = Pcg32::new(seed ^ TAIL_SEED, (1 << 33) + index as u64);
    let position = tie.center + in_bundle(tie, random.random(), &mut random);
    Root { position, normal: tie.axis, direction: DIRECTION.normalize(), flow: Some(tie.axis), length: 1.0 }
}

/// A place in the bundle at an angle, from the tie's centre.
fn in_bundle(tie: &Tie, turns: f32, random: &mut impl Rng) -> Vec3 {
    tie.outwards(turns) * (BUNDLE * random.random::<f32>().sqrt())
}

/// From the root along the skull to below the tie, and up into it: `vertices` points at even distances.
fn over_skull(body: &Body, tie: &Tie, root: &Root, vertices: usize, random: &mut impl Rng) -> Vec<Vec3> {
    let Some(head) = &body.head else { return vec![root.position; vertices] };
    let from = root.position - tie.center;
    let turns = tie.across[1].dot(from).atan2(tie.across[0].dot(from)) / TAU + 0.15 * (random.random::<f32>() - 0.5);
    let end = tie.center + in_bundle(tie, turns, random);
    let below = ((end - tie.axis * HEIGHT - head.center) / head.radii).normalize_or(DIRECTION);
    let stray = 0.012 * in_cube(random);
    let layer = 0.8 + 0.4 * random.random::<f32>();
    let way = root.position.distance(end);
    let mut path = vec![root.position];
    for step in 1..STEPS {
        let s = step as f32 / STEPS as f32;
        let direction = root.direction.lerp(below, s).normalize_or(below);
        let position = head.center + direction * head.radii;
        // Hair that has come further lies over hair that has not.
        let height = (LOWEST + LAYERS * layer * (s * way / 0.2).min(1.0)) * (s * way / 0.02).min(1.0);
        let bow = (std::f32::consts::PI * s).sin();
        path.push(body.clear(position + head.normal(position) * height + stray * bow));
    }
    path.push(end);
    evenly(&path, vertices)
        .into_iter()
        .enumerate()
        .map(|(i, point)| if i == 0 { point } else { body.clear(point) })
        .collect()
}

/// Points at even distances along a path, its ends among them.
fn evenly(path: &[Vec3], count: usize) -> Vec<Vec3> {
    let arcs: Vec<f32> = path
        .windows(2)
        .scan(0.0, |arc, pair| {
            *arc += pair[0].distance(pair[1]);
            Some(*arc)
        })
        .collect();
    let length = arcs[arcs.len() - 1];
    let point = |index: usize| {
        let arc = length * index as f32 / (count - 1) as f32;
        let edge = arcs.partition_point(|&end| end < arc).min(arcs.len() - 1);
        let begin = if edge == 0 { 0.0 } else { arcs[edge - 1] };
        path[edge].lerp(path[edge + 1], (arc - begin) / (arcs[edge] - begin).max(1e-9))
    };
    (0..count).map(point).collect()
}
