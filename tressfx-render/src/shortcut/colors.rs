//! `hair.render.shortcut_colors`: the colours of the fragments that are not behind the last layer.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Kernel, Module};

use super::ShortCutDesc;
use super::memory::Memory;
use crate::bound::Bound;
use crate::shaders::{GROUP, compute, with_shared};
use crate::strands::SectionDraw;
use crate::views::BoundView;

const LIBRARY: &[Module] = &with_shared::<2, 14>([
    ("layers", include_str!("../../shaders/shortcut/layers.wgsl")),
    ("sink", include_str!("../../shaders/shortcut/colors_sink.wgsl")),
]);

#[derive(Debug)]
pub(crate) struct Colors {
    desc: ShortCutDesc,
    pub(crate) kernel: Kernel,
    /// By view, section and scene.
    pub(crate) bound: Bound<(usize, BufferId, TextureId)>,
}

impl Colors {
    pub(crate) fn new(backend: &mut dyn Backend, desc: &ShortCutDesc) -> Result<Self> {
        let root = ("shortcut_colors", include_str!("../../shaders/shortcut/shortcut_colors.wgsl"));
        let kernel = compute(backend, "hair.render.shortcut_colors", root, LIBRARY, &desc.specialization())?;
        Ok(Self { desc: *desc, kernel, bound: Bound::new() })
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
            let mut bindings = strands.bindings(view, scene_depth).to_vec();
            bindings.extend([("layers", memory.layers.into()), memory.fronts(&self.desc)]);
            if !self.desc.ordered {
                bindings.push(("resolved", memory.resolved.colors.into()));
            }
            self.kernel.bind(&bindings)
        })?;
        list.compute(&self.kernel, &bindings, Grid::for_threads(strands.buffers.shape.segments(), GROUP));
        Ok(())
    }
}
