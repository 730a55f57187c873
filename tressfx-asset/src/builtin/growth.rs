//! How one strand grows from its root, before it is drawn to a clump.

use glam::Vec3;
use rand::{Rng, RngExt};

use super::body::Body;
use super::roots::Root;
use super::style::{Look, Region};

/// A strand is followed in at least this many steps, however few vertices it has.
const STEPS: usize = 48;
/// Distance from the root over which hair rises to the height at which it lies, in metres.
const RISE: f32 = 0.05;
/// Hair whose root is further to the front than this falls on the chest, the rest on the back.
const CHEST: f32 = 0.3;

/// Grows a strand: `vertices` points at even distances, the first of them the root.
pub(super) fn grow(look: &Look, body: &Body, root: &Root, vertices: usize, random: &mut impl Rng) -> Vec<Vec3> {
    let length = length(look, root) * (1.0 + look.length_spread * (random.random::<f32>() - 0.7));
    let mut direction = first_direction(look, root, random);
    let drift = look.direction_spread * 6.0 * in_cube(random);
    // Hair from higher up lies over hair from further down.
    let height = look.volume * (0.35 * random.random::<f32>() + 0.65 * (0.5 + 0.5 * root.direction.y));
    let steps = STEPS.div_ceil(vertices - 1);
    let step = length / ((vertices - 1) * steps) as f32;
    let (mut at, mut arc) = (root.position, 0.0);
    let mut points = vec![at];
    for _ in 1..vertices {
        for _ in 0..steps {
            arc += step;
            let force = Vec3::NEG_Y * look.gravity + drift + body.draw(at, root.direction.z > CHEST);
            direction = (direction + force * step).normalize_or(Vec3::NEG_Y);
            let margin = height * (arc / RISE).min(1.0);
            direction = (body.push_out(at + direction * step, margin) - at).normalize_or(direction);
            at += direction * step;
        }
        points.push(at);
    }
    points
}

/// Long enough to reach the hem on the way around the head.
fn length(look: &Look, root: &Root) -> f32 {
    let around = 0.06 * (0.5 + 0.5 * root.direction.y);
    root.length * look.hem.map_or(look.length, |hem| (root.position.y - hem + around).max(look.length))
}

/// Away from the parting and to the back, along the surface; then raised by the style's lift.
fn first_direction(look: &Look, root: &Root, random: &mut impl Rng) -> Vec3 {
    let comb = match look.region {
        Region::Scalp => {
            let side = if root.position.x < look.parting { -1.0 } else { 1.0 };
            // Behind the crown hair is combed straight down.
            let front = (0.5 + 2.0 * root.direction.z).clamp(0.0, 1.0);
            Vec3::new(side * front, -0.6 * (1.0 - front), -0.75)
        }
        Region::Everywhere | Region::Face => Vec3::new(0.35, -1.0, 0.2),
    };
    let comb = root.flow.unwrap_or(comb);
    let along = (comb - root.normal * comb.dot(root.normal)).normalize_or_zero();
    let direction = along * (1.0 - look.lift) + root.normal * look.lift + look.direction_spread * in_cube(random);
    direction.normalize_or(root.normal)
}

/// A random vector with coordinates from -0.5 to 0.5.
pub(super) fn in_cube(random: &mut impl Rng) -> Vec3 {
    Vec3::new(random.random(), random.random(), random.random()) - 0.5
}
