//! `hair.render.shortcut_colors` and `hair.render.shortcut_colors_raster`: the colours of the fragments that are not behind
//! the last layer.

use tressfx_core::shader::Module;

use crate::segments::Shaders;
use crate::shaders::with_shared;

const LIBRARY: &[Module] = &with_shared::<2, 20>([
    ("layers", include_str!("../../shaders/shortcut/layers.wgsl")),
    ("sink", include_str!("../../shaders/shortcut/colors_sink.wgsl")),
]);

pub(crate) const SHADERS: Shaders = Shaders {
    compute: (
        "hair.render.shortcut_colors",
        ("shortcut_colors", include_str!("../../shaders/shortcut/shortcut_colors.wgsl")),
    ),
    raster: Some((
        "hair.render.shortcut_colors_raster",
        ("shortcut_colors_raster", include_str!("../../shaders/shortcut/shortcut_colors_raster.wgsl")),
    )),
    library: LIBRARY,
};
