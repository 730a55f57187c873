//! Words of the contract in words of Vulkan.

use ash::vk;
use tressfx_core::backend::{Blend, BufferUses, Depth, DepthOrder, Format, TextureUses};
use tressfx_core::hazards::{Access, Layout};
use tressfx_core::shader::{ShaderSlot, SlotKind, Stages};

pub(crate) fn buffer_usages(uses: BufferUses) -> vk::BufferUsageFlags {
    use vk::BufferUsageFlags as U;
    [
        (BufferUses::STORAGE, U::STORAGE_BUFFER),
        (BufferUses::UNIFORM, U::UNIFORM_BUFFER),
        (BufferUses::INDIRECT, U::INDIRECT_BUFFER),
        (BufferUses::COPY_SOURCE, U::TRANSFER_SRC),
        (BufferUses::COPY_DESTINATION, U::TRANSFER_DST),
    ]
    .into_iter()
    .filter(|(each, _)| uses.contains(*each))
    // Its zeros are copied to it.
    .fold(U::TRANSFER_DST, |all, (_, usage)| all | usage)
}

pub(crate) fn texture_format(format: Format) -> Option<vk::Format> {
    Some(match format {
        Format::Rgba8 => vk::Format::R8G8B8A8_UNORM,
        Format::Rgba8Srgb => vk::Format::R8G8B8A8_SRGB,
        Format::Bgra8 => vk::Format::B8G8R8A8_UNORM,
        Format::Bgra8Srgb => vk::Format::B8G8R8A8_SRGB,
        Format::Rgba16F => vk::Format::R16G16B16A16_SFLOAT,
        Format::Rgb10A2 => vk::Format::A2B10G10R10_UNORM_PACK32,
        Format::R11G11B10F => vk::Format::B10G11R11_UFLOAT_PACK32,
        Format::R16F => vk::Format::R16_SFLOAT,
        Format::Rg16F => vk::Format::R16G16_SFLOAT,
        Format::Rg32F => vk::Format::R32G32_SFLOAT,
        Format::R32F => vk::Format::R32_SFLOAT,
        Format::R32Uint => vk::Format::R32_UINT,
        Format::Depth32F => vk::Format::D32_SFLOAT,
        _ => return None,
    })
}

pub(crate) fn texture_usages(format: Format, uses: TextureUses) -> vk::ImageUsageFlags {
    use vk::ImageUsageFlags as U;
    let target = if format.is_depth() { U::DEPTH_STENCIL_ATTACHMENT } else { U::COLOR_ATTACHMENT };
    [
        (TextureUses::TARGET, target),
        (TextureUses::SAMPLED, U::SAMPLED),
        (TextureUses::STORAGE, U::STORAGE),
        (TextureUses::COPY_SOURCE, U::TRANSFER_SRC),
        (TextureUses::COPY_DESTINATION, U::TRANSFER_DST),
    ]
    .into_iter()
    .filter(|(each, _)| uses.contains(*each))
    // Its zeros are copied to it.
    .fold(U::TRANSFER_DST, |all, (_, usage)| all | usage)
}

/// Whether a texture is ever seen through a view: copies need none.
pub(crate) fn has_view(uses: TextureUses) -> bool {
    [TextureUses::TARGET, TextureUses::SAMPLED, TextureUses::STORAGE].into_iter().any(|each| uses.contains(each))
}

/// The only level and layer of a texture.
pub(crate) fn whole(format: Format) -> vk::ImageSubresourceRange {
    let aspect = if format.is_depth() { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR };
    vk::ImageSubresourceRange { aspect_mask: aspect, level_count: 1, layer_count: 1, ..Default::default() }
}

pub(crate) fn blend_state(blend: Blend) -> Option<vk::PipelineColorBlendAttachmentState> {
    use vk::{BlendFactor as F, BlendOp};
    let state = vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA);
    // Factors of the fragment and of what was there, for colour and for alpha. `MIN` and `MAX` take no factors.
    let (op, color, alpha) = match blend {
        Blend::Replace => return Some(state),
        Blend::Over => (BlendOp::ADD, [F::ONE, F::ONE_MINUS_SRC_ALPHA], [F::ONE, F::ONE_MINUS_SRC_ALPHA]),
        Blend::Add => (BlendOp::ADD, [F::ONE; 2], [F::ONE; 2]),
        Blend::Multiply => (BlendOp::ADD, [F::DST_COLOR, F::ZERO], [F::DST_ALPHA, F::ZERO]),
        Blend::Min => (BlendOp::MIN, [F::ONE; 2], [F::ONE; 2]),
        Blend::Max => (BlendOp::MAX, [F::ONE; 2], [F::ONE; 2]),
        _ => return None,
    };
    Some(
        state
            .blend_enable(true)
            .src_color_blend_factor(color[0])
            .dst_color_blend_factor(color[1])
            .color_blend_op(op)
            .src_alpha_blend_factor(alpha[0])
            .dst_alpha_blend_factor(alpha[1])
            .alpha_blend_op(op),
    )
}

