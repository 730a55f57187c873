//! `hair.sim.velocity_shock`: strands make a share of the head's motion at once.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.velocity_shock",
    root: ("velocity_shock", include_str!("../../shaders/velocity_shock.wgsl")),
    library: LIBRARY,
};

pub(crate) fn velocity_shock(maker: &mut PassMaker) -> Result<Pass> {
    let buffers = maker.buffers;
    let resources = [("previous", buffers.previous.into()), ("positions", buffers.strands.positions.into())];
    maker.pass_with_roots(&SOURCE, Specialization::new(), &resources, maker.guide_vertices())
}
