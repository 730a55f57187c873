//! `hair.render.nearest`: the keys of the nearest fragments of each pixel, where lists do not hold all of them.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::shader::Module;

use crate::output::Output;
use crate::segments::{Fill, Segments, Shaders};
use crate::shaders::with_shared;

const LIBRARY: &[Module] = &with_shared::<3, 21>([
    ("kept", include_str!("../../shaders/ppll/kept.wgsl")),
    ("node", include_str!("../../shaders/ppll/node.wgsl")),
    ("sink", include_str!("../../shaders/ppll/nearest_sink.wgsl")),
]);

const SHADERS: Shaders = Shaders {
    compute: ("hair.render.nearest", ("nearest", include_str!("../../shaders/ppll/nearest.wgsl"))),
    raster: None,
    library: LIBRARY,
};

/// The pass. It is of compute even where fragment shaders fill the lists behind it: what it finds is the same.
pub(crate) fn pass(backend: &mut dyn Backend, output: Output) -> Result<Segments> {
    Segments::new(backend, Fill::Compute, SHADERS, &output.walk(), output.color)
}
