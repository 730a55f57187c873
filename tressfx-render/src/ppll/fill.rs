//! `hair.render.fill` and `hair.render.fill_raster`: segments of strands become fragments in the lists of pixels.

use tressfx_core::shader::Specialization;

use super::LIBRARY;
use crate::output::Output;
use crate::segments::Shaders;

pub(crate) const SHADERS: Shaders = Shaders {
    compute: ("hair.render.fill", ("fill", include_str!("../../shaders/ppll/fill.wgsl"))),
    raster: ("hair.render.fill_raster", ("fill_raster", include_str!("../../shaders/ppll/fill_raster.wgsl"))),
    library: LIBRARY,
};

/// Whether only the nearest fragments of a pixel have nodes.
pub(crate) fn bounded(on: bool, output: Output) -> Specialization {
    output.specialization().feature("bounded", on)
}
