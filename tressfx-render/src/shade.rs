//! `hair.render.shade`: the colour of each strand vertex, seen from a view.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Kernel, Specialization};

use crate::bound::Bound;
use crate::shaders::{GROUP, SHARED, compute};
use crate::strands::ShadedStrands;
use crate::views::BoundView;

#[derive(Debug)]
pub(crate) struct Shade {
    pub(crate) kernel: Kernel,
    has_shadows: bool,
    /// By view and section.
    bound: Bound<(usize, BufferId)>,
}

impl Shade {
    pub(crate) fn new(backend: &mut dyn Backend, has_shadows: bool) -> Result<Self> {
        let root = ("shade", include_str!("../shaders/shade.wgsl"));
        let specialization = Specialization::new().feature("shadows", has_shadows);
        let kernel = compute(backend, "hair.render.shade", root, &SHARED, &specialization)?;
        Ok(Self { kernel, has_shadows, bound: Bound::new() })
    }

    pub(crate) fn begin(&mut self) {
        self.bound.begin_frame();
    }

    pub(crate) fn pass(&mut self, list: &mut PassList, view: &BoundView, strands: &ShadedStrands) -> Result<()> {
        let resources = [
            ("view", view.uniform),
            ("section", strands.uniform.into()),
            ("positions", strands.buffers.positions.into()),
            ("tangents", strands.buffers.tangents.into()),
            ("colors", strands.colors.into()),
            ("arriving", strands.arriving.into()),
        ];
        let used = if self.has_shadows { &resources[..] } else { &resources[..5] };
        let bindings = self.bound.get((view.index, strands.colors), || self.kernel.bind(used))?;
        list.compute(&self.kernel, &bindings, Grid::for_threads(strands.buffers.shape.strand_vertices(), GROUP));
        Ok(())
    }
}
