//! A shader written out in the languages of engines, one entry point a text.

use std::fmt::Write;

#[cfg(feature = "glsl")]
use naga::back::glsl::Version;

#[cfg(any(feature = "hlsl", feature = "msl"))]
use super::SlotKind;
#[cfg(feature = "spirv")]
use super::SpirvOptions;
#[cfg(feature = "glsl")]
use super::glsl;
#[cfg(feature = "hlsl")]
use super::hlsl;
#[cfg(feature = "msl")]
use super::msl;
use super::{Shader, ShaderSlot, ShaderStage};
use crate::error::Result;

/// A language that a shader is written out in; each but WGSL is a feature of this crate. Bindings keep the numbers of the WGSL: see [`Language::place`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Language {
    /// The composed WGSL with all its entry points, as an application would give it to WebGPU.
    Wgsl,
    #[cfg(feature = "spirv")]
    /// SPIR-V 1.6 for Vulkan 1.3. It relies on no robustness of the device; [`Shader::spirv`] can.
    Spirv,
    #[cfg(feature = "hlsl")]
    /// HLSL for shader model 6.0. Slots lie in space 0: `b` registers are uniforms, `t` what is read, `u` what is written.
    /// Storage buffers are byte address buffers. A constant buffer in space 1 brings the number of groups.
    Hlsl,
    #[cfg(feature = "msl")]
    /// The Metal Shading Language 2.4. Buffer 30 brings the sizes of the buffers whose length the WGSL leaves open. No test
    /// checks it: its compiler runs on Apple's machines only.
    Msl,
    #[cfg(feature = "glsl")]
    /// GLSL 4.50 for OpenGL 4.5. Names of slots begin with `g_`. A depth texture is read without comparison.
    Glsl,
    #[cfg(feature = "glsl")]
    /// The same in GLSL ES 3.10 for OpenGL ES 3.1; the kernels bind more storage buffers than each such device has.
    Essl,
}

impl Language {
    /// Those that this build writes.
    pub const ALL: &'static [Self] = &[
        Self::Wgsl,
        #[cfg(feature = "spirv")]
        Self::Spirv,
        #[cfg(feature = "hlsl")]
        Self::Hlsl,
        #[cfg(feature = "msl")]
        Self::Msl,
        #[cfg(feature = "glsl")]
        Self::Glsl,
        #[cfg(feature = "glsl")]
        Self::Essl,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            #[cfg(feature = "spirv")]
            Self::Spirv => "spirv",
            #[cfg(feature = "hlsl")]
            Self::Hlsl => "hlsl",
            #[cfg(feature = "msl")]
            Self::Msl => "msl",
            #[cfg(feature = "glsl")]
            Self::Glsl => "glsl",
            #[cfg(feature = "glsl")]
            Self::Essl => "essl",
        }
    }

    /// What its files end in.
    pub fn ending(self) -> &'static str {
        match self {
            #[cfg(feature = "spirv")]
            Self::Spirv => "spv",
            #[cfg(feature = "msl")]
            Self::Msl => "metal",
            other => other.name(),
        }
    }

    /// Where a slot is bound, in the words of the language. It is always the number of the WGSL.
    pub fn place(self, slot: &ShaderSlot) -> String {
        let number = slot.binding;
        match (self, slot.kind) {
            (Self::Wgsl, _) => format!("@group(0) @binding({number})"),
            #[cfg(feature = "spirv")]
            (Self::Spirv, _) => format!("DescriptorSet 0 Binding {number}"),
            #[cfg(feature = "hlsl")]
            (Self::Hlsl, SlotKind::Uniform) => format!("register(b{number})"),
            #[cfg(feature = "hlsl")]
            (Self::Hlsl, kind) if kind.is_written() => format!("register(u{number})"),
            #[cfg(feature = "hlsl")]
            (Self::Hlsl, SlotKind::Sampler) => format!("register(s{number})"),
            #[cfg(feature = "hlsl")]
            (Self::Hlsl, _) => format!("register(t{number})"),
            #[cfg(feature = "msl")]
            (Self::Msl, SlotKind::Sampler) => format!("[[sampler({number})]]"),
            #[cfg(feature = "msl")]
            (Self::Msl, kind) if kind.is_texture() => format!("[[texture({number})]]"),
            #[cfg(feature = "msl")]
            (Self::Msl, _) => format!("[[buffer({number})]]"),
            #[cfg(feature = "glsl")]
            (Self::Glsl | Self::Essl, _) => format!("binding = {number}"),
        }
    }
}

/// One entry point in one language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Emitted {
    /// What its compiler takes: text, or the words of SPIR-V in the byte order of this machine.
    pub code: Vec<u8>,
    /// What the entry point is called there; a name that the language keeps to itself is changed.
    pub entry_point: String,
    /// What has to be bound beside the slots of the shader.
    pub extra: Option<Extra>,
}

