//! `hair.sim.tangents`: follow strands beside their guides, and unit tangents of all strands.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.tangents",
    root: ("tangents", include_str!("../../shaders/tangents.wgsl")),
    library: LIBRARY,
};

pub(crate) fn tangents(maker: &mut PassMaker) -> Result<Pass> {
    let (buffers, grid) = (maker.buffers, maker.strand_vertices());
    let follow_offsets = buffers.follow_offsets.map(|offsets| ("follow_offsets", offsets.into()));
    let specialization = Specialization::new().feature("follows", follow_offsets.is_some());
    let strands =
        [("positions", buffers.strands.positions.into()), ("strand_tangents", buffers.strands.tangents.into())];
    match follow_offsets {
        // Guides are where they are, whatever their roots do.
        None => maker.pass(&SOURCE, &specialization, &strands, grid),
        Some(offsets) => maker.pass_with_roots(&SOURCE, specialization, &[&strands[..], &[offsets]].concat(), grid),
    }
}
