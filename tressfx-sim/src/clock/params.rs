//! How frames are divided into sub-steps.

use serde::{Deserialize, Serialize};

use crate::params::{ParamError, within};

/// How frames are divided into sub-steps, and what counts as a teleport. These are the same for all sections of a groom.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ClockParams {
    /// Seconds: the length of a sub-step.
    pub sub_step: f64,
    /// Seconds: the most time that one frame simulates; the rest is dropped, and reported.
    pub max_frame: f64,
    /// Radii of the groom: a head that moves further than this in one frame has teleported.
    pub teleport_distance: f32,
    /// Radians: a head that turns further than this in one frame has teleported. With pi or more a turn is never a teleport.
    pub teleport_angle: f32,
}

impl Default for ClockParams {
    fn default() -> Self {
        Self { sub_step: 1.0 / 120.0, max_frame: 0.1, teleport_distance: 10.0, teleport_angle: 2.0 }
    }
}

impl ClockParams {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn validate(&self) -> Result<(), ParamError> {
        within("sub_step", self.sub_step, 1e-5..=0.1)?;
        within("max_frame", self.max_frame, self.sub_step..=10.0)?;
        within("teleport_distance", self.teleport_distance, 0.0..=f32::MAX)?;
        within("teleport_angle", self.teleport_angle, 0.0..=f32::MAX)
    }
}
