//! `hair.render.shortcut_resolve`: the colour of the nearest fragments of a pixel with the opacity of all.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::pass::PassList;
use tressfx_core::shader::{Kernel, Module};

use super::ShortCutDesc;
use super::memory::Memory;
use crate::bound::Bound;
use crate::output::Output;
use crate::shaders::{PIXELS, compute, with_shared};
use crate::views::BoundView;

const LIBRARY: &[Module] =
    &with_shared::<2, 20>([PIXELS, ("layers", include_str!("../../shaders/shortcut/layers.wgsl"))]);

#[derive(Debug)]
pub(crate) struct Resolve {
    desc: ShortCutDesc,
    pub(crate) kernel: Kernel,
    pub(crate) bound: Bound<usize>,
}

impl Resolve {
    pub(crate) fn new(backend: &mut dyn Backend, desc: &ShortCutDesc, output: Output) -> Result<Self> {
        let root = ("shortcut_resolve", include_str!("../../shaders/shortcut/shortcut_resolve.wgsl"));
        let kernel = compute(backend, "hair.render.shortcut_resolve", root, LIBRARY, &desc.specialization(output))?;
        Ok(Self { desc: *desc, kernel, bound: Bound::new() })
    }

    pub(crate) fn pass(&mut self, list: &mut PassList, view: &BoundView, memory: &Memory) -> Result<()> {
        let bindings = self.bound.get(view.index, || {
            self.kernel.bind(&[
                ("view", view.uniform),
                ("layers", memory.layers.into()),
                ("opticals", memory.opticals.into()),
                memory.fronts(&self.desc),
                ("counters", memory.counters.of(view.index).into()),
                ("resolved", memory.resolved.colors.into()),
                ("tiles", memory.resolved.tiles.into()),
                ("tile_vertices", memory.resolved.draw.into()),
            ])
        })?;
        list.compute(&self.kernel, &bindings, view.region.grid());
        Ok(())
    }
}
