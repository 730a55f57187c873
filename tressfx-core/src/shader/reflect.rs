//! The bindings of a shader, read off the naga module.

use std::fmt;

use naga::common::wgsl::TypeContext;
use naga::{AddressSpace, GlobalVariable, ImageClass, StorageAccess, TypeInner};

use super::ShaderStage;
use crate::error::{Error, Label, Result};

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
    /// Bytes that a buffer must have at least; 0 for textures.
    pub min_bytes: u64,
}

impl ShaderSlot {
    /// Whether it counts against the limit of storage buffers.
    pub fn is_storage(&self) -> bool {
        matches!(self.kind, SlotKind::Read | SlotKind::ReadWrite)
    }
}

/// What a slot takes; whether a buffer is written comes from the WGSL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotKind {
    /// `var<uniform>`
    Uniform,
    /// `var<storage, read>`
    Read,
    /// `var<storage, read_write>`
    ReadWrite,
    /// `texture_2d<f32>`, loaded, not filtered
    Texture,
    /// `texture_depth_2d`
    DepthTexture,
}

impl fmt::Display for SlotKind {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(match self {
            Self::Uniform => "uniform",
            Self::Read => "read",
            Self::ReadWrite => "read_write",
            Self::Texture => "texture",
            Self::DepthTexture => "depth_texture",
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
    pub fn has(self, other: Self) -> bool {
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
        let kind = kind(module, variable).ok_or_else(|| refuse("neither a buffer nor a 2D texture"))?;
        let min_bytes = match kind {
            SlotKind::Texture | SlotKind::DepthTexture => 0,
            _ => u64::from(module.types[variable.ty].inner.size(module.to_ctx())),
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

fn kind(module: &naga::Module, variable: &GlobalVariable) -> Option<SlotKind> {
    match (variable.space, &module.types[variable.ty].inner) {
        (AddressSpace::Uniform, _) => Some(SlotKind::Uniform),
        (AddressSpace::Storage { access }, _) if access.contains(StorageAccess::STORE) => Some(SlotKind::ReadWrite),
        (AddressSpace::Storage { .. }, _) => Some(SlotKind::Read),
        (AddressSpace::Handle, TypeInner::Image { class: ImageClass::Sampled { multi: false, .. }, .. }) => {
            Some(SlotKind::Texture)
        }
        (AddressSpace::Handle, TypeInner::Image { class: ImageClass::Depth { multi: false }, .. }) => {
            Some(SlotKind::DepthTexture)
        }
        _ => None,
    }
}
