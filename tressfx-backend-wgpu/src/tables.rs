//! Words of the contract in words of wgpu, and back.

use std::fmt::Debug;

use tressfx_core::backend::{Blend, BufferUses, Depth, DepthOrder, Format, TextureUses};
use tressfx_core::error::{Error, Result};
use tressfx_core::shader::{ShaderSlot, SlotKind, Stages};
use wgpu::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, BufferUsages, CompareFunction, TextureFormat,
    TextureUsages,
};

/// The contract may grow by what this backend does not know yet.
fn unknown<T>(word: impl Debug) -> Result<T> {
    Err(Error::Backend { label: "wgpu", message: format!("{word:?} is not known to this backend") })
}

const BUFFER_USES: [(BufferUses, BufferUsages); 5] = [
    (BufferUses::STORAGE, BufferUsages::STORAGE),
    (BufferUses::UNIFORM, BufferUsages::UNIFORM),
    (BufferUses::INDIRECT, BufferUsages::INDIRECT),
    (BufferUses::COPY_SOURCE, BufferUsages::COPY_SRC),
    (BufferUses::COPY_DESTINATION, BufferUsages::COPY_DST),
];

const TEXTURE_USES: [(TextureUses, TextureUsages); 5] = [
    (TextureUses::TARGET, TextureUsages::RENDER_ATTACHMENT),
    (TextureUses::SAMPLED, TextureUsages::TEXTURE_BINDING),
    (TextureUses::STORAGE, TextureUsages::STORAGE_BINDING),
    (TextureUses::COPY_SOURCE, TextureUsages::COPY_SRC),
    (TextureUses::COPY_DESTINATION, TextureUsages::COPY_DST),
];

const FORMATS: [(Format, TextureFormat); 13] = [
    (Format::Rgba8, TextureFormat::Rgba8Unorm),
    (Format::Rgba8Srgb, TextureFormat::Rgba8UnormSrgb),
    (Format::Bgra8, TextureFormat::Bgra8Unorm),
    (Format::Bgra8Srgb, TextureFormat::Bgra8UnormSrgb),
    (Format::Rgba16F, TextureFormat::Rgba16Float),
    (Format::Rgb10A2, TextureFormat::Rgb10a2Unorm),
    (Format::R11G11B10F, TextureFormat::Rg11b10Ufloat),
    (Format::R16F, TextureFormat::R16Float),
    (Format::Rg16F, TextureFormat::Rg16Float),
    (Format::Rg32F, TextureFormat::Rg32Float),
    (Format::R32F, TextureFormat::R32Float),
    (Format::R32Uint, TextureFormat::R32Uint),
    (Format::Depth32F, TextureFormat::Depth32Float),
];

pub(crate) fn buffer_usages(uses: BufferUses) -> BufferUsages {
    let set = BUFFER_USES.iter().filter(|(ours, _)| uses.contains(*ours));
    set.fold(BufferUsages::empty(), |all, (_, theirs)| all | *theirs)
}

pub(crate) fn buffer_uses(usages: BufferUsages) -> BufferUses {
    let set = BUFFER_USES.iter().filter(|(_, theirs)| usages.contains(*theirs));
    set.fold(BufferUses::default(), |all, (ours, _)| all | *ours)
}

pub(crate) fn texture_usages(uses: TextureUses) -> TextureUsages {
    let set = TEXTURE_USES.iter().filter(|(ours, _)| uses.contains(*ours));
    set.fold(TextureUsages::empty(), |all, (_, theirs)| all | *theirs)
}

pub(crate) fn texture_uses(usages: TextureUsages) -> TextureUses {
    let set = TEXTURE_USES.iter().filter(|(_, theirs)| usages.contains(*theirs));
    set.fold(TextureUses::default(), |all, (ours, _)| all | *ours)
}

pub(crate) fn texture_format(format: Format) -> Result<TextureFormat> {
    let found = FORMATS.iter().find(|(ours, _)| *ours == format);
    found.map_or_else(|| unknown(format), |(_, theirs)| Ok(*theirs))
}

/// The format as the contract names it, if it has it.
pub(crate) fn format(format: TextureFormat) -> Option<Format> {
    FORMATS.iter().find(|(_, theirs)| *theirs == format).map(|(ours, _)| *ours)
}

