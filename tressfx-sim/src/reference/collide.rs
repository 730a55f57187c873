//! `hair.sim.collide` in f64.

use glam::{DVec3, DVec4};
use tressfx_core::shape::Capsule;

use super::Guide;
use super::roots::RootMotion;
use super::vector::{DOWN, across, direction_or, rotate_back};
use crate::collider::CapsuleMotion;
use crate::step::Step;

const ROUNDS: u32 = 5;
const LIMIT_PER_ROUND: f64 = 0.25;
const INSIDE: f64 = 0.999999;
const MIN_TURN: f64 = 1e-5;
const TURN_LIMIT: f64 = 4.0;
const MIN_SINE_AFTER_TURN: f64 = 1.0 / TURN_LIMIT;
const MIN_DISTANCE_FROM_LINE: f64 = 1e-7;

/// Turns vertices that are inside a capsule out about their parents, and lets what hangs on them follow.
pub fn collide(step: &Step, guide: &mut Guide, capsules: &[(Capsule, CapsuleMotion)]) {
    let root = guide.root(step);
    let mut moved = false;
    let mut old_parent = guide.positions[0];
    for i in 1..guide.vertices() {
        let edge = rotate_back(step.head_rotation.as_dvec4(), guide.positions[i] - old_parent);
        old_parent = guide.positions[i];
        if guide.is_pinned(i) {
            moved = false;
            continue;
        }
        let parent = guide.positions[i - 1];
        let length = f64::from(guide.rest_lengths[i - 1]);
        if moved {
            guide.positions[i] = parent + length * direction_or(guide.positions[i] - parent, DOWN);
        }
        let start = step.in_head(guide.positions[i]);
        let displacement = start - step.in_head(guide.previous[i]);
        let vertex = Vertex { parent: step.in_head(parent), start, length, edge, displacement };
        if let Some((point, displacement)) = resolved(step, &root, capsules, &vertex) {
            guide.previous[i] = step.in_world(point - displacement);
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
    /// The edge before anything moved.
    edge: DVec3,
    /// Its displacement from its previous position.
    displacement: DVec3,
}

/// Where a vertex is when it has left all capsules, and its displacement less what contacts and friction have removed; `None` if
/// it was outside.
fn resolved(
    step: &Step,
    root: &RootMotion,
    capsules: &[(Capsule, CapsuleMotion)],
    vertex: &Vertex,
) -> Option<(DVec3, DVec3)> {
    let (mut point, mut displacement, mut unused_share) = (vertex.start, vertex.displacement, 1.0);
    let mut heading = direction_or(vertex.edge, DOWN);
    let mut touched = false;
    for _ in 0..ROUNDS {
        let mut moved_distance = 0.0;
        for (capsule, motion) in capsules {
            let (center, radius) = nearest(capsule, point);
            if point.distance_squared(center) < INSIDE * radius * radius {
                let before = direction_or(point - vertex.parent, DOWN);
                let apart = vertex.length * before.distance(heading);
                let weight = (TURN_LIMIT * (radius - point.distance(center)) / apart.max(1e-12)).min(1.0);
                let aim = before.lerp(heading, weight);
                let (turned, used_share) = turned_out(vertex.parent, aim, vertex.length, center, radius, unused_share);
                let pushed = turned - point;
                let normal = direction_or(turned - center, DVec3::ZERO);
                let surface = surface_displacement(step, root, motion, point);
                let depth = pushed.dot(normal).max(0.0);
                displacement = surface + slid(displacement + pushed - surface, normal, depth, f64::from(step.friction));
                point = turned;
                unused_share *= 1.0 - used_share;
                heading = heading.lerp(direction_or(point - vertex.parent, DOWN), weight);
                touched = true;
                moved_distance += pushed.length();
            }
        }
        if moved_distance <= MIN_TURN * vertex.length {
            break;
        }
        unused_share *= LIMIT_PER_ROUND;
    }
    touched.then_some((point, displacement))
}

/// The displacement of a capsule's surface at a point, without the share of the root's motion that the velocity shock has added
/// to the point's past.
fn surface_displacement(step: &Step, root: &RootMotion, motion: &CapsuleMotion, point: DVec3) -> DVec3 {
    let here = step.in_world(point);
    let own = point - rotate_back(DVec4::from(motion.rotation.as_dquat()), point - motion.translation.as_dvec3());
    let with_head = here - step.carried_from(here);
    let with_root = here - root.carried_from(here) + step.center_displacement.as_dvec3();
    own + step.in_head(with_head - f64::from(step.shock) * with_root)
}

fn nearest(capsule: &Capsule, point: DVec3) -> (DVec3, f64) {
    let (a, b) = (capsule.a.as_dvec3(), capsule.b.as_dvec3());
    let (radius_a, radius_b) = (f64::from(capsule.radius_a), f64::from(capsule.radius_b));
    let axis = b - a;
    let squared = axis.length_squared();
    let t = if squared > 0.0 { ((point - a).dot(axis) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (a + t * axis, radius_a + t * (radius_b - radius_a))
}

/// The vertex turned about its parent, onto the sphere or as far as the unused share of the limit allows, and the share of the
/// limit that was used.
fn turned_out(parent: DVec3, aim: DVec3, length: f64, center: DVec3, radius: f64, unused_share: f64) -> (DVec3, f64) {
    let from_center = parent - center;
    let distance = from_center.length();
    let outwards = direction_or(from_center, DVec3::Y);
    let before = direction_or(aim, outwards);
    let old_cosine = before.dot(outwards);
    let across_outwards = before - old_cosine * outwards;
    let old_sine = across_outwards.length();
    let gap = distance + length - radius;
    let product = gap * (distance + length + radius) * (radius - distance + length) * (radius + distance - length);
    let twice = (2.0 * distance * length).max(1e-24);
    let mut cosine = ((radius - distance) * (radius + distance) - length * length) / twice;
    let mut sine = product.max(0.0).sqrt() / twice;
    let straightest = (1.0 - MIN_SINE_AFTER_TURN * MIN_SINE_AFTER_TURN).sqrt();
    if cosine > straightest.max(old_cosine) {
        (cosine, sine) =
            if old_cosine > straightest { (old_cosine, old_sine) } else { (straightest, MIN_SINE_AFTER_TURN) };
    }
    let turn = (old_sine * cosine - old_cosine * sine) / (1.0 + old_cosine * cosine + old_sine * sine).max(1e-12);
    let share_of_length = distance / length.max(1e-12);
    let from_line = if turn > 0.0 { old_sine.max(MIN_DISTANCE_FROM_LINE * share_of_length) } else { sine * sine };
    let limit = 0.5 * TURN_LIMIT * from_line.max(1e-12);
    let bound = unused_share * limit.min(0.5 * TURN_LIMIT * (cosine - old_cosine).abs().min(share_of_length));
    if turn.abs() > bound {
        let (cos, sin) =
            ((1.0 - bound * bound) / (1.0 + bound * bound), turn.signum() * 2.0 * bound / (1.0 + bound * bound));
        (cosine, sine) = (old_cosine * cos + old_sine * sin, old_sine * cos - old_cosine * sin);
    }
    let sideways = direction_or(across_outwards, across(outwards));
    (parent + length * (cosine * outwards + sine * sideways), (turn.abs().min(bound) / limit).min(1.0))
}

/// What friction leaves of a displacement along a surface.
fn slid(displacement: DVec3, normal: DVec3, depth: f64, friction: f64) -> DVec3 {
    let along_normal = displacement.dot(normal);
    let slide = displacement - along_normal * normal;
    let lost = (friction * depth).min(slide.length());
    let pushed = depth.min(along_normal.max(0.0));
    displacement - lost * direction_or(slide, DVec3::ZERO) - pushed * normal
}
