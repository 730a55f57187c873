//! `hair.sim.direct_near`: the sub-step of `hair.sim.direct` for the strands that may touch a collider.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::ShaderSource;

use super::direct::{features, resources};
use super::{LIBRARY, Pass, PassMaker};
use crate::params::SimParams;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.direct_near",
    root: ("direct_near", include_str!("../../shaders/direct_near.wgsl")),
    library: LIBRARY,
};

/// Threads of a group; `LANES` in WGSL.
const LANES: u32 = 32;
/// More groups than a GPU has at once would wait for each other: measured on an H200, 512 are as fast, 2,112 slower by half.
const MOST_GROUPS: u32 = 1024;
/// A driver on a CPU gives a thread only so many turns of all its loops together: a thread has one strand there. The most groups of WebGPU.
const MOST_GROUPS_ON_CPU: u32 = 65_535;

/// `None` for a section with another solver, and where there are no colliders.
pub(crate) fn direct_near(maker: &mut PassMaker, params: &SimParams) -> Result<Option<Pass>> {
    let Some(rods) = maker.buffers.rods.filter(|_| maker.shared.colliders.is_some()) else { return Ok(None) };
    let specialization = features(maker, params, true);
    let most = if maker.backend.caps().is_cpu { MOST_GROUPS_ON_CPU } else { MOST_GROUPS };
    let groups = maker.buffers.strands.shape.guides.div_ceil(LANES).clamp(1, most);
    let resources = resources(maker, &rods);
    maker.pass_with_roots(&SOURCE, specialization, &resources, Grid([groups, 1, 1])).map(Some)
}
