//! The entry points of a shader.

use super::reflect::{self, Varying};

/// A stage of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShaderStage {
    /// `@compute`
    Compute,
    /// `@vertex`
    Vertex,
    /// `@fragment`
    Fragment,
}

impl ShaderStage {
    pub(super) fn of(stage: naga::ShaderStage) -> Option<Self> {
        match stage {
            naga::ShaderStage::Compute => Some(Self::Compute),
            naga::ShaderStage::Vertex => Some(Self::Vertex),
            naga::ShaderStage::Fragment => Some(Self::Fragment),
            _ => None,
        }
    }
}

#[cfg(any(feature = "spirv", feature = "hlsl", feature = "msl", feature = "glsl"))]
impl From<ShaderStage> for naga::ShaderStage {
    fn from(stage: ShaderStage) -> Self {
        match stage {
            ShaderStage::Compute => Self::Compute,
            ShaderStage::Vertex => Self::Vertex,
            ShaderStage::Fragment => Self::Fragment,
        }
    }
}

/// Where a stage of a shader begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EntryPoint {
    /// Its stage.
    pub stage: ShaderStage,
    /// The name of the function in the WGSL.
    pub name: String,
    /// Threads of a group along each axis; of compute.
    pub workgroup_size: Option<[u32; 3]>,
    /// Bytes that a group shares; 0 but for compute.
    pub group_memory: u32,
    /// What it is given at locations.
    pub(super) inputs: Vec<Varying>,
    /// What it gives at locations.
    pub(super) outputs: Vec<Varying>,
}

/// The entry points of a module, in the order of the WGSL.
pub(super) fn entry_points(module: &naga::Module, info: &naga::valid::ModuleInfo) -> Vec<EntryPoint> {
    let of = |(index, entry): (usize, &naga::EntryPoint)| {
        let stage = ShaderStage::of(entry.stage)?;
        Some(EntryPoint {
            stage,
            name: entry.name.clone(),
            workgroup_size: (stage == ShaderStage::Compute).then_some(entry.workgroup_size),
            group_memory: reflect::group_memory(module, info, index),
            inputs: reflect::inputs(module, entry),
            outputs: reflect::outputs(module, entry),
        })
    };
    module.entry_points.iter().enumerate().filter_map(of).collect()
}
