//! The sub-steps of a frame.

use glam::{DVec3, Quat, Vec3};
use tressfx_core::view::Pose;

/// One sub-step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubStep {
    /// Its length, s.
    pub length: f64,
    /// Its length divided by that of the sub-step before. It is 1 except after a change of [`ClockParams`](crate::ClockParams).
    pub length_ratio: f64,
    /// Simulated time at its end, s.
    pub time: f64,
    /// The rotation of the head at its end.
    pub head_rotation: Quat,
    /// The rotation that the head makes during it; exactly the identity if the head does not turn.
    pub head_turn: Quat,
    /// The displacement of the groom's centre during it, in units of the file; exactly 0 if the head does not move.
    pub center_displacement: Vec3,
    /// The acceleration of the head in this frame, the largest within the groom's bounds, units of the file / s^2.
    pub head_acceleration: f32,
    /// The head at its beginning and at its end.
    pub heads: [Pose; 2],
    /// Its beginning and its end, as shares of the simulated part of the frame. The first sub-step may begin before the
    /// frame: its first share is then less than 0.
    pub shares: [f64; 2],
    /// Where roots that move by themselves are at its end.
    pub roots: RootPath,
}

/// How far roots have come on their ways, which lead through where they are at the ends of this frame and of the two before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootPath {
    /// The share of the frame that has passed, 0 to 1.
    pub share: f64,
    /// How far they are away from the straight line: that much of the way from the start of the frame to its end, to the start of the last
    /// frame, and to that of the one before it.
    pub bend: DVec3,
    /// Length of the frame, s.
    pub frame: f64,
}

impl RootPath {
    /// At the end of a frame.
    pub const END: Self = Self { share: 1.0, bend: DVec3::ZERO, frame: 0.0 };
}

impl SubStep {
    /// A sub-step in which the head has this rotation and does not move.
    pub fn at_rest(length: f64, rotation: Quat) -> Self {
        let head = Pose { rotation, translation: Vec3::ZERO };
        Self {
            length,
            length_ratio: 1.0,
            time: 0.0,
            head_rotation: rotation,
            head_turn: Quat::IDENTITY,
            center_displacement: Vec3::ZERO,
            head_acceleration: 0.0,
            heads: [head; 2],
            shares: [0.0, 1.0],
            roots: RootPath::END,
        }
    }
}

/// The sub-steps of one frame, and what happens before them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FramePlan {
    /// Before the sub-steps the strands are reset to the rest pose, on a head with this rotation.
    pub reset: Option<Quat>,
    /// Whether that is because of a teleport.
    pub teleported: bool,
    /// What is simulated, in order.
    pub sub_steps: Vec<SubStep>,
    /// Time that was dropped because the frame was too long, s.
    pub dropped: f64,
}
