//! `hair.sim.tangents`: unit tangents of all strands.

use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::shader::ShaderSource;

use super::{LIBRARY, Pass, counts};
use crate::buffers::SectionBuffers;

const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.tangents",
    root: ("tangents", include_str!("../../shaders/tangents.wgsl")),
    library: LIBRARY,
};

pub(crate) fn tangents(backend: &mut dyn Backend, buffers: &SectionBuffers) -> Result<Pass> {
    let shape = &buffers.strands.shape;
    let resources =
        [("positions", buffers.strands.positions.into()), ("strand_tangents", buffers.strands.tangents.into())];
    Pass::new(backend, &SOURCE, &counts(shape), &resources, shape.strand_vertices())
}
