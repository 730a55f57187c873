//! `hair.render.fill_raster`: what `hair.render.fill` does, with the raster units.

use tressfx_core::backend::{Backend, Blend, Format, RasterDesc};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Draw, Load, PassList, RasterPass};
use tressfx_core::shader::{RasterPipeline, Specialization};

use super::LIBRARY;
use super::pool::NodePool;
use crate::bound::Bound;
use crate::renderer::Targets;
use crate::shaders::shader;
use crate::strands::SectionDraw;
use crate::views::BoundView;

const LABEL: &str = "hair.render.fill_raster";

#[derive(Debug)]
pub(crate) struct FillRaster {
    pub(crate) pipeline: RasterPipeline,
    /// By view, section and scene.
    pub(crate) bound: Bound<(usize, BufferId, TextureId)>,
}

impl FillRaster {
    /// A raster pass needs a target: it is the picture, which the pass leaves as it is.
    pub(crate) fn new(backend: &mut dyn Backend, target: Format) -> Result<Self> {
        let root = ("fill_raster", include_str!("../../shaders/ppll/fill_raster.wgsl"));
        let shader = shader(LABEL, root, LIBRARY, &Specialization::new())?;
        let pipeline = backend.create_raster(&RasterDesc::new(shader).target(target, Blend::Over))?;
        Ok(Self { pipeline, bound: Bound::new() })
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draws: &[SectionDraw],
        pool: &NodePool,
        targets: &Targets,
    ) -> Result<()> {
        let mut pass = RasterPass::new(LABEL).color(targets.color, Load::Keep);
        for draw in draws {
            let strands = draw.strands;
            let bindings = self.bound.get((view.index, strands.colors, targets.depth), || {
                self.pipeline.bind(&[&strands.bindings(view, targets.depth)[..], &pool.bindings(view)].concat())
            })?;
            pass = pass.draw(Draw::new(&self.pipeline, &bindings, 6 * strands.buffers.shape.segments(), 1));
        }
        list.raster(pass);
        Ok(())
    }
}
