//! `hair.render.shade`: the colour of each strand vertex, seen from a view.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Kernel, Specialization};

use crate::bound::Bound;
use crate::shaders::{GROUP, SHARED, compute};
use crate::strands::SectionDraw;
use crate::views::BoundView;

#[derive(Debug)]
pub(crate) struct Shade {
    /// Where all light arrives.
    pub(crate) open: Kernel,
    /// Where shadows are made.
    pub(crate) shadowed: Option<Kernel>,
    /// By view, section, and whether it is shadowed.
    bound: Bound<(usize, BufferId, bool)>,
}

impl Shade {
    pub(crate) fn new(backend: &mut dyn Backend, has_shadows: bool) -> Result<Self> {
        let root = ("shade", include_str!("../shaders/shade.wgsl"));
        let mut kernel = |shadows| {
            let specialization = Specialization::new().feature("shadows", shadows);
            compute(backend, "hair.render.shade", root, &SHARED, &specialization)
        };
        let shadowed = has_shadows.then(|| kernel(true)).transpose()?;
        Ok(Self { open: kernel(false)?, shadowed, bound: Bound::new() })
    }

    pub(crate) fn begin(&mut self) {
        self.bound.begin_frame();
    }

    /// `is_shadowed`: what arrives at the strands has been found.
    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draw: &SectionDraw,
        is_shadowed: bool,
    ) -> Result<()> {
        let strands = draw.strands;
        let resources = [
            ("view", view.uniform),
            ("section", strands.uniform.into()),
            ("positions", strands.buffers.positions.into()),
            ("tangents", strands.buffers.tangents.into()),
            ("colors", strands.colors.into()),
            ("arriving", strands.arriving.into()),
        ];
        let (kernel, used) = match &self.shadowed {
            Some(shadowed) if is_shadowed => (shadowed, &resources[..]),
            _ => (&self.open, &resources[..5]),
        };
        let bindings = self.bound.get((view.index, strands.colors, is_shadowed), || kernel.bind(used))?;
        list.compute(kernel, &bindings, Grid::for_threads(draw.vertices(), GROUP));
        Ok(())
    }
}
