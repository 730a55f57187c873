//! Words of the contract in words of Vulkan.

use ash::vk;
use tressfx_core::backend::{Blend, BufferUse, Depth, DepthOrder, Format};
use tressfx_core::hazards::{Access, Layout};
use tressfx_core::shader::{ShaderSlot, SlotKind, Stages};

pub(crate) fn buffer_usages(usage: BufferUse) -> vk::BufferUsageFlags {
    let copied = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST;
    match usage {
        BufferUse::Storage => copied | vk::BufferUsageFlags::STORAGE_BUFFER,
        BufferUse::Uniform => copied | vk::BufferUsageFlags::UNIFORM_BUFFER,
        BufferUse::Indirect => copied | vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::INDIRECT_BUFFER,
    }
}

pub(crate) fn texture_format(format: Format) -> vk::Format {
    match format {
        Format::Rgba8 => vk::Format::R8G8B8A8_UNORM,
        Format::Rgba8Srgb => vk::Format::R8G8B8A8_SRGB,
        Format::Bgra8 => vk::Format::B8G8R8A8_UNORM,
        Format::Bgra8Srgb => vk::Format::B8G8R8A8_SRGB,
        Format::Rgba16F => vk::Format::R16G16B16A16_SFLOAT,
        Format::Depth32F => vk::Format::D32_SFLOAT,
    }
}

pub(crate) fn texture_usages(format: Format) -> vk::ImageUsageFlags {
    let drawn = match format.is_depth() {
        true => vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
        false => vk::ImageUsageFlags::COLOR_ATTACHMENT,
    };
    drawn | vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST
}

/// The only level and layer of a texture.
pub(crate) fn whole(format: Format) -> vk::ImageSubresourceRange {
    let aspect = if format.is_depth() { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR };
    vk::ImageSubresourceRange { aspect_mask: aspect, level_count: 1, layer_count: 1, ..Default::default() }
}

pub(crate) fn blend_state(blend: Blend) -> vk::PipelineColorBlendAttachmentState {
    let state = vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA);
    match blend {
        Blend::Replace => state,
        Blend::Over => state
            .blend_enable(true)
            .src_color_blend_factor(vk::BlendFactor::ONE)
            .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .color_blend_op(vk::BlendOp::ADD)
            .src_alpha_blend_factor(vk::BlendFactor::ONE)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .alpha_blend_op(vk::BlendOp::ADD),
    }
}

pub(crate) fn depth_state(depth: Depth) -> vk::PipelineDepthStencilStateCreateInfo<'static> {
    let state = vk::PipelineDepthStencilStateCreateInfo::default();
    let compare = match depth {
        Depth::Off => return state,
        Depth::TestWrite(DepthOrder::Standard) => vk::CompareOp::LESS_OR_EQUAL,
        Depth::TestWrite(DepthOrder::Reverse) => vk::CompareOp::GREATER_OR_EQUAL,
    };
    state.depth_test_enable(true).depth_write_enable(true).depth_compare_op(compare)
}

pub(crate) fn descriptor_type(kind: SlotKind) -> vk::DescriptorType {
    match kind {
        SlotKind::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
        SlotKind::Read | SlotKind::ReadWrite => vk::DescriptorType::STORAGE_BUFFER,
        SlotKind::Texture | SlotKind::DepthTexture => vk::DescriptorType::SAMPLED_IMAGE,
    }
}

pub(crate) fn layout_binding(slot: &ShaderSlot) -> vk::DescriptorSetLayoutBinding<'static> {
    vk::DescriptorSetLayoutBinding::default()
        .binding(slot.binding)
        .descriptor_type(descriptor_type(slot.kind))
        .descriptor_count(1)
        .stage_flags(stages(slot.stages))
}

fn stages(stages: Stages) -> vk::ShaderStageFlags {
    [
        (Stages::COMPUTE, vk::ShaderStageFlags::COMPUTE),
        (Stages::VERTEX, vk::ShaderStageFlags::VERTEX),
        (Stages::FRAGMENT, vk::ShaderStageFlags::FRAGMENT),
    ]
    .into_iter()
    .filter(|(stage, _)| stages.has(*stage))
    .fold(vk::ShaderStageFlags::empty(), |all, (_, stage)| all | stage)
}

/// Stages and kinds of access that take part in a barrier.
pub(crate) type Scope = (vk::PipelineStageFlags2, vk::AccessFlags2);

/// The scope of a set of accesses to a buffer, or to a texture of a format.
pub(crate) fn scope(access: Access, format: Option<Format>) -> Scope {
    use vk::{AccessFlags2 as A, PipelineStageFlags2 as S};
    let shader_read = A::SHADER_STORAGE_READ | A::UNIFORM_READ | A::SHADER_SAMPLED_READ;
    let read = if format.is_some() { A::SHADER_SAMPLED_READ } else { shader_read };
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
        Layout::CopySource => vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
        Layout::CopyTarget => vk::ImageLayout::TRANSFER_DST_OPTIMAL,
    }
}
