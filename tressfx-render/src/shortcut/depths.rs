//! `hair.render.shortcut_depths`: the depths of the nearest fragments of each pixel, and the opacity of all.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Kernel, Module, Specialization};

use super::ShortCutDesc;
use super::memory::Memory;
use crate::bound::Bound;
use crate::shaders::{GROUP, compute, with_shared};
use crate::strands::SectionDraw;
use crate::views::BoundView;

const LIBRARY: &[Module] = &with_shared::<2, 14>([
    ("layers", include_str!("../../shaders/shortcut/layers.wgsl")),
    ("sink", include_str!("../../shaders/shortcut/depths_sink.wgsl")),
]);

#[derive(Debug)]
pub(crate) struct Depths {
    pub(crate) kernel: Kernel,
    /// By view, section and scene.
    pub(crate) bound: Bound<(usize, BufferId, TextureId)>,
}

impl Depths {
    pub(crate) fn new(backend: &mut dyn Backend, desc: &ShortCutDesc) -> Result<Self> {
        let root = ("shortcut_depths", include_str!("../../shaders/shortcut/shortcut_depths.wgsl"));
        let k = Specialization::new().constant("K", desc.k);
        let kernel = compute(backend, "hair.render.shortcut_depths", root, LIBRARY, &k)?;
        Ok(Self { kernel, bound: Bound::new() })
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draw: &SectionDraw,
        memory: &Memory,
        scene_depth: TextureId,
    ) -> Result<()> {
        let strands = draw.strands;
        let bindings = self.bound.get((view.index, strands.colors, scene_depth), || {
            let own = [
                ("layers", memory.layers.into()),
                ("opticals", memory.opticals.into()),
                ("counters", memory.counters.of(view.index).into()),
            ];
            self.kernel.bind(&[&strands.bindings(view, scene_depth)[..], &own].concat())
        })?;
        list.compute(&self.kernel, &bindings, Grid::for_threads(strands.buffers.shape.segments(), GROUP));
        Ok(())
    }
}
