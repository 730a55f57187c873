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

    /// The rotation as it is nearer to that of another root, of the two signs that a quaternion may have.
    fn turn_near(&self, other: &Self) -> DVec4 {
        let near = self.rotation.dot(other.rotation) >= 0.0;
        DVec4::from(if near { self.rotation } else { -self.rotation })
    }
}

/// Where a root goes in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootWay {
    /// At the end of the frame.
    pub end: RootPlace,
    /// At its start, and at the starts of the last frame and of the one before it.
    pub before: [RootPlace; 3],
}

impl RootWay {
    /// A root that has always been with the head.
    pub const WITH_HEAD: Self = Self { end: RootPlace::WITH_HEAD, before: [RootPlace::WITH_HEAD; 3] };

    /// The next frame begins.
    pub(super) fn end_frame(&mut self) {
        self.before = [self.end, self.before[0], self.before[1]];
    }

    /// Where it is at the end of a sub-step.
    fn at(&self, step: &Step) -> RootPlace {
        let Self { end, before: [start, last, earlier] } = self;
        if step.root_share >= 1.0 || start == end {
            return *end;
        }
        let [end_turn, last_turn, earlier_turn] = [end, last, earlier].map(|root| root.turn_near(start));
        let turn = bent(step, start.rotation.into(), [end_turn, last_turn, earlier_turn], TURN_SLACK);
        let wide = |root: &RootPlace| root.place.extend(0.0);
        let place = bent(step, wide(start), [end, last, earlier].map(wide), step.root_slack.into());
        RootPlace { rotation: DQuat::from_vec4(turn.normalize()), place: place.truncate() }
    }
}

/// The farthest that the curve may lead from the straight line between two unit quaternions.
const TURN_SLACK: f64 = 0.25;

/// A point on the curve from `start` to the first of the others.
fn bent(step: &Step, start: DVec4, others: [DVec4; 3], slack: f64) -> DVec4 {
    let bend = step.root_bend.as_dvec3().to_array();
    let away: DVec4 = others.iter().zip(bend).map(|(&other, bend)| bend * (other - start)).sum();
    start.lerp(others[0], step.root_share.into()) + away.clamp_length_max(slack)
}

/// A root goes on to where it is at the end of the sub-step.
pub fn roots(step: &Step, way: &RootWay, root: &mut GuideRoot) {
    let here = way.at(step);
    let head = step.head_rotation.as_dvec4();
    let rotation = DQuat::from_vec4(head) * here.rotation;
    let now = RootPlace { rotation, place: rotate(head, here.place) };
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
