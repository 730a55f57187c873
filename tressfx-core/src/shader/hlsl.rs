//! HLSL from a shader.

use naga::BuiltIn;
use naga::back::hlsl;

use super::emit::{Emitted, Extra};
use super::{Shader, ShaderStage};
use crate::error::Result;

/// Beside the registers of the slots, in a space of its own. HLSL cannot ask for the number of groups.
const GROUPS: hlsl::BindTarget = hlsl::BindTarget {
    space: 1,
    register: 0,
    binding_array_size: None,
    dynamic_storage_buffer_offsets_index: None,
    restrict_indexing: false,
};

pub(super) fn write(shader: &Shader, stage: ShaderStage) -> Result<Emitted> {
    let counts_groups = counts_groups(shader, stage);
    // A slot without a target gets the register of its WGSL number.
    let options = hlsl::Options {
        shader_model: hlsl::ShaderModel::V6_0,
        special_constants_binding: counts_groups.then_some(GROUPS),
        zero_initialize_workgroup_memory: false,
        force_loop_bounding: false,
        ..hlsl::Options::default()
    };
    let pipeline = hlsl::PipelineOptions { entry_point: Some((stage.into(), shader.entry_point(stage)?.name.clone())) };
    let mut text = String::new();
    let written = hlsl::Writer::new(&mut text, &options, &pipeline)
        .write(&shader.parsed.module, &shader.parsed.info, None)
        .map_err(|error| shader.refused(error))?;
    let entry_point = written.entry_point_names.into_iter().next().expect("one was asked for");
    let entry_point = entry_point.map_err(|error| shader.refused(error))?;
    let extra = counts_groups.then(|| Extra {
        name: "_NagaConstants",
        place: "register(b0, space1)",
        holds: ["x", "y", "z"].map(|axis| format!("groups of the dispatch along {axis}")).to_vec(),
    });
    Ok(Emitted { code: text.into_bytes(), entry_point, extra })
}

/// Whether the entry point asks for the number of groups.
fn counts_groups(shader: &Shader, stage: ShaderStage) -> bool {
    let mut entries = shader.parsed.module.entry_points.iter().filter(|entry| entry.stage == stage.into());
    entries.any(|entry| {
        let mut arguments = entry.function.arguments.iter();
        arguments.any(|argument| argument.binding == Some(naga::Binding::BuiltIn(BuiltIn::NumWorkGroups)))
    })
}
