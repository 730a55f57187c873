//! A guide of a groom as a rod.

use glam::{DQuat, DVec3};
use tressfx_core::shape::Capsule;

use super::{FieldObstacle, Obstacle, Rod, RodRest, RodStep, TipHold, direct};
use crate::collider::CapsuleMotion;
use crate::reference::Guide;
use crate::reference::field::PlacedField;
use crate::reference::roots::RootMotion;
use crate::reference::vector::position;
use crate::reference::wind::wind_of;
use crate::step::Step;

impl Obstacle {
    /// A capsule as the rod of a guide meets it; the capsule and its motion are in the space of the head.
    fn of_guide(step: &Step, root: DVec3, capsule: &Capsule, motion: &CapsuleMotion) -> Self {
        let head = DQuat::from_vec4(step.head_rotation.as_dvec4());
        let (rotation, translation) = motion_from(step, root, motion);
        let ends = [capsule.a, capsule.b].map(|end| head * end.as_dvec3() - root);
        Self { ends, radii: [capsule.radius_a.into(), capsule.radius_b.into()], rotation, translation }
    }
}

impl<'a> FieldObstacle<'a> {
    /// A field as the rod of a guide meets it; the field and its motion are in the space of the head.
    fn of_guide(step: &Step, root: DVec3, field: &PlacedField<'a>) -> Self {
        let head = DQuat::from_vec4(step.head_rotation.as_dvec4());
        let (rotation, translation) = motion_from(step, root, &field.motion);
        let placed =
            PlacedField { rotation: head * field.rotation, translation: head * field.translation - root, ..*field };
        Self { placed, rotation, translation }
    }
}

/// How points that move with a collider move in a sub-step, from the root, on the axes of the world: they are turned, then moved.
fn motion_from(step: &Step, root: DVec3, motion: &CapsuleMotion) -> (DQuat, DVec3) {
    let head = DQuat::from_vec4(step.head_rotation.as_dvec4());
    let turn = DQuat::from_vec4(step.head_turn.as_dvec4());
    let rotation = head * motion.rotation.as_dquat() * head.inverse() * turn;
    let before = root + step.center_displacement.as_dvec3();
    (rotation, rotation * before + head * motion.translation.as_dvec3() - root)
}

impl<'a> RodStep<'a> {
    /// The sub-step as the rod of a guide feels it. `strand` is the index of the guide: its wind depends on it.
    fn of_guide(step: &Step, guide: &Guide, root: &RootMotion, strand: u32) -> Self {
        let length = f64::from(step.length);
        let (first, tip) = (position(guide.rest[0]), guide.vertices() - 1);
        let rotation = DQuat::from_vec4(root.rotation);
        let place = rotation * (position(guide.rest[tip]) - first);
        Self {
            length,
            gravity: step.gravity.as_dvec3() / (length * length),
            wind: wind_of(step, strand),
            drag: [step.drag_across.into(), step.drag_along.into()],
            pull: step.pull.into(),
            bending: step.bending.into(),
            twist_ratio: step.twist_ratio.into(),
            damping: step.internal_damping.into(),
            root: rotation,
            root_displacement: root.shape(first) - guide.positions[0] + step.center_displacement.as_dvec3(),
            tip: guide.is_pinned(tip).then_some(TipHold { place, frame: None }),
            obstacles: &[],
            fields: &[],
            friction: step.friction.into(),
            rounds: step.rounds,
        }
    }
}

/// What the kernel does to a guide, [`direct`] or the reset, and its positions. `strand` is the index of the guide. Says whether
/// it had become non-finite. `capsules` and `fields` are in the space of the head, relative to the centre of the groom, as
/// [`Step::head_rotation`] has them at the end of the sub-step.
pub fn direct_guide(
    step: &Step,
    guide: &mut Guide,
    rest: &RodRest,
    rod: &mut Rod,
    strand: u32,
    capsules: &[(Capsule, CapsuleMotion)],
    fields: &[PlacedField],
) -> bool {
    let root = guide.root(step);
    let first: DVec3 = root.shape(position(guide.rest[0]));
    let obstacles: Vec<_> =
        capsules.iter().map(|(capsule, motion)| Obstacle::of_guide(step, first, capsule, motion)).collect();
    let fields: Vec<_> = fields.iter().map(|field| FieldObstacle::of_guide(step, first, field)).collect();
    let of_guide = RodStep { obstacles: &obstacles, fields: &fields, ..RodStep::of_guide(step, guide, &root, strand) };
    if step.reset != 0 {
        *rod = Rod::at_rest(rest, of_guide.root);
    } else {
        rod.has_past &= step.first_order == 0;
        direct(&of_guide, rest, rod);
    }
    let finite = rod.positions.iter().all(|place| place.is_finite());
    if !finite {
        *rod = Rod::at_rest(rest, of_guide.root);
    }
    for (place, from_root) in guide.positions.iter_mut().zip(&rod.positions) {
        *place = first + *from_root;
    }
    !finite
}
