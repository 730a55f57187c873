//! `hair.render.fill` and `hair.render.fill_raster`: segments of strands become fragments in the lists of pixels.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;

use super::{LIBRARY, PpllDesc};
use crate::output::Output;
use crate::places::at_places;
use crate::segments::{Segments, Shaders};

const SHADERS: Shaders = Shaders {
    compute: ("hair.render.fill", ("fill", include_str!("../../shaders/ppll/fill.wgsl"))),
    raster: Some(("hair.render.fill_raster", ("fill_raster", include_str!("../../shaders/ppll/fill_raster.wgsl")))),
    library: LIBRARY,
};

/// The pass; where lists are bounded, only the nearest fragments of a pixel have nodes. They may have two buffers of them.
pub(crate) fn pass(
    backend: &mut dyn Backend,
    desc: &PpllDesc,
    [is_bounded, has_more_nodes]: [bool; 2],
    output: Output,
) -> Result<Segments> {
    let specialization = output.specialization().feature("bounded", is_bounded).feature("more_nodes", has_more_nodes);
    let specialization = at_places(specialization, desc.places, 1);
    Segments::new(backend, desc.fill, SHADERS, &specialization, output.color)
}
