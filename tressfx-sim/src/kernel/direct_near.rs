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
/// The most groups, each of which takes strands of the list in turns. Of those in which each thread goes along a strand of its own, more than a GPU has at once
/// would wait for each other: measured on an H200, 512 are as fast, 2,112 slower by half.
const MOST_GROUPS: u32 = 1024;
const MOST_GROUPS_TOGETHER: u32 = 4096;
/// A driver on a CPU gives a thread only so many turns of all its loops together: a thread has one strand there. The most groups of WebGPU.
const MOST_GROUPS_ON_CPU: u32 = 65_535;

/// `None` for a section with another solver, and where there are no colliders.
pub(crate) fn direct_near(maker: &mut PassMaker, params: &SimParams) -> Result<Option<Pass>> {
    let Some(rods) = maker.buffers.rods.filter(|_| maker.shared.colliders.is_some()) else { return Ok(None) };
    let is_cpu = maker.backend.caps().is_cpu;
    let guides = maker.buffers.strands.shape.guides;
    let threads = threads_of_strand(guides, is_cpu);
    let most = match threads {
        1 if is_cpu => MOST_GROUPS_ON_CPU,
        1 => MOST_GROUPS,
        _ => MOST_GROUPS_TOGETHER,
    };
    let specialization = features(maker, params, true).feature("together", threads > 1).constant("TOGETHER", threads);
    let groups = guides.div_ceil(LANES / threads).clamp(1, most);
    let resources = resources(maker, &rods);
    maker.pass_with_roots(&SOURCE, specialization, &resources, Grid([groups, 1, 1])).map(Some)
}

/// How many threads go along a strand together. The more, the sooner a strand is done, as what they do in turn takes less of the time; and the more threads wait
/// meanwhile, which counts where as many strands are near something as a GPU has threads at once. Measured on an H200, where a fifth of the strands are near.
fn threads_of_strand(guides: u32, is_cpu: bool) -> u32 {
    match guides {
        // There a barrier is dear.
        _ if is_cpu => 1,
        ..=2048 => 32,
        ..=32_768 => 8,
        _ => 1,
    }
}
