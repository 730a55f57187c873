//! `hair.render.fill` and `hair.render.fill_raster`: segments of strands become fragments in the lists of pixels.

use super::LIBRARY;
use crate::segments::Shaders;

pub(crate) const SHADERS: Shaders = Shaders {
    compute: ("hair.render.fill", ("fill", include_str!("../../shaders/ppll/fill.wgsl"))),
    raster: ("hair.render.fill_raster", ("fill_raster", include_str!("../../shaders/ppll/fill_raster.wgsl"))),
    library: LIBRARY,
};
