//! `hair.sim.velocity_shock`: strands make a share of the head's motion at once.

use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::shader::ShaderSource;

use super::{LIBRARY, Pass, counts};
use crate::buffers::SectionBuffers;

const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.velocity_shock",
    root: ("velocity_shock", include_str!("../../shaders/velocity_shock.wgsl")),
    library: LIBRARY,
};

pub(crate) fn velocity_shock(backend: &mut dyn Backend, buffers: &SectionBuffers) -> Result<Pass> {
    let shape = &buffers.strands.shape;
    let resources = [
        ("step", buffers.step.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
    ];
    Pass::new(backend, &SOURCE, &counts(shape), &resources, shape.guide_vertices())
}
