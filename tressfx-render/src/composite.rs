//! `hair.render.composite`: the resolved hair over the caller's picture.

use tressfx_core::backend::{Backend, Blend, Depth, Format};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Draw, Load, PassList, RasterPass};
use tressfx_core::shader::RasterPipeline;

use crate::pool::Resolved;
use crate::shaders::raster;

const LABEL: &str = "hair.render.composite";

pub(crate) fn kernel(backend: &mut dyn Backend, target: Format) -> Result<RasterPipeline> {
    let root = ("composite", include_str!("../shaders/composite.wgsl"));
    raster(backend, LABEL, root, (target, Blend::Over), Depth::Off)
}

pub(crate) fn pass(
    list: &mut PassList,
    pipeline: &RasterPipeline,
    frame: BufferId,
    resolved: &Resolved,
    target: TextureId,
) {
    let bindings = pipeline.bind(&[
        ("frame", frame.into()),
        ("tiles", resolved.tiles.into()),
        ("resolved", resolved.colors.into()),
    ]);
    let bindings = bindings.expect("the names of the kernel");
    let draw = Draw::new(pipeline, &bindings, 6, resolved.tile_count());
    list.raster(RasterPass::new(LABEL).color(target, Load::Keep).draw(draw));
}
