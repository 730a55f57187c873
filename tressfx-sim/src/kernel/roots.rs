//! `hair.sim.roots`: where the roots are at the end of a sub-step.

use tressfx_core::Result;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass, PassMaker};
use crate::buffers::RootBuffers;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.roots",
    root: ("roots", include_str!("../../shaders/roots.wgsl")),
    library: LIBRARY,
};

/// Nothing where the roots ride on the head.
pub(crate) fn roots(maker: &mut PassMaker) -> Result<Option<Pass>> {
    let Some(RootBuffers { targets, places, now }) = maker.buffers.roots else { return Ok(None) };
    let resources = [
        ("targets", targets.into()),
        ("places_0", places[0].into()),
        ("places_1", places[1].into()),
        ("places_2", places[2].into()),
        ("guide_roots", now.into()),
    ];
    maker.pass(&SOURCE, &Specialization::new(), &resources, maker.guides()).map(Some)
}
