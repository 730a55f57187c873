//! Shaders: WGSL composed, parsed and validated once, with their bindings reflected.
//!
//! What was made once is kept for the process: the next groom of the same kind gets its shaders at once. A backend writes
//! what its API takes: wgpu takes the parsed module as it is (feature `naga-ir`), Vulkan SPIR-V (feature `spirv`). Engines
//! that compile shaders by themselves are given them by [`Shader::emit`], in the languages whose features are on.

mod bindings;
mod cache;
mod compose;
mod emit;
mod entry_point;
#[cfg(feature = "glsl")]
mod glsl;
#[cfg(feature = "hlsl")]
mod hlsl;
mod layout;
#[cfg(feature = "msl")]
mod msl;
mod pipeline;
mod reflect;
#[cfg(feature = "spirv")]
mod spirv;

use std::fmt;
use std::sync::Arc;

pub use bindings::{Binding, Bindings, Sampler};
pub use compose::{Module, ShaderSource, Specialization, shared_modules};
pub use emit::{Emitted, Extra, Language};
pub use entry_point::{EntryPoint, ShaderStage};
pub use layout::{FieldLayout, GpuStruct, StructLayout};
pub use pipeline::{Kernel, RasterPipeline};
pub use reflect::{ShaderSlot, SlotKind, Stages};
#[cfg(feature = "spirv")]
pub use spirv::SpirvOptions;

use crate::error::{Error, Label, Result};

/// A shader that is ready for any backend. Cheap to clone.
#[derive(Clone)]
pub struct Shader {
    /// The kernel's label.
    pub label: Label,
    /// What it was specialised on, for people to read: features that are on, and constants.
    pub features: String,
    /// The same, for programs.
    pub specialization: Specialization,
    /// The composed WGSL.
    pub wgsl: Arc<str>,
    /// Where its stages begin.
    pub entry_points: Vec<EntryPoint>,
    /// Its bindings, all in `@group(0)`, by ascending number.
    pub slots: Vec<ShaderSlot>,
    parsed: Arc<Parsed>,
}

/// What naga made of a shader.
struct Parsed {
    module: naga::Module,
    /// What validation found out about the module.
    #[cfg_attr(
        not(any(feature = "spirv", feature = "hlsl", feature = "msl", feature = "glsl", feature = "naga-ir")),
        expect(dead_code, reason = "only writers look at it")
    )]
    info: naga::valid::ModuleInfo,
}

impl fmt::Debug for Shader {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.debug_struct("Shader").field("label", &self.label).field("features", &self.features).finish_non_exhaustive()
    }
}

impl Shader {
    /// Composes `source`, parses, validates and reflects it; or gives what was made of it before.
    ///
    /// # Errors
    /// [`Error::Shader`] with the compiler's message.
    pub fn new(source: &ShaderSource, specialization: &Specialization) -> Result<Self> {
        cache::get_or_make(source, specialization, || {
            Self::parse(source.label, specialization, compose::compose(source, specialization)?)
        })
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
        Ok(Self {
            label,
            features: specialization.to_string(),
            specialization: specialization.clone(),
            wgsl: wgsl.into(),
            entry_points: entry_point::entry_points(&module, &info),
            slots: reflect::slots(label, &module, &info)?,
            parsed: Arc::new(Parsed { module, info }),
        })
    }

    /// The module that naga parsed.
    #[cfg(feature = "naga-ir")]
    pub fn module(&self) -> &naga::Module {
        &self.parsed.module
    }

    /// What validation found out about the module.
    #[cfg(feature = "naga-ir")]
    pub fn module_info(&self) -> &naga::valid::ModuleInfo {
        &self.parsed.info
    }

    /// The entry point of a stage.
    ///
    /// # Errors
    /// [`Error::Shader`] if there is none, or more than one.
    pub fn entry_point(&self, stage: ShaderStage) -> Result<&EntryPoint> {
        let mut found = self.entry_points.iter().filter(|entry| entry.stage == stage);
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
        self.slots
            .iter()
            .filter(|slot| matches!(slot.kind, SlotKind::StorageTexture(_) | SlotKind::ReadWriteTexture(_)))
            .count() as u32
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
        let entry = self.entry_point(ShaderStage::Compute)?;
        Ok((entry.workgroup_size.unwrap_or([1; 3]), entry.group_memory))
    }

    /// Whether it has a fragment stage.
    pub fn has_fragment_stage(&self) -> bool {
        self.entry_points.iter().any(|entry| entry.stage == ShaderStage::Fragment)
    }

    /// The colours that the fragment stage gives: target and type in the WGSL.
    ///
    /// # Errors
    /// As [`Shader::entry_point`], or if the fragment stage is given what the vertex stage does not hand on.
    pub fn colors(&self) -> Result<Vec<(u32, String)>> {
        let vertex = self.entry_point(ShaderStage::Vertex)?;
        if let Some((location, ty)) = vertex.inputs.first() {
            let message = format!("the vertex stage is given {ty} at location {location}: there are no vertex buffers");
            return Err(Error::Shader { label: self.label, message });
        }
        if !self.has_fragment_stage() {
            return Ok(Vec::new());
        }
        let fragment = self.entry_point(ShaderStage::Fragment)?;
        let handed = &vertex.outputs;
        match fragment.inputs.iter().find(|input| !handed.contains(input)) {
            Some((location, ty)) => Err(Error::Shader {
                label: self.label,
                message: format!(
                    "the fragment stage is given {ty} at location {location}, the vertex stage hands on {handed:?}"
                ),
            }),
            None => Ok(fragment.outputs.clone()),
        }
    }
}
