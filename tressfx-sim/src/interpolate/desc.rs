//! How strands are made between guides.

use serde::{Deserialize, Serialize};

use crate::params::{ParamError, within};

/// How render strands are made between guides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct InterpolationParams {
    /// Vertices of each render strand, 2 to 256. Where they are as many as the guides have, and `shorter` is 0, each lies at those of the guides; otherwise on a smooth
    /// curve through them. `None` takes as many as the guides have.
    pub vertices: Option<u32>,
    /// Whether a strand takes its shape from the nearest guide alone, as fur does. Else from three guides, by its barycentric coordinates.
    pub nearest: bool,
    /// The angle, in degrees, from 0 to 180, by which a guide may differ from the nearest one to have a share in a strand: hair parts between guides that differ by more.
    pub parting: f32,
    /// How far tips are drawn to the nearest guide, from 0 to 1; strands keep their lengths.
    pub clump: f32,
    /// The power of the share of a strand with which that grows towards the tip, from 0.125 to 8.
    pub clump_falloff: f32,
    /// By what share of its way from the root a vertex is moved aside by chance, from 0 to 0.5.
    pub noise: f32,
    /// How many times that changes along a strand, from 0.125 to 64.
    pub noise_waves: f32,
    /// The share of its length by which a strand may be shorter than guides are, by chance, from 0 to 0.9.
    pub shorter: f32,
    /// Of everything that is by chance: the same seed gives the same strands, to the bit.
    pub seed: u64,
}

impl Default for InterpolationParams {
    /// A mean of three guides, and nothing by chance but where roots are.
    fn default() -> Self {
        Self {
            vertices: None,
            nearest: false,
            parting: 60.0,
            clump: 0.0,
            clump_falloff: 1.0,
            noise: 0.0,
            noise_waves: 3.0,
            shorter: 0.0,
            seed: 0,
        }
    }
}

impl InterpolationParams {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first one outside its range.
    pub fn validate(&self) -> Result<(), ParamError> {
        within("vertices", self.vertices.unwrap_or(2), 2..=256)?;
        within("parting", self.parting, 0.0..=180.0)?;
        within("clump", self.clump, 0.0..=1.0)?;
        within("clump_falloff", self.clump_falloff, 0.125..=8.0)?;
        within("noise", self.noise, 0.0..=0.5)?;
        within("noise_waves", self.noise_waves, 0.125..=64.0)?;
        within("shorter", self.shorter, 0.0..=0.9)
    }
}
