//! `hair.sim.bone_roots`: where the bones of strands take their roots.

use tressfx_core::shader::ShaderSource;

use super::LIBRARY;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.bone_roots",
    root: ("bone_roots", include_str!("../../shaders/bone_roots.wgsl")),
    library: LIBRARY,
};
