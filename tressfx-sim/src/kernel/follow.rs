//! `hair.sim.follow`: follow strands beside their guides.

use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::id::BufferId;
use tressfx_core::shader::ShaderSource;

use super::{LIBRARY, Pass, counts};
use crate::buffers::SectionBuffers;

const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.follow",
    root: ("follow", include_str!("../../shaders/follow.wgsl")),
    library: LIBRARY,
};

pub(crate) fn follow(backend: &mut dyn Backend, buffers: &SectionBuffers, follow_offsets: BufferId) -> Result<Pass> {
    let shape = &buffers.strands.shape;
    let specialization = counts(shape).constant("FOLLOWS", shape.follows);
    let resources = [
        ("step", buffers.step.into()),
        ("follow_offsets", follow_offsets.into()),
        ("positions", buffers.strands.positions.into()),
    ];
    Pass::new(backend, &SOURCE, &specialization, &resources, shape.guide_vertices())
}
