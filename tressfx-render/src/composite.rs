//! `hair.render.composite`: the resolved hair over the caller's picture.

use tressfx_core::backend::{Backend, Blend, Format, RasterDesc};
use tressfx_core::error::Result;
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Draw, Load, PassList, RasterPass};
use tressfx_core::shader::{RasterPipeline, Specialization};

use crate::bound::Bound;
use crate::resolved::Resolved;
use crate::shaders::{SHARED, shader};
use crate::views::BoundView;

const LABEL: &str = "hair.render.composite";

#[derive(Debug)]
pub(crate) struct Composite {
    pub(crate) pipeline: RasterPipeline,
    pub(crate) bound: Bound<usize>,
}

impl Composite {
    pub(crate) fn new(backend: &mut dyn Backend, target: Format) -> Result<Self> {
        let root = ("composite", include_str!("../shaders/composite.wgsl"));
        let shader = shader(LABEL, root, &SHARED, &Specialization::new())?;
        let pipeline = backend.create_raster(&RasterDesc::new(shader).target(target, Blend::Over))?;
        Ok(Self { pipeline, bound: Bound::new() })
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        resolved: &Resolved,
        target: TextureId,
    ) -> Result<()> {
        let bindings = self.bound.get(view.index, || {
            self.pipeline.bind(&[
                ("view", view.uniform),
                ("tiles", resolved.tiles.into()),
                ("resolved", resolved.colors.into()),
            ])
        })?;
        let draw = Draw::indirect(&self.pipeline, &bindings, resolved.draw, 0);
        list.raster(RasterPass::new(LABEL).color(target, Load::Keep).draw(draw));
        Ok(())
    }
}
