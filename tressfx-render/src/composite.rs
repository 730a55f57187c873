//! `hair.render.composite`: the resolved hair over the caller's picture.

use tressfx_core::backend::{Backend, Blend, RasterDesc};
use tressfx_core::error::Result;
use tressfx_core::pass::{Draw, Load, PassList, RasterPass};
use tressfx_core::shader::{Module, RasterPipeline};

use crate::bound::Bound;
use crate::output::{HAIR_FORMAT, Output};
use crate::renderer::Targets;
use crate::resolved::Resolved;
use crate::shaders::{CORNER, shader, with_shared};
use crate::views::BoundView;

const LABEL: &str = "hair.render.composite";

const LIBRARY: &[Module] = &with_shared::<1, 17>([CORNER]);

#[derive(Debug)]
pub(crate) struct Composite {
    pub(crate) pipeline: RasterPipeline,
    pub(crate) bound: Bound<usize>,
}

impl Composite {
    pub(crate) fn new(backend: &mut dyn Backend, output: Output) -> Result<Self> {
        let root = ("composite", include_str!("../shaders/composite.wgsl"));
        let shader = shader(LABEL, root, LIBRARY, &output.specialization())?;
        let mut desc = RasterDesc::new(shader).target(output.color, Blend::Over);
        if output.hair {
            desc = desc.target(HAIR_FORMAT, Blend::Replace);
        }
        let pipeline = backend.create_raster(&desc)?;
        Ok(Self { pipeline, bound: Bound::new() })
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        resolved: &Resolved,
        targets: &Targets,
    ) -> Result<()> {
        let bindings = self.bound.get(view.index, || {
            self.pipeline.bind(&[
                ("view", view.uniform),
                ("tiles", resolved.tiles.into()),
                ("resolved", resolved.colors.into()),
            ])
        })?;
        let draw = Draw::indirect(&self.pipeline, &bindings, resolved.draw, 0);
        let mut pass = RasterPass::new(LABEL).color(targets.color, Load::Keep);
        if let Some(hair) = targets.hair {
            pass = pass.color(hair, Load::Keep);
        }
        list.raster(pass.draw(draw));
        Ok(())
    }
}
