//! `hair.sim.integrate`: Verlet integration and global shape; also the reset to the rest pose.

use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::shader::ShaderSource;

use super::{LIBRARY, Pass, counts};
use crate::buffers::SectionBuffers;
use crate::params::SimParams;

const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.integrate",
    root: ("integrate", include_str!("../../shaders/integrate.wgsl")),
    library: LIBRARY,
};

pub(crate) fn integrate(backend: &mut dyn Backend, buffers: &SectionBuffers, params: &SimParams) -> Result<Pass> {
    let shape = &buffers.strands.shape;
    let specialization = counts(shape).feature("global_shape", params.has_global_shape());
    let resources = [
        ("step", buffers.step.into()),
        ("rest", buffers.rest.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
    ];
    Pass::new(backend, &SOURCE, &specialization, &resources, shape.guide_vertices())
}
