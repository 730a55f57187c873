//! `hair.sim.tressfx`: a sub-step of the method of TressFX; also the reset to the rest pose.

use tressfx_core::Result;
use tressfx_core::shader::{Binding, ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};
use crate::params::SimParams;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.tressfx",
    root: ("tressfx", include_str!("../../shaders/tressfx.wgsl")),
    library: LIBRARY,
};

/// Vertices that are loaded at once: more do not stay in registers beside those that the stages are at.
const CHUNK: u32 = 2;

/// `None` for a section with another solver.
pub(crate) fn tressfx(maker: &mut PassMaker, params: &SimParams) -> Result<Option<Pass>> {
    let buffers = maker.buffers;
    if buffers.rods.is_some() {
        return Ok(None);
    }
    let (colliders, fields) = (maker.shared.colliders, maker.shared.fields);
    let specialization = Specialization::new()
        .constant("CHUNK", CHUNK)
        .constant("LENGTHS", params.length_iterations)
        .constant("LOCAL", params.local_iterations_of(buffers.strands.shape.vertices))
        .feature("capsules", colliders.is_some())
        .feature("fields", fields.is_some())
        .feature("global_shape", params.has_global_shape());
    let mut resources: Vec<(&str, Binding)> = vec![
        ("rest", buffers.rest.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
        ("counts", maker.shared.counts.into()),
    ];
    resources.extend(colliders.map(|buffer| ("colliders", buffer.colliders.into())));
    resources.extend(fields.map(|fields| ("fields", fields.into())));
    maker.pass_with_roots(&SOURCE, specialization, &resources, maker.guides()).map(Some)
}
