//! `hair.render.shade`: the colour of each strand vertex.

use tressfx_core::backend::{Backend, Kernel};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};

use crate::section::Section;
use crate::shaders::{GROUP, compute};

pub(crate) fn kernel(backend: &mut dyn Backend) -> Result<Kernel> {
    compute(backend, "hair.render.shade", ("shade", include_str!("../shaders/shade.wgsl")))
}

pub(crate) fn pass(list: &mut PassList, kernel: &Kernel, frame: BufferId, section: &Section) {
    let bindings = kernel.bind(&[
        ("frame", frame.into()),
        ("section", section.uniform.into()),
        ("positions", section.buffers.positions.into()),
        ("tangents", section.buffers.tangents.into()),
        ("openness", section.openness.into()),
        ("colors", section.colors.into()),
    ]);
    list.compute(kernel, &bindings, Grid::for_threads(section.buffers.shape.strand_vertices(), GROUP));
}
