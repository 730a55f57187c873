//! A guide of a groom as a rod.

use glam::{DQuat, DVec3};

use super::{Rod, RodRest, RodStep, TipHold, direct};
use crate::reference::Guide;
use crate::reference::roots::RootMotion;
use crate::reference::vector::position;
use crate::reference::wind::wind_of;
use crate::step::Step;

impl RodStep {
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
            rounds: step.rounds,
        }
    }
}

/// What the kernel does to a guide, [`direct`] or the reset, and its positions. `strand` is the index of the guide. Says whether
/// it had become non-finite.
pub fn direct_guide(step: &Step, guide: &mut Guide, rest: &RodRest, rod: &mut Rod, strand: u32) -> bool {
    let root = guide.root(step);
    let of_guide = RodStep::of_guide(step, guide, &root, strand);
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
    let first: DVec3 = root.shape(position(guide.rest[0]));
    for (place, from_root) in guide.positions.iter_mut().zip(&rod.positions) {
        *place = first + *from_root;
    }
    !finite
}
