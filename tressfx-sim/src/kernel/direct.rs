//! `hair.sim.direct`: an implicit sub-step of rods; also the reset to the rest pose.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};
use crate::params::SimParams;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.direct",
    root: ("direct", include_str!("../../shaders/direct.wgsl")),
    library: LIBRARY,
};

/// `None` for a section with another solver.
pub(crate) fn direct(maker: &mut PassMaker, params: &SimParams) -> Result<Option<Pass>> {
    let buffers = maker.buffers;
    let Some(rods) = buffers.rods else { return Ok(None) };
    // A strand that nothing can touch asks for no colliders.
    let (colliders, fields) = (maker.shared.colliders, maker.shared.fields);
    let specialization = Specialization::new()
        .feature("contacts", colliders.is_some())
        .feature("fields", fields.is_some())
        .feature("internal_damping", params.internal_damping > 0.0)
        .feature("pull", params.pull_frequency > 0.0)
        .feature("pinned_tips", buffers.pinned_tips)
        .feature("volume", maker.shared.volume.is_some());
    let mut resources = vec![
        ("rest", buffers.rest.into()),
        ("rod_rest", rods.rest.into()),
        ("rods", rods.state.into()),
        ("positions", buffers.strands.positions.into()),
        ("non_finite", maker.shared.non_finite.into()),
    ];
    resources.extend(colliders.map(|buffer| ("colliders", buffer.colliders.into())));
    resources.extend(fields.map(|fields| ("fields", fields.into())));
    maker.pass_with_roots(&SOURCE, specialization, &resources, maker.guides()).map(Some)
}
