//! `hair.sim.direct`: an implicit sub-step of rods; also the reset to the rest pose. Strands that may touch a collider are left to `hair.sim.direct_near`.

use tressfx_core::Result;
use tressfx_core::shader::{Binding, ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};
use crate::buffers::RodBuffers;
use crate::params::SimParams;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.direct",
    root: ("direct", include_str!("../../shaders/direct.wgsl")),
    library: LIBRARY,
};

/// `None` for a section with another solver.
pub(crate) fn direct(maker: &mut PassMaker, params: &SimParams) -> Result<Option<Pass>> {
    let Some(rods) = maker.buffers.rods else { return Ok(None) };
    let (specialization, resources) = (features(maker, params, false), resources(maker, &rods));
    maker.pass_with_roots(&SOURCE, specialization, &resources, maker.guides()).map(Some)
}

/// What the kernels of rods are specialised on; `contacts` of the one that asks for them. A strand that nothing can touch asks for no colliders.
pub(super) fn features(maker: &PassMaker, params: &SimParams, contacts: bool) -> Specialization {
    let (colliders, fields) = (maker.shared.colliders, maker.shared.fields);
    Specialization::new()
        .feature("colliders", colliders.is_some())
        .feature("contacts", contacts)
        .feature("fields", fields.is_some())
        .feature("internal_damping", params.internal_damping > 0.0)
        .feature("pull", params.pull_frequency > 0.0)
        .feature("inverse_masses", maker.buffers.inverse_masses)
        .feature("pinned_tips", maker.buffers.pinned_tips)
        .feature("volume", maker.shared.volume.is_some())
}

/// What they are bound to.
pub(super) fn resources(maker: &PassMaker, rods: &RodBuffers) -> Vec<(&'static str, Binding)> {
    let (buffers, shared) = (maker.buffers, maker.shared);
    let mut resources = vec![
        ("rest", buffers.rest.into()),
        ("rod_rest", rods.rest.into()),
        ("rods", rods.state.into()),
        ("positions", buffers.strands.positions.into()),
        ("counts", shared.counts.into()),
    ];
    resources.extend(shared.colliders.map(|buffer| ("colliders", buffer.colliders.into())));
    resources.extend(shared.fields.map(|fields| ("fields", fields.into())));
    resources
}
