//! The bindings of a shader, read off the naga module.

use std::fmt;

use naga::common::wgsl::TypeContext;
use naga::{
    AddressSpace, Binding, GlobalVariable, Handle, ImageClass, ScalarKind, StorageAccess, StorageFormat, TypeInner,
};

use super::ShaderStage;
use crate::error::{Error, Label, Result};
use crate::format::Format;

/// What a shader binds in one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderSlot {
    /// The name in the WGSL.
    pub name: String,
    /// The number in the WGSL.
    pub binding: u32,
    /// What has to be bound.
    pub kind: SlotKind,
    /// The type in the WGSL, such as `array<vec4<f32>>`.
    pub type_name: String,
    /// Which stages see it.
    pub stages: Stages,
    /// Bytes that a buffer must have at least; 0 for what is no buffer.
    pub min_bytes: u64,
}

impl ShaderSlot {
    /// Whether it counts against the limit of storage buffers.
    pub fn is_storage(&self) -> bool {
        matches!(self.kind, SlotKind::Read | SlotKind::ReadWrite)
    }
}

/// What a slot takes; whether a resource is written comes from the WGSL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SlotKind {
    /// `var<uniform>`
    Uniform,
    /// `var<storage, read>`
    Read,
    /// `var<storage, read_write>`
    ReadWrite,
    /// `texture_2d<f32>`, loaded, not filtered
    Texture,
    /// `texture_2d<f32>`, read through a sampler
    FilteredTexture,
    /// `texture_2d<u32>`
    UintTexture,
    /// `texture_depth_2d`, loaded
    DepthTexture,
    /// `texture_storage_2d<FORMAT, write>`
    StorageTexture(Format),
    /// `texture_storage_2d<FORMAT, read_write>`
    ReadWriteTexture(Format),
    /// `sampler`
    Sampler,
}

impl SlotKind {
    /// Whether a buffer is bound.
    pub fn is_buffer(self) -> bool {
        matches!(self, Self::Uniform | Self::Read | Self::ReadWrite)
    }

    /// Whether a texture is bound.
    pub fn is_texture(self) -> bool {
        !self.is_buffer() && self != Self::Sampler
    }

    /// Whether the shader writes it.
    pub fn is_written(self) -> bool {
        matches!(self, Self::ReadWrite | Self::StorageTexture(_) | Self::ReadWriteTexture(_))
    }
}

impl fmt::Display for SlotKind {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(match self {
            Self::Uniform => "uniform",
            Self::Read => "read",
            Self::ReadWrite => "read_write",
            Self::Texture => "texture",
            Self::FilteredTexture => "filtered_texture",
            Self::UintTexture => "uint_texture",
            Self::DepthTexture => "depth_texture",
            Self::StorageTexture(_) => "storage_texture",
            Self::ReadWriteTexture(_) => "read_write_texture",
            Self::Sampler => "sampler",
        })
    }
}

/// A set of shader stages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stages(u8);

impl Stages {
    /// The compute stage.
    pub const COMPUTE: Self = Self(1);
    /// The vertex stage.
    pub const VERTEX: Self = Self(2);
    /// The fragment stage.
    pub const FRAGMENT: Self = Self(4);

