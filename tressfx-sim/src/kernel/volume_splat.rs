//! `hair.sim.volume_splat`: mass and momentum of the guides at the nodes of a grid.

use tressfx_core::Result;
use tressfx_core::shader::ShaderSource;

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.volume_splat",
    root: ("volume_splat", include_str!("../../shaders/volume_splat.wgsl")),
    library: LIBRARY,
};

/// `None` where hair does not meet hair.
pub(crate) fn volume_splat(maker: &mut PassMaker) -> Result<Option<Pass>> {
    let Some(volume) = &maker.shared.volume else { return Ok(None) };
    let resources = [("rest_lengths", maker.buffers.rest_lengths.into()), ("sums", volume.buffers.sums.into())];
    maker.pass_of_volume(&SOURCE, volume, false, &resources).map(Some)
}
