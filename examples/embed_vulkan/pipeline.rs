//! Pipelines of the engine's passes. Each binds one thing, in set 0 as binding 0.

use std::ffi::CString;

use anyhow::Result;
use tressfx_backend_vulkan::ash::vk;
use tressfx_core::shader::{Shader, ShaderSource, ShaderStage, Specialization, SpirvOptions};
use tressfx_examples::Vertex;

use crate::gpu::Gpu;

/// What a pipeline is made from.
pub(crate) struct PipelineDesc {
    pub(crate) source: ShaderSource,
    /// What it binds.
    pub(crate) binding: vk::DescriptorType,
    pub(crate) target: vk::Format,
    /// Whether it draws meshes, nearest first, or one triangle over the screen.
    pub(crate) meshes: bool,
}

/// A pipeline and its layouts.
pub(crate) struct Pipeline {
    pub(crate) pipeline: vk::Pipeline,
    pub(crate) layout: vk::PipelineLayout,
    pub(crate) set_layout: vk::DescriptorSetLayout,
}

impl Gpu {
    pub(crate) fn pipeline(&self, desc: &PipelineDesc) -> Result<Pipeline> {
        // An engine has its own way to SPIR-V; here it is the library's.
        let shader = Shader::new(&desc.source, &Specialization::new())?;
        let (vertex, fragment) =
            (self.module(&shader, ShaderStage::Vertex)?, self.module(&shader, ShaderStage::Fragment)?);
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, vertex.0, &vertex.1),
            stage(vk::ShaderStageFlags::FRAGMENT, fragment.0, &fragment.1),
        ];
        let (set_layout, layout) = self.layouts(desc.binding)?;
        let pipeline = self.raster(desc, &stages, layout)?;
        // SAFETY: pipelines do not need their modules once they are made.
        unsafe {
            self.device.destroy_shader_module(vertex.0, None);
            self.device.destroy_shader_module(fragment.0, None);
        }
        Ok(Pipeline { pipeline, layout, set_layout })
    }

    fn module(&self, shader: &Shader, stage: ShaderStage) -> Result<(vk::ShaderModule, CString)> {
        let options = SpirvOptions { version: (1, 6), robust_buffers: false, robust_textures: false, names: false };
        let words = shader.spirv(stage, &options)?;
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are valid SPIR-V.
        let module = unsafe { self.device.create_shader_module(&info, None) }?;
        Ok((module, CString::new(shader.entry_point(stage)?.name.as_str())?))
    }

    fn layouts(&self, binding: vk::DescriptorType) -> Result<(vk::DescriptorSetLayout, vk::PipelineLayout)> {
        let bindings = [vk::DescriptorSetLayoutBinding::default()
            .descriptor_type(binding)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT)];
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive.
        unsafe {
            let sets = [self.device.create_descriptor_set_layout(&info, None)?];
            let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
            Ok((sets[0], self.device.create_pipeline_layout(&info, None)?))
        }
    }

    fn raster(
        &self,
        desc: &PipelineDesc,
        stages: &[vk::PipelineShaderStageCreateInfo],
        layout: vk::PipelineLayout,
    ) -> Result<vk::Pipeline> {
        let corners = [vk::VertexInputBindingDescription::default().stride(size_of::<Vertex>() as u32)];
        let attribute = |location: u32| {
            let attribute = vk::VertexInputAttributeDescription::default().format(vk::Format::R32G32B32A32_SFLOAT);
            attribute.location(location).offset(16 * location)
        };
        let attributes = [attribute(0), attribute(1)];
        let mut input = vk::PipelineVertexInputStateCreateInfo::default();
        let mut depth = vk::PipelineDepthStencilStateCreateInfo::default();
        let targets = [desc.target];
        let mut rendering = vk::PipelineRenderingCreateInfo::default().color_attachment_formats(&targets);
        if desc.meshes {
            input = input.vertex_binding_descriptions(&corners).vertex_attribute_descriptions(&attributes);
            // The view has its near plane at 1.
            let nearer = vk::CompareOp::GREATER_OR_EQUAL;
            depth = depth.depth_test_enable(true).depth_write_enable(true).depth_compare_op(nearer);
            rendering = rendering.depth_attachment_format(vk::Format::D32_SFLOAT);
        }
        let triangles =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let rasterization = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let replace =
            [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&replace);
        let states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(stages)
            .vertex_input_state(&input)
            .input_assembly_state(&triangles)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(layout)
            .push_next(&mut rendering);
        // SAFETY: all pointers live until the call is over.
        let made = unsafe { self.device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
        Ok(made.map_err(|(_, error)| error)?[0])
    }

    pub(crate) fn destroy_pipeline(&self, pipeline: &Pipeline) {
        // SAFETY: the GPU has finished with it.
        unsafe {
            self.device.destroy_pipeline(pipeline.pipeline, None);
            self.device.destroy_pipeline_layout(pipeline.layout, None);
            self.device.destroy_descriptor_set_layout(pipeline.set_layout, None);
        }
    }
}

fn stage(
    stage: vk::ShaderStageFlags,
    module: vk::ShaderModule,
    entry: &std::ffi::CStr,
) -> vk::PipelineShaderStageCreateInfo<'_> {
    vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(entry)
}
