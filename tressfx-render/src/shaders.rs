//! The WGSL of this crate.

use std::sync::Arc;

use tressfx_core::backend::{Backend, ComputeDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::shader::{Kernel, Module, Shader, ShaderSource, Specialization};

/// Threads of a group of a kernel that walks a row of things: `package::grid::GROUP`.
pub(crate) const GROUP: u32 = 64;

/// What lights a surface: views and their lights, as [`ViewUniform`](crate::uniforms::ViewUniform) gives them to a shader.
pub const VIEW_MODULE: Module = ("view", include_str!("../shaders/shared/view.wgsl"));

/// What all kernels may import. `walk` asks for a module `sink`, which is the technique's; so does `quad`, which
/// imports from it.
pub(crate) const SHARED: [Module; 18] = [
    VIEW_MODULE,
    ("counters", include_str!("../shaders/shared/counters.wgsl")),
    ("coverage", include_str!("../shaders/shared/coverage.wgsl")),
    ("fragment", include_str!("../shaders/shared/fragment.wgsl")),
    ("joint", include_str!("../shaders/shared/joint.wgsl")),
    ("lighting", include_str!("../shaders/shared/lighting.wgsl")),
    ("line", include_str!("../shaders/shared/line.wgsl")),
    ("listed", include_str!("../shaders/shared/listed.wgsl")),
    ("places", include_str!("../shaders/shared/places.wgsl")),
    ("points", include_str!("../shaders/shared/points.wgsl")),
    ("quad", include_str!("../shaders/shared/quad.wgsl")),
    ("ribbon", include_str!("../shaders/shared/ribbon.wgsl")),
    ("screen", include_str!("../shaders/shared/screen.wgsl")),
    ("section", include_str!("../shaders/shared/section.wgsl")),
    ("strands", include_str!("../shaders/shared/strands.wgsl")),
    ("sums", include_str!("../shaders/shared/sums.wgsl")),
    ("tile", include_str!("../shaders/shared/tile.wgsl")),
    ("walk", include_str!("../shaders/shared/walk.wgsl")),
];

/// The end of a technique with one thread a pixel.
pub(crate) const PIXELS: Module = ("pixels", include_str!("../shaders/shared/pixels.wgsl"));

/// What lies before the hair that comes next.
pub(crate) const FRONT: Module = ("front", include_str!("../shaders/shared/front.wgsl"));

/// The triangles of tiles with hair.
pub(crate) const CORNER: Module = ("corner", include_str!("../shaders/shared/corner.wgsl"));

/// [`SHARED`] and the modules of a technique.
pub(crate) const fn with_shared<const OWN: usize, const ALL: usize>(own: [Module; OWN]) -> [Module; ALL] {
    assert!(ALL == OWN + SHARED.len());
    let mut all = [("", ""); ALL];
    let mut i = 0;
    while i < ALL {
        all[i] = if i < OWN { own[i] } else { SHARED[i - OWN] };
        i += 1;
    }
    all
}

/// Composes a shader of this crate.
pub(crate) fn shader(
    label: Label,
    root: Module,
    library: &'static [Module],
    specialization: &Specialization,
) -> Result<Arc<Shader>> {
    // A fragment has one opacity, a strand no copies, and all segments are walked before the scene, unless somebody asks for more.
    let mut specialization = specialization.clone();
    for feature in ["places", "copies", "listed", "occluded"] {
        if specialization.features().iter().all(|(name, _)| *name != feature) {
            specialization = specialization.feature(feature, false);
        }
    }
    Shader::new(&ShaderSource { label, root, library }, &specialization).map(Arc::new)
}

/// Compiles a compute kernel of this crate.
pub(crate) fn compute(
    backend: &mut dyn Backend,
    label: Label,
    root: Module,
    library: &'static [Module],
    specialization: &Specialization,
) -> Result<Kernel> {
    backend.create_compute(&ComputeDesc::new(shader(label, root, library, specialization)?))
}
