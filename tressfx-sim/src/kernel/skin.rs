//! `hair.sim.skin`: a mesh as its joints and morph targets move it.

use tressfx_core::shader::ShaderSource;

use super::LIBRARY;

pub(crate) const SOURCE: ShaderSource =
    ShaderSource { label: "hair.sim.skin", root: ("skin", include_str!("../../shaders/skin.wgsl")), library: LIBRARY };
