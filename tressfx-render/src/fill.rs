//! `hair.render.fill`: segments of strands become fragments in the lists of pixels.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::Kernel;

use crate::pool::NodePool;
use crate::section::Section;
use crate::shaders::{GROUP, compute};

pub(crate) fn kernel(backend: &mut dyn Backend) -> Result<Kernel> {
    compute(backend, "hair.render.fill", ("fill", include_str!("../shaders/fill.wgsl")))
}

pub(crate) fn pass(
    list: &mut PassList,
    kernel: &Kernel,
    frame: BufferId,
    section: &Section,
    pool: &NodePool,
    scene_depth: TextureId,
) {
    let bindings = kernel
        .bind(&[
            ("frame", frame.into()),
            ("section", section.uniform.into()),
            ("positions", section.buffers.positions.into()),
            ("colors", section.colors.into()),
            ("thickness", section.buffers.thickness.into()),
            ("heads", pool.heads.into()),
            ("nodes", pool.nodes.into()),
            ("counters", pool.counters.into()),
            ("scene_depth", scene_depth.into()),
        ])
        .expect("the names of the kernel");
    list.compute(kernel, &bindings, Grid::for_threads(section.buffers.shape.segments(), GROUP));
}
