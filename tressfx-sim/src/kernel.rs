//! The kernels: one file of WGSL in `shaders/`, one function here and one in [`crate::reference`], all of the same name.

pub(crate) mod collide;
pub(crate) mod follow;
pub(crate) mod integrate;
pub(crate) mod length;
pub(crate) mod local_shape;
pub(crate) mod tangents;
pub(crate) mod velocity_shock;

use std::sync::Arc;

use tressfx_core::Result;
use tressfx_core::backend::{Backend, ComputeDesc};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Binding, Bindings, Kernel, Module, Shader, ShaderSource, Specialization};
use tressfx_core::strand_buffers::StrandShape;

/// Threads of a group; `package::grid::GROUP` in WGSL.
const GROUP: u32 = 64;

/// The WGSL modules that the kernels share.
pub(crate) const LIBRARY: &[Module] = &[
    ("capsule", include_str!("../shaders/capsule.wgsl")),
    ("step", include_str!("../shaders/step.wgsl")),
    ("vector", include_str!("../shaders/vector.wgsl")),
    ("wind", include_str!("../shaders/wind.wgsl")),
];

/// A kernel with everything that it needs to run.
#[derive(Debug)]
pub(crate) struct Pass {
    kernel: Kernel,
    bindings: Bindings,
    grid: Grid,
}

impl Pass {
    pub(crate) fn new(
        backend: &mut dyn Backend,
        source: &ShaderSource,
        specialization: &Specialization,
        bindings: &[(&str, Binding)],
        threads: u32,
    ) -> Result<Self> {
        let shader = Arc::new(Shader::new(source, specialization)?);
        let kernel = backend.create_compute(&ComputeDesc::new(shader))?;
        let bindings = kernel.bind(bindings)?;
        Ok(Self { kernel, bindings, grid: Grid::for_threads(threads, GROUP) })
    }

    pub(crate) fn record(&self, list: &mut PassList) {
        list.compute(&self.kernel, &self.bindings, self.grid);
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        backend.destroy_pipeline(self.kernel.pipeline);
    }
}

/// What every kernel is compiled for: the counts of its section.
fn counts(shape: &StrandShape) -> Specialization {
    Specialization::new()
        .constant("GUIDES", shape.guides)
        .constant("STRANDS", shape.strands())
        .constant("VERTICES", shape.vertices)
}