/// A small constant buffer that only one language asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Extra {
    /// Its name in the text.
    pub name: &'static str,
    /// Where it is bound, in the words of the language.
    pub place: &'static str,
    /// What each of its `u32` holds.
    pub holds: Vec<String>,
}

impl Shader {
    /// Writes the entry point of a stage in a language.
    ///
    /// Clip space and the origin of pictures are WebGPU's. OpenGL's are not: there, the vertex shader turns y and stretches
    /// z, so that the first row of a target is the top of the picture and its depths are from 0 to 1. As in
    /// [`Shader::spirv`], group memory is not zeroed and loops are not bounded. Draws begin with vertex 0 and instance 0, and
    /// OpenGL's uniform `naga_vs_first_instance` stays 0.
    ///
    /// # Errors
    /// [`Error::Shader`](crate::Error::Shader) if there is no such entry point, or with what naga says.
    pub fn emit(&self, stage: ShaderStage, language: Language) -> Result<Emitted> {
        let mut emitted = match language {
            Language::Wgsl => self.emitted(stage, self.wgsl.as_bytes())?,
            #[cfg(feature = "spirv")]
            Language::Spirv => {
                let options =
                    SpirvOptions { version: (1, 6), robust_buffers: false, robust_textures: false, names: true };
                return self.emitted(stage, bytemuck::cast_slice(&self.spirv(stage, &options)?));
            }
            #[cfg(feature = "hlsl")]
            Language::Hlsl => hlsl::write(self, stage)?,
            #[cfg(feature = "msl")]
            Language::Msl => msl::write(self, stage)?,
            #[cfg(feature = "glsl")]
            Language::Glsl => glsl::write(self, stage, Version::Desktop(450))?,
            #[cfg(feature = "glsl")]
            Language::Essl => glsl::write(self, stage, Version::new_gles(310))?,
        };
        // The first line of GLSL has to say its version.
        let has_version = emitted.code.starts_with(b"#version");
        let place =
            if has_version { emitted.code.iter().position(|&byte| byte == b'\n').map_or(0, |end| end + 1) } else { 0 };
        let header = self.header(stage, language, &emitted);
        emitted.code.splice(place..place, header.into_bytes());
        Ok(emitted)
    }

    fn emitted(&self, stage: ShaderStage, code: &[u8]) -> Result<Emitted> {
        Ok(Emitted { code: code.to_vec(), entry_point: self.entry_point(stage)?.name.clone(), extra: None })
    }

    /// The slots that a stage sees.
    pub fn slots_of(&self, stage: ShaderStage) -> impl Iterator<Item = &ShaderSlot> {
        let stage = super::Stages::from(stage);
        self.slots.iter().filter(move |slot| slot.stages.intersects(stage))
    }

    fn header(&self, stage: ShaderStage, language: Language, emitted: &Emitted) -> String {
        let mut header = format!("// {}, {stage:?} stage: {}\n", self.label, emitted.entry_point);
        if !self.features.is_empty() {
            let _ = writeln!(header, "// specialised on {}", self.features);
        }
        for slot in self.slots_of(stage) {
            let _ = writeln!(header, "// {}: {}, {}", language.place(slot), slot.name, slot.kind);
        }
        if let Some(Extra { name, place, holds }) = &emitted.extra {
            let _ = writeln!(header, "// {place}: {name}, {}", holds.join(", "));
        }
        header.push('\n');
        header
    }

    /// An error of a back end of naga.
    #[cfg(any(feature = "spirv", feature = "hlsl", feature = "msl", feature = "glsl"))]
    pub(super) fn refused(&self, error: impl std::fmt::Display) -> crate::Error {
        crate::Error::Shader { label: self.label, message: error.to_string() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::{ShaderSource, Specialization};

    const KERNEL: &str = "
        @group(0) @binding(2) var<storage, read_write> things: array<f32>;
        @compute @workgroup_size(64)
        fn length(@builtin(global_invocation_id) id: vec3<u32>) { things[id.x] *= 2.0; }";

    #[test]
    fn an_entry_point_has_a_name_that_the_language_allows() {
        let source = ShaderSource { label: "test.kernel", root: ("kernel", KERNEL), library: &[] };
        let shader = Shader::new(&source, &Specialization::new()).unwrap();
        let name = |language| shader.emit(ShaderStage::Compute, language).unwrap().entry_point;
        for &language in Language::ALL {
            let expected = match language.name() {
                "hlsl" => "length_",
                "glsl" | "essl" => "main",
                _ => "length",
            };
            assert_eq!(name(language), expected, "{language:?}");
            let error = shader.emit(ShaderStage::Vertex, language).unwrap_err();
            assert_eq!(error.to_string(), "test.kernel: no Vertex entry point");
        }
    }
}
