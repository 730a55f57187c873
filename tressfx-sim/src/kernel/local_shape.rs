//! `hair.sim.local_shape`: edges want the angles of the rest pose.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.local_shape",
    root: ("local_shape", include_str!("../../shaders/local_shape.wgsl")),
    library: LIBRARY,
};

pub(crate) fn local_shape(maker: &mut PassMaker) -> Result<Pass> {
    let buffers = maker.buffers;
    let resources = [("rest", buffers.rest.into()), ("positions", buffers.strands.positions.into())];
    maker.pass_with_roots(&SOURCE, Specialization::new(), &resources, maker.guides())
}
