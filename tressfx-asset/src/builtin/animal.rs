//! A small animal with four legs and a tail, made of capsules: where its fur grows, and where it flows.

use std::f32::consts::TAU;

use glam::Vec3;
use tressfx_core::shape::Capsule;

use super::roots::Root;

/// Parts that are within this of a point share in the flow and the length of its fur, in metres.
const BLEND: f32 = 0.025;

/// A part of the body. Fur flows from its end `a` to its end `b`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) solid: Capsule,
    /// Length of the fur, as a multiple of the style's.
    pub(super) fur: f32,
}

/// All parts, in metres: the nose towards +z, the feet at a height of 0.
pub(super) fn parts() -> Vec<Part> {
    let part = |a: [f32; 3], b: [f32; 3], [radius_a, radius_b]: [f32; 2], fur| Part {
        solid: Capsule { a: a.into(), b: b.into(), radius_a, radius_b },
        fur,
    };
    let mut parts = vec![
        // Nose, skull, neck, chest, belly, hips, tail.
        part([0.0, 0.424, 0.395], [0.0, 0.438, 0.335], [0.017, 0.03], 0.12),
        part([0.0, 0.448, 0.325], [0.0, 0.462, 0.285], [0.045, 0.054], 0.32),
        part([0.0, 0.44, 0.275], [0.0, 0.335, 0.17], [0.05, 0.07], 1.1),
        part([0.0, 0.31, 0.16], [0.0, 0.305, 0.05], [0.088, 0.085], 1.15),
        part([0.0, 0.305, 0.05], [0.0, 0.315, -0.08], [0.085, 0.072], 0.95),
        part([0.0, 0.315, -0.08], [0.0, 0.305, -0.2], [0.072, 0.078], 0.9),
        part([0.0, 0.325, -0.255], [0.0, 0.29, -0.36], [0.022, 0.028], 1.3),
        part([0.0, 0.29, -0.36], [0.0, 0.2, -0.46], [0.028, 0.026], 1.7),
        part([0.0, 0.2, -0.46], [0.0, 0.15, -0.56], [0.026, 0.008], 1.4),
    ];
    for side in [-1.0, 1.0] {
        let at = |x: f32, y, z| [side * x, y, z];
        parts.extend([
            // Cheek and ear.
            part(at(0.012, 0.44, 0.315), at(0.034, 0.436, 0.272), [0.034, 0.036], 0.6),
            part(at(0.034, 0.5, 0.275), at(0.05, 0.562, 0.262), [0.022, 0.005], 0.3),
            // Foreleg and paw.
            part(at(0.05, 0.27, 0.13), at(0.056, 0.15, 0.145), [0.046, 0.027], 0.75),
            part(at(0.056, 0.15, 0.145), at(0.056, 0.035, 0.15), [0.026, 0.019], 0.35),
            part(at(0.056, 0.024, 0.15), at(0.056, 0.016, 0.183), [0.022, 0.015], 0.16),
            // Thigh, shank, hock and paw.
            part(at(0.05, 0.285, -0.19), at(0.06, 0.175, -0.15), [0.066, 0.038], 0.85),
            part(at(0.06, 0.175, -0.15), at(0.06, 0.105, -0.215), [0.036, 0.022], 0.6),
            part(at(0.06, 0.105, -0.215), at(0.06, 0.032, -0.2), [0.021, 0.018], 0.3),
            part(at(0.06, 0.023, -0.2), at(0.06, 0.016, -0.163), [0.021, 0.015], 0.16),
        ]);
    }
    parts
}

/// The root at a place of the skin, both of its numbers from 0 to 1, even in area; none where that is inside of another part.
pub(super) fn root(parts: &[Part], place: [f32; 2]) -> Option<Root> {
    let areas = || parts.iter().map(|part| areas(&part.solid).iter().sum::<f32>());
    let mut left = place[0] * areas().sum::<f32>();
    let index = areas().position(|area| {
        let is_here = left < area;
        left -= if is_here { 0.0 } else { area };
        is_here
    });
    let index = index.unwrap_or(parts.len() - 1);
    let (position, normal) = on_skin(&parts[index].solid, left, TAU * place[1]);
    let is_inside = |(other, part): (usize, &Part)| other != index && part.solid.distance(position) < 0.0;
    if parts.iter().enumerate().any(is_inside) {
        return None;
    }
    let (flow, length) = fur_at(parts, position);
    Some(Root { position, normal, direction: normal, flow: Some(flow), length })
}

/// Areas of a capsule: of the half-sphere at `a`, of the side, and of the half-sphere at `b`.
fn areas(solid: &Capsule) -> [f32; 3] {
    let Capsule { a, b, radius_a, radius_b } = *solid;
    [TAU * radius_a * radius_a, TAU * 0.5 * (radius_a + radius_b) * a.distance(b), TAU * radius_b * radius_b]
}

/// The point of a capsule up to which there is so much area from the pole at `a` on, at an angle around its axis, and the normal there.
fn on_skin(solid: &Capsule, area: f32, angle: f32) -> (Vec3, Vec3) {
    let Capsule { a, b, radius_a, radius_b } = *solid;
    let [first, side, last] = areas(solid);
    let axis = (b - a).normalize_or(Vec3::Y);
    let (u, v) = axis.any_orthonormal_pair();
    let around = u * angle.cos() + v * angle.sin();
    // On a sphere the area grows evenly along the axis.
    let on_sphere = |center: Vec3, radius: f32, along: f32| {
        let normal = axis * along + around * (1.0 - along * along).max(0.0).sqrt();
        (center + normal * radius, normal)
    };
    if area < first {
        return on_sphere(a, radius_a, area / first - 1.0);
    }
    if area >= first + side {
        return on_sphere(b, radius_b, ((area - first - side) / last).min(1.0));
    }
    // The radius changes evenly along the axis, so the area up to `t` is a square.
    let (share, change) = ((area - first) / side, radius_b - radius_a);
    let sum = radius_a + radius_b;
    let t = share * sum / (radius_a + (radius_a * radius_a + change * sum * share).max(0.0).sqrt());
    (a.lerp(b, t) + around * (radius_a + change * t), around)
}

/// Where fur flows at a point, and its length: from the parts around it, the nearest ones most.
fn fur_at(parts: &[Part], point: Vec3) -> (Vec3, f32) {
    let weight = |part: &Part| (-part.solid.distance(point).max(0.0) / BLEND).exp();
    let total: f32 = parts.iter().map(weight).sum();
    let flow = parts.iter().map(|part| (part.solid.b - part.solid.a).normalize_or_zero() * weight(part)).sum();
    (flow, parts.iter().map(|part| part.fur * weight(part)).sum::<f32>() / total)
}