/// The state of depth, and the format of its target.
pub(crate) fn depth_state(depth: Depth) -> Option<(vk::PipelineDepthStencilStateCreateInfo<'static>, vk::Format)> {
    let state = vk::PipelineDepthStencilStateCreateInfo::default();
    let (order, writes) = match depth {
        Depth::Off => return Some((state, vk::Format::UNDEFINED)),
        Depth::Test(order) => (order, false),
        Depth::TestWrite(order) => (order, true),
        _ => return None,
    };
    let compare = match order {
        DepthOrder::Standard => vk::CompareOp::LESS_OR_EQUAL,
        DepthOrder::Reverse => vk::CompareOp::GREATER_OR_EQUAL,
    };
    let state = state.depth_test_enable(true).depth_write_enable(writes).depth_compare_op(compare);
    Some((state, vk::Format::D32_SFLOAT))
}

pub(crate) fn descriptor_type(kind: SlotKind) -> Option<vk::DescriptorType> {
    Some(match kind {
        SlotKind::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
        SlotKind::Read | SlotKind::ReadWrite => vk::DescriptorType::STORAGE_BUFFER,
        SlotKind::Texture | SlotKind::FilteredTexture | SlotKind::UintTexture | SlotKind::DepthTexture => {
            vk::DescriptorType::SAMPLED_IMAGE
        }
        SlotKind::StorageTexture(_) | SlotKind::ReadWriteTexture(_) => vk::DescriptorType::STORAGE_IMAGE,
        SlotKind::Sampler => vk::DescriptorType::SAMPLER,
        _ => return None,
    })
}

pub(crate) fn layout_binding(slot: &ShaderSlot) -> Option<vk::DescriptorSetLayoutBinding<'static>> {
    let binding = vk::DescriptorSetLayoutBinding::default()
        .binding(slot.binding)
        .descriptor_type(descriptor_type(slot.kind)?)
        .descriptor_count(1);
    Some(binding.stage_flags(stages(slot.stages)))
}

fn stages(stages: Stages) -> vk::ShaderStageFlags {
    [
        (Stages::COMPUTE, vk::ShaderStageFlags::COMPUTE),
        (Stages::VERTEX, vk::ShaderStageFlags::VERTEX),
        (Stages::FRAGMENT, vk::ShaderStageFlags::FRAGMENT),
    ]
    .into_iter()
    .filter(|(stage, _)| stages.intersects(*stage))
    .fold(vk::ShaderStageFlags::empty(), |all, (_, stage)| all | stage)
}

/// Stages and kinds of access that take part in a barrier.
pub(crate) type StageAccess = (vk::PipelineStageFlags2, vk::AccessFlags2);

/// The scope of a set of accesses to a buffer, or to a texture of a format.
pub(crate) fn scope(access: Access, format: Option<Format>) -> StageAccess {
    use vk::{AccessFlags2 as A, PipelineStageFlags2 as S};
    let shader_read = A::SHADER_STORAGE_READ | A::UNIFORM_READ | A::SHADER_SAMPLED_READ;
    let read = if format.is_some() { A::SHADER_SAMPLED_READ | A::SHADER_STORAGE_READ } else { shader_read };
    let raster = S::VERTEX_SHADER | S::FRAGMENT_SHADER;
    let target = match format.is_some_and(Format::is_depth) {
        true => (
            S::EARLY_FRAGMENT_TESTS | S::LATE_FRAGMENT_TESTS,
            A::DEPTH_STENCIL_ATTACHMENT_READ | A::DEPTH_STENCIL_ATTACHMENT_WRITE,
        ),
        false => (S::COLOR_ATTACHMENT_OUTPUT, A::COLOR_ATTACHMENT_READ | A::COLOR_ATTACHMENT_WRITE),
    };
    [
        (Access::COMPUTE_READ, (S::COMPUTE_SHADER, read)),
        (Access::COMPUTE_WRITE, (S::COMPUTE_SHADER, A::SHADER_STORAGE_WRITE)),
        (Access::RASTER_READ, (raster, read)),
        (Access::RASTER_WRITE, (raster, A::SHADER_STORAGE_WRITE)),
        (Access::COPY_READ, (S::ALL_TRANSFER, A::TRANSFER_READ)),
        (Access::COPY_WRITE, (S::ALL_TRANSFER, A::TRANSFER_WRITE)),
        (Access::TARGET, target),
        (Access::INDIRECT_READ, (S::DRAW_INDIRECT, A::INDIRECT_COMMAND_READ)),
    ]
    .into_iter()
    .filter(|(kind, _)| access.contains(*kind))
    .fold((S::NONE, A::NONE), |(stages, accesses), (_, (stage, access))| (stages | stage, accesses | access))
}

/// Only writes have to be made visible.
pub(crate) fn writes(access: vk::AccessFlags2) -> vk::AccessFlags2 {
    use vk::AccessFlags2 as A;
    access
        & (A::SHADER_STORAGE_WRITE
            | A::SHADER_WRITE
            | A::TRANSFER_WRITE
            | A::COLOR_ATTACHMENT_WRITE
            | A::DEPTH_STENCIL_ATTACHMENT_WRITE
            | A::MEMORY_WRITE
            | A::HOST_WRITE)
}

pub(crate) fn image_layout(layout: Layout, format: Format) -> vk::ImageLayout {
    match layout {
        Layout::Target if format.is_depth() => vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        Layout::Target => vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        Layout::Sampled => vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
        Layout::Storage => vk::ImageLayout::GENERAL,
        Layout::CopySource => vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
        Layout::CopyTarget => vk::ImageLayout::TRANSFER_DST_OPTIMAL,
    }
}
