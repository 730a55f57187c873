//! `hair.sim.integrate`: velocity shock, Verlet integration and global shape; also the reset to the rest pose.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};
use crate::params::SimParams;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.integrate",
    root: ("integrate", include_str!("../../shaders/integrate.wgsl")),
    library: LIBRARY,
};

pub(crate) fn integrate(maker: &mut PassMaker, params: &SimParams) -> Result<Pass> {
    let buffers = maker.buffers;
    let specialization = Specialization::new().feature("global_shape", params.has_global_shape());
    let resources = [
        ("rest", buffers.rest.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
    ];
    maker.pass_with_roots(&SOURCE, specialization, &resources, maker.guide_vertices())
}
