//! `hair.render.shade`: the colour of each strand vertex.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::Kernel;

use crate::section::Section;
use crate::shaders::{GROUP, compute};

pub(crate) fn kernel(backend: &mut dyn Backend) -> Result<Kernel> {
    compute(backend, "hair.render.shade", ("shade", include_str!("../shaders/shade.wgsl")))
}

pub(crate) fn pass(list: &mut PassList, kernel: &Kernel, frame: BufferId, section: &Section) {
    let bindings = kernel
        .bind(&[
            ("frame", frame.into()),
            ("section", section.uniform.into()),
            ("positions", section.buffers.positions.into()),
            ("tangents", section.buffers.tangents.into()),
            ("openness", section.openness.into()),
            ("colors", section.colors.into()),
        ])
        .expect("the names of the kernel");
    list.compute(kernel, &bindings, Grid::for_threads(section.buffers.shape.strand_vertices(), GROUP));
}
