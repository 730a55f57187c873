//! `hair.sim.roots` in f64, and how a root moves.

use glam::{DQuat, DVec3, DVec4};

use super::vector::{rotate, rotate_back};
use crate::buffers::RootTransform;
use crate::step::Step;

/// Where a root is within the space of the rest pose, relative to the centre of the groom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootPlace {
    /// Points are turned,
    pub rotation: DQuat,
    /// then moved.
    pub place: DVec3,
}

/// A root with the head: now and one sub-step ago.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideRoot {
    /// At the end of the sub-step, relative to the centre, on the axes of the world.
    pub now: RootPlace,
    /// One sub-step ago, relative to the centre of then.
    pub last: RootPlace,
}

impl From<RootTransform> for RootPlace {
    fn from(RootTransform { rotation, place }: RootTransform) -> Self {
        Self { rotation: DQuat::from_vec4(rotation.as_dvec4()), place: place.truncate().as_dvec3() }
    }
}

impl RootPlace {
    /// A root that rides on the head.
    pub const WITH_HEAD: Self = Self { rotation: DQuat::IDENTITY, place: DVec3::ZERO };

    /// The transform at a share of the distance to another.
    fn towards(&self, other: &Self, share: f64) -> Self {
        let near = if self.rotation.dot(other.rotation) < 0.0 { -other.rotation } else { other.rotation };
        let rotation = DVec4::from(self.rotation).lerp(near.into(), share).normalize();
        Self { rotation: DQuat::from_vec4(rotation), place: self.place.lerp(other.place, share) }
    }
}

/// A root goes on to where it is at the end of the frame. `reached` is where it was at the end of the last sub-step.
pub fn roots(step: &Step, target: &RootPlace, reached: &mut RootPlace, root: &mut GuideRoot) {
    *reached = reached.towards(target, step.root_share.into());
    let head = step.head_rotation.as_dvec4();
    let rotation = DQuat::from_vec4(head) * reached.rotation;
    let now = RootPlace { rotation, place: rotate(head, reached.place) };
    *root = GuideRoot { now, last: if step.reset == 0 { root.now } else { now } };
}

/// The motion of a root during a sub-step.
pub(super) struct RootMotion {
    /// From the axes of the rest pose to those of the world, at the end.
    pub(super) rotation: DVec4,
    turn: DVec4,
    place: DVec3,
    last_place: DVec3,
}

impl RootMotion {
    /// That of the head where the root has none of its own.
    pub(super) fn new(step: &Step, root: Option<&GuideRoot>) -> Self {
        let (rotation, turn) = (step.head_rotation.as_dvec4(), step.head_turn.as_dvec4());
        let with_head = Self { rotation, turn, place: DVec3::ZERO, last_place: DVec3::ZERO };
        root.map_or(with_head, |GuideRoot { now, last }| Self {
            rotation: now.rotation.into(),
            turn: (now.rotation * last.rotation.conjugate()).into(),
            place: now.place,
            last_place: last.place,
        })
    }

    /// Where the root takes a point of the rest pose.
    pub(super) fn shape(&self, rest: DVec3) -> DVec3 {
        rotate(self.rotation, rest) + self.place
    }

    /// Where the root's motion takes a point relative to the centre of the last sub-step.
    pub(super) fn carried(&self, last: DVec3) -> DVec3 {
        rotate(self.turn, last - self.last_place) + self.place
    }

    /// The point that [`RootMotion::carried`] takes here.
    pub(super) fn carried_from(&self, here: DVec3) -> DVec3 {
        rotate_back(self.turn, here - self.place) + self.last_place
    }
}
