//! `hair.sim.triangle_roots`: where the triangles of a mesh take roots.

use tressfx_core::shader::ShaderSource;

use super::LIBRARY;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.triangle_roots",
    root: ("triangle_roots", include_str!("../../shaders/triangle_roots.wgsl")),
    library: LIBRARY,
};
