//! `hair.sim.length`: wind, length constraints and the guard against non-finite strands.

use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::id::BufferId;
use tressfx_core::shader::ShaderSource;

use super::{LIBRARY, Pass, counts};
use crate::buffers::SectionBuffers;
use crate::params::SimParams;

const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.length",
    root: ("length", include_str!("../../shaders/length.wgsl")),
    library: LIBRARY,
};

/// Vertices that are loaded at once, at most: more do not stay in registers.
const LARGEST_CHUNK: u32 = 5;

/// How many vertices are loaded at once, so that a walk of so many steps ends with little or nothing of its last chunk left.
fn chunk(steps: u32) -> u32 {
    steps.div_ceil(steps.div_ceil(LARGEST_CHUNK))
}

pub(crate) fn length(
    backend: &mut dyn Backend,
    buffers: &SectionBuffers,
    non_finite: BufferId,
    params: &SimParams,
    wind: bool,
) -> Result<Pass> {
    let shape = &buffers.strands.shape;
    let specialization = counts(shape)
        .constant("SWEEPS", params.length_iterations)
        .constant("CHUNK", chunk(shape.vertices + params.length_iterations))
        .feature("wind", wind)
        .feature("pinned_tips", buffers.pinned_tips);
    let resources = [
        ("step", buffers.step.into()),
        ("rest", buffers.rest.into()),
        ("rest_lengths", buffers.rest_lengths.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
        ("non_finite", non_finite.into()),
    ];
    Pass::new(backend, &SOURCE, &specialization, &resources, shape.guides)
}
