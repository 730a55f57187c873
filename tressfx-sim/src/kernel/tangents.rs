//! `hair.sim.tangents`: unit tangents of all strands.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.tangents",
    root: ("tangents", include_str!("../../shaders/tangents.wgsl")),
    library: LIBRARY,
};

pub(crate) fn tangents(maker: &mut PassMaker) -> Result<Pass> {
    let buffers = &maker.buffers.strands;
    let resources = [("positions", buffers.positions.into()), ("strand_tangents", buffers.tangents.into())];
    maker.pass(&SOURCE, &Specialization::new(), &resources, maker.strand_vertices())
}
