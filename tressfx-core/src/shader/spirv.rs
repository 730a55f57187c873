//! SPIR-V from a shader, for backends that take it.

use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};

use super::{Shader, ShaderStage};
use crate::error::Result;

/// What SPIR-V is written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpirvOptions {
    /// The version, major and minor: (1, 6) with Vulkan 1.3.
    pub version: (u8, u8),
    /// Whether the device itself keeps accesses to buffers within what is bound (`robustBufferAccess2`). Where it does
    /// not, the shader does.
    pub robust_buffers: bool,
    /// Whether the device itself keeps reads of textures within them (`robustImageAccess2`). Where it does not, the
    /// shader does.
    pub robust_textures: bool,
    /// Whether names stay in it, for debuggers.
    pub names: bool,
}

impl Shader {
    /// The entry point of one stage as SPIR-V words, under its WGSL name. Bindings lie in descriptor set 0 under their WGSL
    /// numbers.
    ///
    /// The clip space is WebGPU's, y up: turn it with a viewport of negative height. Group memory is not zeroed, loops are not
    /// bounded, and indices into group memory and into arrays of a function are not checked; the library's kernels need none of it.
    ///
    /// # Errors
    /// [`Error::Shader`](crate::Error::Shader) if there is no such entry point, or with what naga says.
    pub fn spirv(&self, stage: ShaderStage, options: &SpirvOptions) -> Result<Vec<u32>> {
        let mut flags = spv::WriterFlags::LABEL_VARYINGS;
        flags.set(spv::WriterFlags::DEBUG, options.names);
        let checked = |robust| if robust { BoundsCheckPolicy::Unchecked } else { BoundsCheckPolicy::Restrict };
        let writer = spv::Options {
            lang_version: options.version,
            flags,
            bounds_check_policies: BoundsCheckPolicies {
                index: BoundsCheckPolicy::Unchecked,
                buffer: checked(options.robust_buffers),
                image_load: checked(options.robust_textures),
                binding_array: BoundsCheckPolicy::Unchecked,
            },
            zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
            force_loop_bounding: false,
            ..spv::Options::default()
        };
        let entry_point = self.entry_point(stage)?.name.clone();
        let pipeline = spv::PipelineOptions { shader_stage: stage.into(), entry_point };
        spv::write_vec(&self.parsed.module, &self.parsed.info, &writer, Some(&pipeline))
            .map_err(|error| self.refused(error))
    }
}
