//! `hair.render.fill`: segments of strands become fragments in the lists of pixels.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Kernel, Specialization};

use super::LIBRARY;
use super::pool::NodePool;
use crate::bound::Bound;
use crate::shaders::{GROUP, compute};
use crate::strands::SectionDraw;
use crate::views::BoundView;

#[derive(Debug)]
pub(crate) struct Fill {
    pub(crate) kernel: Kernel,
    /// By view, section and scene.
    pub(crate) bound: Bound<(usize, BufferId, TextureId)>,
}

impl Fill {
    pub(crate) fn new(backend: &mut dyn Backend) -> Result<Self> {
        let root = ("fill", include_str!("../../shaders/ppll/fill.wgsl"));
        let kernel = compute(backend, "hair.render.fill", root, LIBRARY, &Specialization::new())?;
        Ok(Self { kernel, bound: Bound::new() })
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draw: &SectionDraw,
        pool: &NodePool,
        scene_depth: TextureId,
    ) -> Result<()> {
        let strands = draw.strands;
        let bindings = self.bound.get((view.index, strands.colors, scene_depth), || {
            self.kernel.bind(&[&strands.bindings(view, scene_depth)[..], &pool.bindings(view)].concat())
        })?;
        list.compute(&self.kernel, &bindings, Grid::for_threads(strands.buffers.shape.segments(), GROUP));
        Ok(())
    }
}
