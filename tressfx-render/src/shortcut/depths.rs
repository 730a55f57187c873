//! `hair.render.shortcut_depths` and `hair.render.shortcut_depths_raster`: the depths of the nearest fragments of each pixel,
//! and the opacity of all.

use tressfx_core::shader::Module;

use crate::segments::Shaders;
use crate::shaders::with_shared;

const LIBRARY: &[Module] = &with_shared::<2, 20>([
    ("layers", include_str!("../../shaders/shortcut/layers.wgsl")),
    ("sink", include_str!("../../shaders/shortcut/depths_sink.wgsl")),
]);

pub(crate) const SHADERS: Shaders = Shaders {
    compute: (
        "hair.render.shortcut_depths",
        ("shortcut_depths", include_str!("../../shaders/shortcut/shortcut_depths.wgsl")),
    ),
    raster: Some((
        "hair.render.shortcut_depths_raster",
        ("shortcut_depths_raster", include_str!("../../shaders/shortcut/shortcut_depths_raster.wgsl")),
    )),
    library: LIBRARY,
};
