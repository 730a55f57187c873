//! `hair.sim.collide` in f64.

use glam::DVec3;
use tressfx_core::shape::Capsule;

use super::Guide;
use super::vector::{across, direction_or, rotate_back};
use crate::step::Step;

const ROUNDS: u32 = 8;
const INSIDE: f64 = 0.999999;
const GROWTH: f64 = 4.0;
const TILT: f64 = 1e-7;

/// Turns vertices that are inside a capsule out about their parents, and lets what hangs on them follow.
pub fn collide(step: &Step, guide: &mut Guide, capsules: &[Capsule]) {
    let mut moved = false;
    let mut old_parent = guide.positions[0];
    for i in 1..guide.vertices() {
        let heading = rotate_back(step.head_rotation.as_dvec4(), guide.positions[i] - old_parent);
        old_parent = guide.positions[i];
        if guide.is_pinned(i) {
            moved = false;
            continue;
        }
        let parent = guide.positions[i - 1];
        let length = f64::from(guide.rest_lengths[i - 1]);
        if moved {
            guide.positions[i] = parent + length * direction_or(guide.positions[i] - parent, DVec3::NEG_Y);
        }
        let start = step.in_head(guide.positions[i]);
        let way = start - step.in_head(step.carry(guide.previous[i]));
        let vertex = Vertex { parent: step.in_head(parent), start, length, heading, way };
        if let Some((point, kept)) = resolved(capsules, &vertex, f64::from(step.friction)) {
            guide.previous[i] = step.carry_back(step.in_world(point - kept));
            guide.positions[i] = step.in_world(point);
            moved = true;
        }
    }
}

/// A vertex as the head sees it.
struct Vertex {
    parent: DVec3,
    start: DVec3,
    /// Of the edge from the parent.
    length: f64,
    /// The way that the edge had.
    heading: DVec3,
    /// What it has made in the sub-step.
    way: DVec3,
}

/// Where a vertex is when it has left all capsules, and what they have left of its way; `None` if it was outside.
fn resolved(capsules: &[Capsule], vertex: &Vertex, friction: f64) -> Option<(DVec3, DVec3)> {
    let (mut point, mut heading, mut kept) = (vertex.start, vertex.heading, vertex.way);
    let mut touched = false;
    for _ in 0..ROUNDS {
        let mut again = false;
        for capsule in capsules {
            let (center, radius) = nearest(capsule, point);
            if point.distance_squared(center) < INSIDE * radius * radius {
                let (turned, out) = turned_out(vertex.parent, heading, vertex.length, center, radius);
                let pushed = turned - point;
                let normal = direction_or(turned - center, DVec3::ZERO);
                kept = slid(kept + pushed, normal, pushed.dot(normal).max(0.0), friction);
                point = turned;
                heading = point - vertex.parent;
                touched = true;
                again |= out;
            }
        }
        if !again {
            break;
        }
    }
    touched.then_some((point, kept))
}

fn nearest(capsule: &Capsule, point: DVec3) -> (DVec3, f64) {
    let (a, b) = (capsule.a.as_dvec3(), capsule.b.as_dvec3());
    let (radius_a, radius_b) = (f64::from(capsule.radius_a), f64::from(capsule.radius_b));
    let axis = b - a;
    let squared = axis.length_squared();
    let t = if squared > 0.0 { ((point - a).dot(axis) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (a + t * axis, radius_a + t * (radius_b - radius_a))
}

/// The vertex turned about its parent, onto the sphere or as far as the bound allows, and whether it is out.
fn turned_out(parent: DVec3, heading: DVec3, length: f64, center: DVec3, radius: f64) -> (DVec3, bool) {
    let from_center = parent - center;
    let distance = from_center.length();
    let outwards = direction_or(from_center, DVec3::Y);
    let before = direction_or(heading, outwards);
    let old_cosine = before.dot(outwards);
    let across_outwards = before - old_cosine * outwards;
    let old_sine = across_outwards.length();
    let gap = distance + length - radius;
    let product = gap * (distance + length + radius) * (radius - distance + length) * (radius + distance - length);
    let twice = (2.0 * distance * length).max(1e-24);
    let mut cosine = ((radius - distance) * (radius + distance) - length * length) / twice;
    let least: f64 = if cosine > 0.0 { 1.0 / GROWTH } else { 0.0 };
    cosine = cosine.min((1.0 - least * least).sqrt());
    let mut sine = (product.max(0.0).sqrt() / twice).max(least);
    let turn = f64::atan2(old_sine * cosine - old_cosine * sine, old_cosine * cosine + old_sine * sine);
    let off = if turn > 0.0 { old_sine.max(TILT * distance / length.max(1e-12)) } else { sine * sine };
    let bound = 2.0 * (0.5 * GROWTH * off.min((cosine - old_cosine).abs())).atan();
    let whole = turn.abs() <= bound;
    if !whole {
        let (sin, cos) = (turn.signum() * bound).sin_cos();
        (cosine, sine) = (old_cosine * cos + old_sine * sin, old_sine * cos - old_cosine * sin);
    }
    let sideways = direction_or(across_outwards, across(outwards));
    (parent + length * (cosine * outwards + sine * sideways), whole || turn <= 0.0)
}

/// What friction leaves of a displacement along a surface.
fn slid(displacement: DVec3, normal: DVec3, depth: f64, friction: f64) -> DVec3 {
    let along_normal = displacement.dot(normal);
    let slide = displacement - along_normal * normal;
    let lost = (friction * depth).min(slide.length());
    let pushed = depth.min(along_normal.max(0.0));
    displacement - lost * direction_or(slide, DVec3::ZERO) - pushed * normal
}
