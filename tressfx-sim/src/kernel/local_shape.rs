//! `hair.sim.local_shape`: edges want the angles of the rest pose.

use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::shader::ShaderSource;

use super::{LIBRARY, Pass, counts};
use crate::buffers::SectionBuffers;
use crate::params::SimParams;

const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.local_shape",
    root: ("local_shape", include_str!("../../shaders/local_shape.wgsl")),
    library: LIBRARY,
};

pub(crate) fn local_shape(backend: &mut dyn Backend, buffers: &SectionBuffers, params: &SimParams) -> Result<Pass> {
    let shape = &buffers.strands.shape;
    let specialization = counts(shape).constant("ITERATIONS", params.local_iterations);
    let resources =
        [("step", buffers.step.into()), ("rest", buffers.rest.into()), ("positions", buffers.strands.positions.into())];
    Pass::new(backend, &SOURCE, &specialization, &resources, shape.guides)
}
