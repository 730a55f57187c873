//! Shaders: WGSL composed, parsed and validated once, with their bindings reflected.
//!
//! A backend gets the naga module and emits what its API takes: wgpu takes it as it is, Vulkan writes SPIR-V from it.
//! Engines that compile shaders by themselves are given them by [`Shader::emit`].

mod bindings;
mod compose;
mod emit;
mod glsl;
mod hlsl;
mod layout;
mod msl;
mod pipeline;
mod reflect;
mod spirv;

pub use bindings::{Binding, Bindings, Sampler};
pub use compose::{Module, ShaderSource, Specialization, shared_modules};
pub use emit::{Emitted, Extra, Language};
pub use layout::{FieldLayout, GpuStruct, StructLayout};
pub use pipeline::{Kernel, RasterPipeline};
pub use reflect::{ShaderSlot, SlotKind, Stages};
pub use spirv::SpirvOptions;

use crate::error::{Error, Label, Result};

/// A shader that is ready for any backend.
#[derive(Debug)]
pub struct Shader {
    /// The kernel's label.
    pub label: Label,
    /// What it was specialised on, for people to read: features that are on, and constants.
    pub features: String,
    /// The same, for programs.
    pub specialization: Specialization,
    /// The composed WGSL.
    pub wgsl: String,
    /// The parsed module.
    pub module: naga::Module,
    /// What validation found out about it.
    pub info: naga::valid::ModuleInfo,
    /// Its bindings, all in `@group(0)`, by ascending number.
    pub slots: Vec<ShaderSlot>,
}

impl Shader {
    /// Composes `source`, parses, validates and reflects it.
    ///
    /// # Errors
    /// [`Error::Shader`] with the compiler's message.
    pub fn new(source: &ShaderSource, specialization: &Specialization) -> Result<Self> {
        Self::parse(source.label, specialization, compose::compose(source, specialization)?)
    }

    fn parse(label: Label, specialization: &Specialization, wgsl: String) -> Result<Self> {
        let module = naga::front::wgsl::parse_str(&wgsl)
            .map_err(|error| Error::Shader { label, message: error.emit_to_string(&wgsl) })?;
        // naga counts pack2x16float, which is core WGSL, among what a device may lack.
        let capabilities = naga::valid::Capabilities::default() | naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        let info = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
            .validate(&module)
            .map_err(|error| Error::Shader { label, message: error.emit_to_string(&wgsl) })?;
        if let Some((_, constant)) = module.overrides.iter().next() {
            let name = constant.name.as_deref().unwrap_or("a constant");
            let message = format!("`{name}` is to be overridden: constants come with the specialization");
            return Err(Error::Shader { label, message });
        }
        let slots = reflect::slots(label, &module, &info)?;
        let features = specialization.to_string();
        Ok(Self { label, features, specialization: specialization.clone(), wgsl, module, info, slots })
    }

    /// The entry point of a stage.
    ///
    /// # Errors
    /// [`Error::Shader`] if there is none, or more than one.
    pub fn entry_point(&self, stage: naga::ShaderStage) -> Result<&naga::EntryPoint> {
        let mut found = self.module.entry_points.iter().filter(|entry| entry.stage == stage);
        match (found.next(), found.next()) {
            (Some(entry), None) => Ok(entry),
            (None, _) => Err(Error::Shader { label: self.label, message: format!("no {stage:?} entry point") }),
            (Some(_), Some(_)) => {
                Err(Error::Shader { label: self.label, message: format!("more than one {stage:?} entry point") })
            }
        }
    }

    /// Storage buffers that the shader binds in its busiest stage.
    pub fn storage_buffers(&self) -> u32 {
        let count =
            |stage: Stages| self.slots.iter().filter(|slot| slot.is_storage() && slot.stages.intersects(stage)).count();
        [Stages::COMPUTE, Stages::VERTEX, Stages::FRAGMENT].into_iter().map(count).max().unwrap_or(0) as u32
    }

    /// Textures that a compute pass of it writes.
    pub fn storage_textures(&self) -> u32 {
        self.slots.iter().filter(|slot| matches!(slot.kind, SlotKind::StorageTexture(_))).count() as u32
    }

    /// Whether its fragment stage writes buffers.
    pub fn writes_in_fragments(&self) -> bool {
        self.slots.iter().any(|slot| slot.kind.is_written() && slot.stages.intersects(Stages::FRAGMENT))
    }

    /// Threads of a compute group along x, y and z, and bytes that a group shares.
    ///
    /// # Errors
    /// As [`Shader::entry_point`].
    pub fn group(&self) -> Result<([u32; 3], u32)> {
        let size = self.entry_point(naga::ShaderStage::Compute)?.workgroup_size;
        let index = self.module.entry_points.iter().position(|entry| entry.stage == naga::ShaderStage::Compute);
        Ok((size, index.map_or(0, |index| reflect::group_memory(&self.module, &self.info, index))))
    }

    /// Whether it has a fragment stage.
    pub fn has_fragment_stage(&self) -> bool {
        self.module.entry_points.iter().any(|entry| entry.stage == naga::ShaderStage::Fragment)
    }

    /// The colours that the fragment stage gives: target and type in the WGSL.
    ///
    /// # Errors
    /// As [`Shader::entry_point`], or if the fragment stage is given what the vertex stage does not hand on.
    pub fn colors(&self) -> Result<Vec<(u32, String)>> {
        let vertex = self.entry_point(naga::ShaderStage::Vertex)?;
        if let Some((location, ty)) = reflect::inputs(&self.module, vertex).first() {
            let message = format!("the vertex stage is given {ty} at location {location}: there are no vertex buffers");
            return Err(Error::Shader { label: self.label, message });
        }
        if !self.has_fragment_stage() {
            return Ok(Vec::new());
        }
        let fragment = self.entry_point(naga::ShaderStage::Fragment)?;
        let handed = reflect::outputs(&self.module, vertex);
        match reflect::inputs(&self.module, fragment).into_iter().find(|input| !handed.contains(input)) {
            Some((location, ty)) => Err(Error::Shader {
                label: self.label,
                message: format!(
                    "the fragment stage is given {ty} at location {location}, the vertex stage hands on {handed:?}"
                ),
            }),
            None => Ok(reflect::outputs(&self.module, fragment)),
        }
    }
}
