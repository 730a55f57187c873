//! `hair.sim.lengths`: length constraints.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};
use crate::params::SimParams;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.lengths",
    root: ("lengths", include_str!("../../shaders/lengths.wgsl")),
    library: LIBRARY,
};

/// Vertices that are loaded at once, at most: more do not stay in registers.
const LARGEST_CHUNK: u32 = 5;

/// How many vertices are loaded at once, so that a loop of so many steps ends with little or nothing of its last chunk left.
fn chunk(steps: u32) -> u32 {
    steps.div_ceil(steps.div_ceil(LARGEST_CHUNK))
}

pub(crate) fn lengths(maker: &mut PassMaker, params: &SimParams) -> Result<Pass> {
    let buffers = maker.buffers;
    let steps = buffers.strands.shape.vertices + params.length_iterations;
    let specialization = Specialization::new()
        .constant("SWEEPS", params.length_iterations)
        .constant("CHUNK", chunk(steps))
        .feature("pinned_tips", buffers.pinned_tips);
    let resources = [
        ("rest_lengths", buffers.rest_lengths.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
    ];
    maker.pass(&SOURCE, &specialization, &resources, maker.guides())
}