    /// Whether any of `other` is among them.
    pub fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

impl From<ShaderStage> for Stages {
    fn from(stage: ShaderStage) -> Self {
        match stage {
            ShaderStage::Compute => Self::COMPUTE,
            ShaderStage::Vertex => Self::VERTEX,
            ShaderStage::Fragment => Self::FRAGMENT,
        }
    }
}

impl std::ops::BitOr for Stages {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// The largest number of a binding that every device takes.
const MAX_BINDING: u32 = 999;

/// The slots of a module, by ascending number.
pub(super) fn slots(label: Label, module: &naga::Module, info: &naga::valid::ModuleInfo) -> Result<Vec<ShaderSlot>> {
    let mut slots = Vec::new();
    for (handle, variable) in module.global_variables.iter() {
        let Some(binding) = &variable.binding else { continue };
        let mut stages = Stages::default();
        for (index, entry) in module.entry_points.iter().enumerate() {
            if !info.get_entry_point(index)[handle].is_empty() {
                stages = stages | ShaderStage::of(entry.stage).map(Stages::from).unwrap_or_default();
            }
        }
        if stages == Stages::default() {
            continue;
        }
        let name = variable.name.clone().unwrap_or_default();
        let refuse = |why: &str| Error::Shader { label, message: format!("binding `{name}`: {why}") };
        if binding.group != 0 {
            return Err(refuse("only @group(0) is used"));
        }
        if binding.binding > MAX_BINDING {
            return Err(refuse("its number is above 999"));
        }
        let kind = kind(module, info, handle).ok_or_else(|| refuse("no kind of binding that the contract has"))?;
        if kind == SlotKind::DepthTexture && is_sampled(module, info, handle) {
            return Err(refuse("depth is loaded, not sampled"));
        }
        let min_bytes = match kind.is_buffer() {
            true => u64::from(module.types[variable.ty].inner.size(module.to_ctx())),
            false => 0,
        };
        let type_name = module.to_ctx().type_to_string(variable.ty);
        slots.push(ShaderSlot { name: name.clone(), binding: binding.binding, kind, type_name, stages, min_bytes });
    }
    slots.sort_by_key(|slot| slot.binding);
    if let Some(pair) = slots.windows(2).find(|pair| pair[0].binding == pair[1].binding) {
        let message = format!("`{}` and `{}` have the same binding number", pair[0].name, pair[1].name);
        return Err(Error::Shader { label, message });
    }
    Ok(slots)
}

fn kind(module: &naga::Module, info: &naga::valid::ModuleInfo, handle: Handle<GlobalVariable>) -> Option<SlotKind> {
    let variable = &module.global_variables[handle];
    let TypeInner::Image { dim: naga::ImageDimension::D2, arrayed: false, class } = module.types[variable.ty].inner
    else {
        return match (variable.space, &module.types[variable.ty].inner) {
            (AddressSpace::Uniform, _) => Some(SlotKind::Uniform),
            (AddressSpace::Storage { access }, _) if access.contains(StorageAccess::STORE) => Some(SlotKind::ReadWrite),
            (AddressSpace::Storage { .. }, _) => Some(SlotKind::Read),
            (AddressSpace::Handle, TypeInner::Sampler { comparison: false }) => Some(SlotKind::Sampler),
            _ => None,
        };
    };
    match class {
        ImageClass::Sampled { multi: false, kind: ScalarKind::Float } => {
            Some(if is_sampled(module, info, handle) { SlotKind::FilteredTexture } else { SlotKind::Texture })
        }
        ImageClass::Sampled { multi: false, kind: ScalarKind::Uint } => Some(SlotKind::UintTexture),
        ImageClass::Depth { multi: false } => Some(SlotKind::DepthTexture),
        ImageClass::Storage { format, access } if access == StorageAccess::STORE => {
            storage_format(format).map(SlotKind::StorageTexture)
        }
        ImageClass::Storage { format, access } if access == StorageAccess::LOAD | StorageAccess::STORE => {
            storage_format(format).map(SlotKind::ReadWriteTexture)
        }
        _ => None,
    }
}

fn storage_format(format: StorageFormat) -> Option<Format> {
    match format {
        StorageFormat::Rgba8Unorm => Some(Format::Rgba8),
        StorageFormat::Rgba16Float => Some(Format::Rgba16F),
        StorageFormat::R32Float => Some(Format::R32F),
        StorageFormat::R32Uint => Some(Format::R32Uint),
        _ => None,
    }
}

/// Whether any entry point reads a texture through a sampler.
fn is_sampled(module: &naga::Module, info: &naga::valid::ModuleInfo, texture: Handle<GlobalVariable>) -> bool {
    let mut pairs = (0..module.entry_points.len()).flat_map(|index| &info.get_entry_point(index).sampling_set);
    pairs.any(|pair| pair.image == texture)
}

/// What a stage hands on at a location: the type in the WGSL.
pub(super) type Varying = (u32, String);

/// What an entry point is given at locations.
pub(super) fn inputs(module: &naga::Module, entry: &naga::EntryPoint) -> Vec<Varying> {
    let arguments = &entry.function.arguments;
    arguments.iter().flat_map(|argument| varyings(module, argument.ty, argument.binding.as_ref())).collect()
}

/// What an entry point gives at locations.
pub(super) fn outputs(module: &naga::Module, entry: &naga::EntryPoint) -> Vec<Varying> {
    let result = entry.function.result.iter();
    result.flat_map(|result| varyings(module, result.ty, result.binding.as_ref())).collect()
}

fn varyings(module: &naga::Module, ty: Handle<naga::Type>, binding: Option<&Binding>) -> Vec<Varying> {
    match (binding, &module.types[ty].inner) {
        (Some(Binding::Location { location, .. }), _) => vec![(*location, module.to_ctx().type_to_string(ty))],
        (Some(_), _) => Vec::new(),
        (None, TypeInner::Struct { members, .. }) => {
            members.iter().flat_map(|member| varyings(module, member.ty, member.binding.as_ref())).collect()
        }
        (None, _) => Vec::new(),
    }
}

/// Bytes that a group of a compute entry point shares.
pub(super) fn group_memory(module: &naga::Module, info: &naga::valid::ModuleInfo, entry: usize) -> u32 {
    let used = info.get_entry_point(entry);
    let shared = module
        .global_variables
        .iter()
        .filter(|(handle, variable)| variable.space == AddressSpace::WorkGroup && !used[*handle].is_empty());
    shared.map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx())).sum()
}
