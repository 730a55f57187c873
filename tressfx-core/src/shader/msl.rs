//! The Metal Shading Language from a shader.

use naga::back::msl;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};

use super::emit::{Emitted, Extra};
use super::{Shader, ShaderSlot, ShaderStage, SlotKind};
use crate::error::Result;

/// The last index of a buffer that Metal has. Metal does not tell a shader how long its buffers are.
const SIZES: u8 = 30;

/// Metal does not keep indices within what is bound: the shader does.
const CHECKED: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Restrict,
    buffer: BoundsCheckPolicy::Restrict,
    image_load: BoundsCheckPolicy::Restrict,
    binding_array: BoundsCheckPolicy::Unchecked,
};

pub(super) fn write(shader: &Shader, stage: ShaderStage) -> Result<Emitted> {
    let name = shader.entry_point(stage)?.name.clone();
    let resources = msl::EntryPointResources {
        resources: shader.slots.iter().map(target).collect(),
        immediates_buffer: None,
        sizes_buffer: Some(SIZES),
    };
    let options = msl::Options {
        lang_version: (2, 4),
        per_entry_point_map: [(name.clone(), resources)].into(),
        fake_missing_bindings: false,
        bounds_check_policies: CHECKED,
        zero_initialize_workgroup_memory: false,
        force_loop_bounding: false,
        ..msl::Options::default()
    };
    let pipeline = msl::PipelineOptions { entry_point: Some((stage.into(), name)), ..msl::PipelineOptions::default() };
    let mut writer = msl::Writer::new(String::new());
    let written = writer
        .write(&shader.parsed.module, &shader.parsed.info, &options, &pipeline)
        .map_err(|error| shader.refused(error))?;
    let entry_point = written.entry_point_names.into_iter().next().expect("one was asked for");
    let entry_point = entry_point.map_err(|error| shader.refused(error))?;
    let text = writer.finish();
    let extra = text.contains("[[buffer(30)]]").then(|| Extra {
        name: "_buffer_sizes",
        place: "[[buffer(30)]]",
        holds: open_ended(shader).map(|name| format!("bytes of {name}")).collect(),
    });
    Ok(Emitted { code: text.into_bytes(), entry_point, extra })
}

fn target(slot: &ShaderSlot) -> (naga::ResourceBinding, msl::BindTarget) {
    let number = Some(slot.binding as msl::Slot);
    let target = match slot.kind {
        SlotKind::Sampler => {
            msl::BindTarget { sampler: number.map(msl::BindSamplerTarget::Resource), ..Default::default() }
        }
        kind if kind.is_texture() => {
            msl::BindTarget { texture: number, mutable: kind.is_written(), ..Default::default() }
        }
        kind => msl::BindTarget { buffer: number, mutable: kind == SlotKind::ReadWrite, ..Default::default() },
    };
    (naga::ResourceBinding { group: 0, binding: slot.binding }, target)
}

/// Buffers whose length the WGSL does not say, in the order in which they are declared.
fn open_ended(shader: &Shader) -> impl Iterator<Item = &str> {
    let types = &shader.parsed.module.types;
    let variables = shader.parsed.module.global_variables.iter().map(|(_, variable)| variable);
    variables
        .filter(|variable| types[variable.ty].inner.needs_host_buffer_byte_size(types))
        .filter_map(|variable| variable.name.as_deref())
}
