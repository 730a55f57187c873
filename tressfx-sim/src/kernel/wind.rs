//! `hair.sim.wind`: vertices are moved by the wind across their edges.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource =
    ShaderSource { label: "hair.sim.wind", root: ("wind", include_str!("../../shaders/wind.wgsl")), library: LIBRARY };

pub(crate) fn wind(maker: &mut PassMaker) -> Result<Pass> {
    let positions = maker.buffers.strands.positions;
    maker.pass(&SOURCE, &Specialization::new(), &[("positions", positions.into())], maker.guides())
}