pub(crate) fn blend_state(blend: Blend) -> Result<Option<BlendState>> {
    use BlendFactor::{Dst, One, OneMinusSrcAlpha, Zero};
    let (src_factor, dst_factor, operation) = match blend {
        Blend::Replace => return Ok(None),
        Blend::Over => (One, OneMinusSrcAlpha, BlendOperation::Add),
        Blend::Add => (One, One, BlendOperation::Add),
        Blend::Multiply => (Dst, Zero, BlendOperation::Add),
        Blend::Min => (One, One, BlendOperation::Min),
        Blend::Max => (One, One, BlendOperation::Max),
        other => return unknown(other),
    };
    let component = BlendComponent { src_factor, dst_factor, operation };
    Ok(Some(BlendState { color: component, alpha: component }))
}

pub(crate) fn depth_state(depth: Depth) -> Result<Option<wgpu::DepthStencilState>> {
    let (order, writes) = match depth {
        Depth::Off => return Ok(None),
        Depth::Test(order) => (order, false),
        Depth::TestWrite(order) => (order, true),
        other => return unknown(other),
    };
    let nearer = match order {
        DepthOrder::Standard => CompareFunction::LessEqual,
        DepthOrder::Reverse => CompareFunction::GreaterEqual,
    };
    Ok(Some(wgpu::DepthStencilState {
        format: TextureFormat::Depth32Float,
        depth_write_enabled: Some(writes),
        depth_compare: Some(nearer),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }))
}

pub(crate) fn layout_entry(slot: &ShaderSlot) -> Result<wgpu::BindGroupLayoutEntry> {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: std::num::NonZeroU64::new(slot.min_bytes),
    };
    let view_dimension = wgpu::TextureViewDimension::D2;
    let texture = |sample_type| wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
    let ty = match slot.kind {
        SlotKind::Uniform => buffer(wgpu::BufferBindingType::Uniform),
        SlotKind::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
        SlotKind::ReadWrite => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
        SlotKind::Texture => texture(wgpu::TextureSampleType::Float { filterable: false }),
        SlotKind::FilteredTexture => texture(wgpu::TextureSampleType::Float { filterable: true }),
        SlotKind::UintTexture => texture(wgpu::TextureSampleType::Uint),
        SlotKind::DepthTexture => texture(wgpu::TextureSampleType::Depth),
        SlotKind::StorageTexture(format) => storage_texture(format, wgpu::StorageTextureAccess::WriteOnly)?,
        SlotKind::ReadWriteTexture(format) => storage_texture(format, wgpu::StorageTextureAccess::ReadWrite)?,
        SlotKind::Sampler => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        other => return unknown(other),
    };
    Ok(wgpu::BindGroupLayoutEntry { binding: slot.binding, visibility: stages(slot.stages), ty, count: None })
}

pub(crate) fn storage_texture(format: Format, access: wgpu::StorageTextureAccess) -> Result<wgpu::BindingType> {
    let view_dimension = wgpu::TextureViewDimension::D2;
    Ok(wgpu::BindingType::StorageTexture { access, format: texture_format(format)?, view_dimension })
}

fn stages(stages: Stages) -> wgpu::ShaderStages {
    [
        (Stages::COMPUTE, wgpu::ShaderStages::COMPUTE),
        (Stages::VERTEX, wgpu::ShaderStages::VERTEX),
        (Stages::FRAGMENT, wgpu::ShaderStages::FRAGMENT),
    ]
    .into_iter()
    .filter(|(stage, _)| stages.intersects(*stage))
    .fold(wgpu::ShaderStages::NONE, |all, (_, stage)| all | stage)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_its_word_and_its_size() {
        for ours in Format::ALL {
            let theirs = texture_format(ours).unwrap();
            assert_eq!(format(theirs), Some(ours));
            assert_eq!(theirs.block_copy_size(None), Some(ours.bytes()), "{ours:?}");
            assert!(theirs.target_pixel_byte_cost().unwrap_or(0) <= 8, "{ours:?}: the caps count on it");
        }
    }

    #[test]
    fn uses_come_back_as_they_were() {
        let all = BUFFER_USES.iter().fold(BufferUses::default(), |all, (ours, _)| all | *ours);
        assert_eq!(buffer_uses(buffer_usages(all)), all);
        let all = TEXTURE_USES.iter().fold(TextureUses::default(), |all, (ours, _)| all | *ours);
        assert_eq!(texture_uses(texture_usages(all)), all);
    }
}
