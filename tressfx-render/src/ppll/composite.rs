//! `hair.render.composite`: the resolved hair over the caller's picture.

use tressfx_core::backend::{Backend, Blend, Depth, Format, Kernel, RasterDesc};
use tressfx_core::error::Result;
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Draw, Load, PassList, RasterPass};
use tressfx_core::shader::Specialization;

use super::LIBRARY;
use super::pool::{Resolved, tile_count};
use crate::bound::Bound;
use crate::shaders::shader;
use crate::views::BoundView;

const LABEL: &str = "hair.render.composite";

#[derive(Debug)]
pub(crate) struct Composite {
    pub(crate) kernel: Kernel,
    pub(crate) bound: Bound<usize>,
}

impl Composite {
    pub(crate) fn new(backend: &mut dyn Backend, target: Format) -> Result<Self> {
        let root = ("composite", include_str!("../../shaders/ppll/composite.wgsl"));
        let shader = shader(LABEL, root, LIBRARY, &Specialization::new())?;
        let targets = vec![(target, Blend::Over)];
        let kernel = backend.create_raster(&RasterDesc { shader, targets, depth: Depth::Off })?;
        Ok(Self { kernel, bound: Bound::new() })
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        resolved: &Resolved,
        target: TextureId,
    ) -> Result<()> {
        let bindings = self.bound.get(view.index, || {
            Ok(self.kernel.bind(&[
                ("view", view.uniform),
                ("tiles", resolved.tiles.into()),
                ("resolved", resolved.colors.into()),
            ]))
        })?;
        let draw = Draw { kernel: self.kernel.clone(), bindings, vertices: 6, instances: tile_count(view.size) };
        list.raster(RasterPass { label: LABEL, colors: vec![(target, Load::Keep)], depth: None, draws: vec![draw] });
        Ok(())
    }
}
