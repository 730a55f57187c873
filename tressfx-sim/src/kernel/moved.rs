//! `hair.sim.moved`: how far strands have moved since they were measured before.

use tressfx_core::Result;
use tressfx_core::id::BufferId;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.moved",
    root: ("moved", include_str!("../../shaders/moved.wgsl")),
    library: LIBRARY,
};

/// `measured` is the section's, a `vec4<f32>` a vertex of a guide; `largest` is that of all sections.
pub(crate) fn moved(maker: &mut PassMaker, measured: BufferId, largest: BufferId) -> Result<Pass> {
    let (buffers, grid) = (maker.buffers, maker.guides());
    let resources = [
        ("positions", buffers.strands.positions.into()),
        ("rest_lengths", buffers.rest_lengths.into()),
        ("measured", measured.into()),
        ("largest", largest.into()),
    ];
    maker.pass(&SOURCE, &Specialization::new(), &resources, grid)
}
