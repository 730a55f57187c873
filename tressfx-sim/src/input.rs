//! What one frame is given.

use glam::Quat;
use tressfx_core::view::Pose;

use crate::collider::Collider;
use crate::error::SimError;
use crate::wind::Wind;

/// How far the length of a quaternion may be from 1 for it to be a rotation.
const UNIT: f32 = 1e-3;

/// What one frame is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInput<'a> {
    /// Seconds since the last frame; 0 or less simulates nothing.
    pub dt: f64,
    /// Where the head is at the end of the frame: from the space of the rest pose to the world, in the unit of the file.
    pub head: Pose,
    /// Where it was before, at even distances in time within the frame: with 60 of all poses a second strands move the same at any frame rate
    /// below that. Without any, the head goes along the cubic curve through its poses at the ends of this frame and of the two before it.
    /// Not looked at in a frame that is longer than [`ClockParams::max_frame`](crate::ClockParams::max_frame).
    pub path: &'a [Pose],
    /// The wind, if any.
    pub wind: Option<Wind>,
    /// What the strands collide with in this frame; no more than the simulation was made for.
    pub colliders: &'a [Collider<'a>],
}

impl<'a> StepInput<'a> {
    /// A frame without wind and colliders.
    pub fn new(dt: f64, head: Pose) -> Self {
        Self { dt, head, path: &[], wind: None, colliders: &[] }
    }

    /// The same with a head that is known within the frame too.
    #[must_use]
    pub fn with_path(self, path: &'a [Pose]) -> Self {
        Self { path, ..self }
    }

    /// The same in a wind.
    #[must_use]
    pub fn with_wind(self, wind: Wind) -> Self {
        Self { wind: Some(wind), ..self }
    }

    /// The same with colliders.
    #[must_use]
    pub fn with_colliders(self, colliders: &'a [Collider<'a>]) -> Self {
        Self { colliders, ..self }
    }

    /// Checks it.
    ///
    /// # Errors
    /// What is not finite, a rotation that is none, and what is wrong with the wind or with a collider.
    pub fn validate(&self) -> Result<(), SimError> {
        if !self.dt.is_finite() {
            return Err(SimError::NonFinite { name: "dt" });
        }
        for pose in self.path.iter().chain([&self.head]) {
            check_pose(pose, "head.rotation", "head.translation")?;
        }
        self.wind.iter().try_for_each(Wind::validate)?;
        self.colliders.iter().enumerate().try_for_each(|(index, collider)| collider.validate(index))
    }
}

/// Refuses a pose that is not finite, or whose quaternion is no rotation.
pub(crate) fn check_pose(pose: &Pose, rotation: &'static str, translation: &'static str) -> Result<(), SimError> {
    if !pose.rotation.is_finite() {
        return Err(SimError::NonFinite { name: rotation });
    }
    if !is_rotation(pose.rotation) {
        return Err(SimError::NoRotation { name: rotation, length: pose.rotation.length() });
    }
    if pose.translation.is_finite() { Ok(()) } else { Err(SimError::NonFinite { name: translation }) }
}

fn is_rotation(quaternion: Quat) -> bool {
    (quaternion.length() - 1.0).abs() <= UNIT
}
