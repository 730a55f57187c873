//! `hair.sim.volume_push`: what the hair around a vertex changes of its velocity.

use tressfx_core::Result;
use tressfx_core::shader::ShaderSource;

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.volume_push",
    root: ("volume_push", include_str!("../../shaders/volume_push.wgsl")),
    library: LIBRARY,
};

/// `None` where hair does not meet hair.
pub(crate) fn volume_push(maker: &mut PassMaker) -> Result<Option<Pass>> {
    let Some(volume) = &maker.shared.volume else { return Ok(None) };
    let resources = [("node_values", volume.buffers.node_values.into())];
    maker.pass_of_volume(&SOURCE, volume, true, &resources).map(Some)
}
