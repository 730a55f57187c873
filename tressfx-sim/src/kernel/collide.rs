//! `hair.sim.collide`: strands leave the capsules and slide on them.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};
use crate::buffers::CapsuleBuffers;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.collide",
    root: ("collide", include_str!("../../shaders/collide.wgsl")),
    library: LIBRARY,
};

/// Nothing where there can be no capsules.
pub(crate) fn collide(maker: &mut PassMaker) -> Result<Option<Pass>> {
    let buffers = maker.buffers;
    let Some(CapsuleBuffers { capsules, motions, .. }) = maker.shared.capsules else { return Ok(None) };
    let resources = [
        ("capsules", capsules.into()),
        ("capsule_motions", motions.into()),
        ("rest_lengths", buffers.rest_lengths.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
    ];
    maker.pass_with_roots(&SOURCE, Specialization::new(), &resources, maker.guides()).map(Some)
}
