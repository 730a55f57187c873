//! The WGSL of this crate.

use std::sync::Arc;

use tressfx_core::backend::{Backend, Blend, ComputeDesc, Depth, Format, RasterDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::shader::{Kernel, Module, RasterPipeline, Shader, ShaderSource, Specialization};

/// Threads of a group of a kernel that walks a row of things: `package::grid::GROUP`.
pub(crate) const GROUP: u32 = 64;

/// What kernels import.
const LIBRARY: &[Module] = &[
    ("coverage", include_str!("../shaders/shared/coverage.wgsl")),
    ("fragment", include_str!("../shaders/shared/fragment.wgsl")),
    ("frame", include_str!("../shaders/shared/frame.wgsl")),
    ("lighting", include_str!("../shaders/shared/lighting.wgsl")),
    ("ribbon", include_str!("../shaders/shared/ribbon.wgsl")),
    ("section", include_str!("../shaders/shared/section.wgsl")),
];

/// Composes a shader of this crate.
pub(crate) fn shader(label: Label, root: Module, specialization: &Specialization) -> Result<Arc<Shader>> {
    Shader::new(&ShaderSource { label, root, library: LIBRARY }, specialization).map(Arc::new)
}

/// Compiles a compute kernel that is not specialised.
pub(crate) fn compute(backend: &mut dyn Backend, label: Label, root: Module) -> Result<Kernel> {
    backend.create_compute(&ComputeDesc::new(shader(label, root, &Specialization::new())?))
}

/// Compiles a raster kernel that is not specialised.
pub(crate) fn raster(
    backend: &mut dyn Backend,
    label: Label,
    root: Module,
    target: (Format, Blend),
    depth: Depth,
) -> Result<RasterPipeline> {
    let shader = shader(label, root, &Specialization::new())?;
    backend.create_raster(&RasterDesc::new(shader).target(target.0, target.1).depth(depth))
}
