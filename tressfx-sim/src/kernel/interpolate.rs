//! `hair.sim.interpolate`: strands between guides.

use tressfx_core::shader::ShaderSource;

use super::LIBRARY;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.interpolate",
    root: ("interpolate", include_str!("../../shaders/interpolate.wgsl")),
    library: LIBRARY,
};
