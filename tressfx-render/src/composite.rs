//! `hair.render.composite`: the resolved hair over the caller's picture.

use tressfx_core::backend::{Backend, Blend, Depth, Format, Kernel};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Draw, Load, PassList, RasterPass};

use crate::pool::Resolved;
use crate::shaders::raster;

const LABEL: &str = "hair.render.composite";

pub(crate) fn kernel(backend: &mut dyn Backend, target: Format) -> Result<Kernel> {
    let root = ("composite", include_str!("../shaders/composite.wgsl"));
    raster(backend, LABEL, root, (target, Blend::Over), Depth::Off)
}

pub(crate) fn pass(list: &mut PassList, kernel: &Kernel, frame: BufferId, resolved: &Resolved, target: TextureId) {
    let bindings =
        kernel.bind(&[("frame", frame.into()), ("tiles", resolved.tiles.into()), ("resolved", resolved.colors.into())]);
    list.raster(RasterPass {
        label: LABEL,
        colors: vec![(target, Load::Keep)],
        depth: None,
        draws: vec![Draw { kernel: kernel.clone(), bindings, vertices: 6, instances: resolved.tile_count() }],
    });
}
