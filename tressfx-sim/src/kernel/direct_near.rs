//! `hair.sim.direct_near`: the sub-step of `hair.sim.direct` for the strands that may touch a collider.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::ShaderSource;
use tressfx_core::strand_buffers::StrandShape;

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
/// On a CPU no thread takes a second strand before there are more than these, the most groups of WebGPU; see [`fits`].
const MOST_GROUPS_ON_CPU: u32 = 65_535;

/// `None` for a section with another solver, and where there are no colliders.
pub(crate) fn direct_near(maker: &mut PassMaker, params: &SimParams) -> Result<Option<Pass>> {
    let (Some(rods), Some(colliders)) = (maker.buffers.rods, maker.shared.colliders) else { return Ok(None) };
    let is_cpu = maker.backend.caps().is_cpu;
    let StrandShape { guides, vertices, .. } = maker.buffers.strands.shape;
    let threads = if is_cpu { threads_on_cpu(vertices, colliders.most) } else { threads_on_gpu(guides) };
    let most = match threads {
        _ if is_cpu => MOST_GROUPS_ON_CPU,
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
fn threads_on_gpu(guides: u32) -> u32 {
    match guides {
        ..=2048 => 32,
        2049..=32_768 => 8,
        _ => 1,
    }
}

/// On a CPU a barrier is dear, so a thread goes along a strand alone if it can.
fn threads_on_cpu(vertices: u32, most_colliders: usize) -> u32 {
    if fits(vertices, most_colliders) { 1 } else { 32 }
}

/// Whether a thread alone has turns enough. Mesa's driver ends every loop of a thread once all of its loops together have gone round 65,535 times. In each of 17 sweeps to
/// the root, and 16 back, each edge asks for all colliders, and for the contacts with those that are near: there is room for three of these at each edge. Of 32
/// threads none needs a tenth of that.
fn fits(vertices: u32, most_colliders: usize) -> bool {
    let turns_of_edge = 48 + 3 * most_colliders as u64;
    17 * turns_of_edge * u64::from(vertices) < 65_535
}

#[cfg(test)]
mod tests {
    use super::{fits, threads_on_cpu};

    #[test]
    fn long_strands_among_many_colliders_have_several_threads_on_a_cpu() {
        assert!(fits(32, 6) && fits(64, 4) && !fits(64, 8) && !fits(32, 40));
        assert_eq!((threads_on_cpu(32, 6), threads_on_cpu(256, 1)), (1, 32));
    }
}
