//! `hair.sim.recovery`: strands that have become non-finite go back to their rest pose.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.recovery",
    root: ("recovery", include_str!("../../shaders/recovery.wgsl")),
    library: LIBRARY,
};

pub(crate) fn recovery(maker: &mut PassMaker) -> Result<Pass> {
    let buffers = maker.buffers;
    let resources = [
        ("rest", buffers.rest.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
        ("non_finite", maker.shared.non_finite.into()),
    ];
    maker.pass_with_roots(&SOURCE, Specialization::new(), &resources, maker.guides())
}
