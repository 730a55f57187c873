//! `hair.sim.follow`: follow strands beside their guides.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.follow",
    root: ("follow", include_str!("../../shaders/follow.wgsl")),
    library: LIBRARY,
};

/// Nothing where there are no follow strands.
pub(crate) fn follow(maker: &mut PassMaker) -> Result<Option<Pass>> {
    let buffers = maker.buffers;
    let Some(offsets) = buffers.follow_offsets else { return Ok(None) };
    let resources = [("follow_offsets", offsets.into()), ("positions", buffers.strands.positions.into())];
    maker.pass_with_roots(&SOURCE, Specialization::new(), &resources, maker.follow_vertices()).map(Some)
}
