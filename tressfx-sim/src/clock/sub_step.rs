//! What a frame is cut into.

use glam::{Quat, Vec3};
use tressfx_core::view::Pose;

/// One sub-step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubStep {
    /// Its length, s.
    pub length: f64,
    /// Length of this one over that of the one before: 1, but for the first one after a change of [`ClockParams`].
    pub length_ratio: f64,
    /// Simulated time at its end, s.
    pub time: f64,
    /// The rotation of the head at its end.
    pub rotation: Quat,
    /// The rotation of the head during it; the identity exactly if it has not turned.
    pub turn: Quat,
    /// The way of the groom's centre during it, units of the file; 0 exactly if the head has not moved.
    pub shift: Vec3,
    /// The acceleration of the head in this frame, the largest within the groom's bounds, units of the file / s^2.
    pub acceleration: f32,
    /// The head at its beginning and at its end.
    pub heads: [Pose; 2],
    /// Its beginning and its end, as shares of the simulated part of the frame. The first may begin before the frame, at less
    /// than 0.
    pub shares: [f64; 2],
    /// Of the time from its beginning to the end of the frame, the share that it takes.
    pub share_of_rest: f64,
}

impl SubStep {
    /// A sub-step of a head that is turned so and does not move.
    pub fn at_rest(length: f64, rotation: Quat) -> Self {
        let head = Pose { rotation, translation: Vec3::ZERO };
        Self {
            length,
            length_ratio: 1.0,
            time: 0.0,
            rotation,
            turn: Quat::IDENTITY,
            shift: Vec3::ZERO,
            acceleration: 0.0,
            heads: [head; 2],
            shares: [0.0, 1.0],
            share_of_rest: 1.0,
        }
    }

    /// Whether the head stays where it is.
    pub fn is_still(&self) -> bool {
        self.turn == Quat::IDENTITY && self.shift == Vec3::ZERO
    }
}

/// What one frame is cut into.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FramePlan {
    /// The strands go to rest on a head that is turned so, before the sub-steps.
    pub reset: Option<Quat>,
    /// Whether that is because of a teleport.
    pub teleported: bool,
    /// What is simulated, in order.
    pub sub_steps: Vec<SubStep>,
    /// Time that was dropped because the frame was too long, s.
    pub dropped: f64,
}
