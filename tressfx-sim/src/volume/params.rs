//! Parameters of hair against hair.

use serde::{Deserialize, Serialize};

use crate::params::{ParamError, within};

/// How hair keeps its volume and rubs against hair; one for all sections of a groom.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VolumeParams {
    /// Cells along the longest side of the grid, 4 to 128. It holds the box that strands can reach from their roots, and what leaves it is not pushed.
    pub cells: u32,
    /// Hair that has left its place may become as dense as the mean of the rest pose times this before it is pushed, from 0.05 to 100. Where the rest
    /// pose is denser, it may be as dense as there. The mean is that which hair has around itself, not that of space.
    pub rest_density: f32,
    /// How stiffly hair resists being denser: the speed, m/s, at which compression spreads, 0 to 100. Hair that is twice as dense on one side of a
    /// metre as on the other is accelerated by its square. At most half a cell is gone through in a sub-step: a higher speed counts as that.
    pub sound_speed: f32,
    /// The rate, 1/s, at which hair takes on the mean velocity of the hair around it, 0 to 1000.
    pub friction: f32,
}

impl Default for VolumeParams {
    fn default() -> Self {
        Self { cells: 48, rest_density: 1.0, sound_speed: 1.0, friction: 5.0 }
    }
}

impl VolumeParams {
    /// Hair that moves faster than this against the head, m/s, counts as if it moved so fast.
    pub const FASTEST: f32 = 16.0;

    /// Checks every parameter.
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn validate(&self) -> Result<(), ParamError> {
        within("volume.cells", self.cells, 4..=128)?;
        within("volume.rest_density", self.rest_density, 0.05..=100.0)?;
        within("volume.sound_speed", self.sound_speed, 0.0..=100.0)?;
        within("volume.friction", self.friction, 0.0..=1000.0)
    }

    /// Refuses what would need another grid than that of `other`.
    pub(crate) fn same_grid(&self, other: &Self) -> Result<(), ParamError> {
        let refused = |name, value: String, range| Err(ParamError { name, value, range });
        if self.cells != other.cells {
            return refused("volume.cells", self.cells.to_string(), other.cells.to_string());
        }
        if self.rest_density != other.rest_density {
            return refused("volume.rest_density", self.rest_density.to_string(), other.rest_density.to_string());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_outside_its_range_is_refused_by_name() {
        let params = VolumeParams::default();
        params.validate().unwrap();
        let message = |params: VolumeParams| params.validate().unwrap_err().to_string();
        assert_eq!(
            message(VolumeParams { cells: 3, ..params.clone() }),
            "parameter volume.cells = 3 must be from 4 to 128"
        );
        assert!(message(VolumeParams { friction: f32::NAN, ..params.clone() }).contains("volume.friction"));
        assert!(message(VolumeParams { sound_speed: -1.0, ..params.clone() }).contains("volume.sound_speed"));
        assert!(message(VolumeParams { rest_density: 0.0, ..params.clone() }).contains("volume.rest_density"));
        let error = VolumeParams { cells: 32, ..params.clone() }.same_grid(&params).unwrap_err();
        assert_eq!(error.to_string(), "parameter volume.cells = 32 must be 48");
    }
}
