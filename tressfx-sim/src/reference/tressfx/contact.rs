//! Contact with capsules and fields: `shaders/contact.wgsl` and `shaders/field_contact.wgsl`.

use glam::{DVec3, DVec4};
use tressfx_core::shape::Capsule;

use crate::collider::CapsuleMotion;
use crate::reference::Guide;
use crate::reference::field::PlacedField;
use crate::reference::roots::RootMotion;
use crate::reference::vector::{direction_or, rotate_back};
use crate::step::Step;

/// How often a point is pushed out of a field.
const PUSHES: usize = 3;

/// Every vertex that is inside of a capsule is pushed straight out of it, one capsule after the other, and slides on it with friction. Then every vertex that is inside of a
/// field, or has touched it on its way, is held beside it.
pub(super) fn contacts(
    step: &Step,
    guide: &mut Guide,
    root: &RootMotion,
    capsules: &[(Capsule, CapsuleMotion)],
    fields: &[PlacedField],
) {
    for i in (0..guide.vertices()).filter(|&i| guide.rest[i].w > 0.0) {
        let mut point = step.in_head(guide.positions[i]);
        let mut displacement = point - step.in_head(guide.previous[i]);
        let mut touched = false;
        for (capsule, motion) in capsules {
            let (center, radius) = nearest(capsule, point);
            if point.distance_squared(center) < radius * radius {
                let normal = direction_or(point - center, DVec3::Y);
                let push = center + radius * normal - point;
                let surface = surface_displacement(step, root, motion, point);
                let depth = push.dot(normal).max(0.0);
                displacement = surface + slid(displacement + push - surface, normal, depth, step.friction.into());
                point += push;
                touched = true;
            }
        }
        for field in fields {
            let surface = surface_displacement(step, root, &field.motion, point);
            let push = beside(field, point, displacement - surface);
            let size = push.length();
            if size > 0.0 {
                displacement = surface + slid(displacement + push - surface, push / size, size, step.friction.into());
                point += push;
                touched = true;
            }
        }
        if touched {
            guide.positions[i] = step.in_world(point);
            guide.previous[i] = step.in_world(point - displacement);
        }
    }
}

/// By what a point is pushed that has gone along `way`, as the field sees it, to where it is. It is held where it touches first and goes on along the surface; then it
/// is pushed out where it is.
fn beside(field: &PlacedField, point: DVec3, way: DVec3) -> DVec3 {
    let (mut distance, mut normal) = field.sample(point);
    if distance >= way.length() {
        return DVec3::ZERO;
    }
    let mut at = point;
    if let Some((share, _, surface)) = field.first_touch(point, way) {
        at -= ((1.0 - share) * way.dot(surface)).min(0.0) * surface;
        (distance, normal) = field.sample(at);
    }
    for _ in 0..PUSHES {
        if distance < 0.0 {
            at -= distance * normal;
            (distance, normal) = field.sample(at);
        }
    }
    at - point
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

/// The point of the axis that is nearest, and the radius there.
fn nearest(capsule: &Capsule, point: DVec3) -> (DVec3, f64) {
    let (a, b) = (capsule.a.as_dvec3(), capsule.b.as_dvec3());
    let (radius_a, radius_b) = (f64::from(capsule.radius_a), f64::from(capsule.radius_b));
    let axis = b - a;
    let squared = axis.length_squared();
    let t = if squared > 0.0 { ((point - a).dot(axis) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (a + t * axis, radius_a + t * (radius_b - radius_a))
}

/// What Coulomb friction leaves of a displacement along a surface (Macklin et al. 2014).
fn slid(displacement: DVec3, normal: DVec3, depth: f64, friction: f64) -> DVec3 {
    let along_normal = displacement.dot(normal);
    let slide = displacement - along_normal * normal;
    let lost = (friction * depth).min(slide.length());
    let pushed = depth.min(along_normal.max(0.0));
    displacement - lost * direction_or(slide, DVec3::ZERO) - pushed * normal
}
