//! Words of the contract in words of wgpu.

use tressfx_core::backend::{Blend, BufferUse, Depth, DepthOrder, Format};
use tressfx_core::shader::{ShaderSlot, SlotKind, Stages};
use wgpu::{BlendComponent, BlendFactor, BlendState, BufferUsages, CompareFunction, TextureFormat};

pub(crate) fn buffer_usages(usage: BufferUse) -> BufferUsages {
    let copied = BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
    match usage {
        BufferUse::Storage => copied | BufferUsages::STORAGE,
        BufferUse::Uniform => copied | BufferUsages::UNIFORM,
        BufferUse::Indirect => copied | BufferUsages::STORAGE | BufferUsages::INDIRECT,
    }
}

pub(crate) fn texture_format(format: Format) -> TextureFormat {
    match format {
        Format::Rgba8 => TextureFormat::Rgba8Unorm,
        Format::Rgba8Srgb => TextureFormat::Rgba8UnormSrgb,
        Format::Bgra8 => TextureFormat::Bgra8Unorm,
        Format::Bgra8Srgb => TextureFormat::Bgra8UnormSrgb,
        Format::Rgba16F => TextureFormat::Rgba16Float,
        Format::Depth32F => TextureFormat::Depth32Float,
    }
}

pub(crate) fn blend_state(blend: Blend) -> Option<BlendState> {
    match blend {
        Blend::Replace => None,
        Blend::Over => Some(BlendState { color: over(), alpha: over() }),
    }
}

fn over() -> BlendComponent {
    BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::OneMinusSrcAlpha,
        operation: wgpu::BlendOperation::Add,
    }
}

pub(crate) fn depth_state(depth: Depth) -> Option<wgpu::DepthStencilState> {
    let compare = match depth {
        Depth::Off => return None,
        Depth::TestWrite(DepthOrder::Standard) => CompareFunction::LessEqual,
        Depth::TestWrite(DepthOrder::Reverse) => CompareFunction::GreaterEqual,
    };
    Some(wgpu::DepthStencilState {
        format: TextureFormat::Depth32Float,
        depth_write_enabled: Some(true),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    })
}

pub(crate) fn layout_entry(slot: &ShaderSlot) -> wgpu::BindGroupLayoutEntry {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: std::num::NonZeroU64::new(slot.min_bytes),
    };
    let texture = |sample_type| wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let ty = match slot.kind {
        SlotKind::Uniform => buffer(wgpu::BufferBindingType::Uniform),
        SlotKind::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
        SlotKind::ReadWrite => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
        SlotKind::Texture => texture(wgpu::TextureSampleType::Float { filterable: false }),
        SlotKind::DepthTexture => texture(wgpu::TextureSampleType::Depth),
    };
    wgpu::BindGroupLayoutEntry { binding: slot.binding, visibility: stages(slot.stages), ty, count: None }
}

fn stages(stages: Stages) -> wgpu::ShaderStages {
    [
        (Stages::COMPUTE, wgpu::ShaderStages::COMPUTE),
        (Stages::VERTEX, wgpu::ShaderStages::VERTEX),
        (Stages::FRAGMENT, wgpu::ShaderStages::FRAGMENT),
    ]
    .into_iter()
    .filter(|(stage, _)| stages.has(*stage))
    .fold(wgpu::ShaderStages::NONE, |all, (_, stage)| all | stage)
}
