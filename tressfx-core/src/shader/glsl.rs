//! GLSL from a shader.

use naga::back::glsl;
use naga::proc::BoundsCheckPolicies;

use super::emit::Emitted;
use super::{Shader, ShaderStage, SlotKind};
use crate::error::{Error, Result};
use crate::format::Format;

/// Writes a stage. Its buffers and textures have the names of the WGSL behind a `g_`, so that none is a word of GLSL.
pub(super) fn write(shader: &Shader, stage: ShaderStage, version: glsl::Version) -> Result<Emitted> {
    if version.is_es() {
        check_images(shader)?;
    }
    let plain = with_plain_textures(shader)?;
    let shader = plain.as_ref().unwrap_or(shader);
    let binding = |number| naga::ResourceBinding { group: 0, binding: number };
    let options = glsl::Options {
        version,
        binding_map: shader.slots.iter().map(|slot| (binding(slot.binding), slot.binding as u8)).collect(),
        zero_initialize_workgroup_memory: false,
        ..glsl::Options::default()
    };
    let entry_point = shader.entry_point(stage)?.name.clone();
    let pipeline = glsl::PipelineOptions { shader_stage: stage.into(), entry_point, multiview: None };
    let mut text = String::new();
    // naga has no checks for buffers in GLSL, and those for textures are not in OpenGL ES.
    let unchecked = BoundsCheckPolicies::default();
    glsl::Writer::new(&mut text, &shader.parsed.module, &shader.parsed.info, &options, &pipeline, unchecked)
        .and_then(|mut writer| writer.write().map(drop))
        .map_err(|error| shader.refused(error))?;
    for slot in &shader.slots {
        for suffix in ["cs", "vs", "fs"] {
            let number = format!("_group_0_binding_{}_{suffix}", slot.binding);
            text = text.replace(&number, &format!("g_{}", slot.name));
        }
    }
    Ok(Emitted { code: text.into_bytes(), entry_point: String::from("main"), extra: None })
}

/// OpenGL ES reads and writes no other textures in place than those with one channel of 32 bits.
fn check_images(shader: &Shader) -> Result<()> {
    let is_refused =
        |kind| matches!(kind, SlotKind::ReadWriteTexture(format) if !matches!(format, Format::R32F | Format::R32Uint));
    match shader.slots.iter().find(|slot| is_refused(slot.kind)) {
        None => Ok(()),
        Some(slot) => {
            let message = format!(
                "binding `{}`: GLSL ES reads and writes at once only textures with one channel of 32 bits",
                slot.name
            );
            Err(Error::Shader { label: shader.label, message })
        }
    }
}

/// The shader reading depth as the first channel of a colour texture: the samplers that GLSL has for depth compare, and
/// cannot be read by the texel. `None` where it reads none.
fn with_plain_textures(shader: &Shader) -> Result<Option<Shader>> {
    let depth: Vec<_> = shader.slots.iter().filter(|slot| slot.kind == SlotKind::DepthTexture).collect();
    if depth.is_empty() {
        return Ok(None);
    }
    let mut wgsl = shader.wgsl.replace("texture_depth_2d", "texture_2d<f32>");
    for slot in depth {
        wgsl = first_channel(&wgsl, &format!("textureLoad({},", slot.name));
    }
    Shader::parse(shader.label, &shader.specialization, wgsl).map(Some)
}

/// Takes the first channel of what each call that begins like this gives.
fn first_channel(wgsl: &str, call: &str) -> String {
    let mut parts = wgsl.split(call);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let mut open = 1;
        let end = part.find(|letter| {
            open += i32::from(letter == '(') - i32::from(letter == ')');
            open == 0
        });
        let (inside, after) = part.split_at(end.map_or(part.len(), |end| end + 1));
        text.extend([call, inside, ".x", after]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_channel_is_taken_of_the_whole_call() {
        let wgsl = "a = load(t, f(p), 0) - b; c = max(load(t, p, 0), load(u, p, 0));";
        let taken = "a = load(t, f(p), 0).x - b; c = max(load(t, p, 0).x, load(u, p, 0));";
        assert_eq!(first_channel(wgsl, "load(t,"), taken);
    }
}
