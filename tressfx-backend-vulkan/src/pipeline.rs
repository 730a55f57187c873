//! Pipelines.

use ash::vk;
use tressfx_core::backend::{ComputeDesc, Kernel, Need, RasterDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::id::PipelineId;
use tressfx_core::shader::{Shader, ShaderStage, Stages};

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::error::error;
use crate::frame::Garbage;
use crate::tables::{blend_state, depth_state, layout_binding, texture_format};

/// A pipeline and its layouts.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) pipeline: vk::Pipeline,
    pub(crate) layout: vk::PipelineLayout,
    pub(crate) set_layout: vk::DescriptorSetLayout,
    pub(crate) point: vk::PipelineBindPoint,
}

impl VulkanBackend {
    pub(crate) fn make_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        let shader = &desc.shader;
        let entry = c_name(&shader.entry_point(ShaderStage::Compute)?.name);
        self.caps.check(shader.label, &[Need::StorageBuffers(shader.storage_buffers())])?;
        let module = self.gpu.module(shader, ShaderStage::Compute)?;
        let made = self.gpu.layouts(shader).and_then(|(set_layout, layout)| {
            let stage = stage(vk::ShaderStageFlags::COMPUTE, module, &entry);
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout);
            // SAFETY: module and layout are alive and belong together: both come from the shader.
            let made = unsafe { self.gpu.device.create_compute_pipelines(self.cache, &[info], None) };
            self.gpu.pipeline(made, shader.label, set_layout, layout, vk::PipelineBindPoint::COMPUTE)
        });
        // SAFETY: a pipeline does not need its module once it is made.
        unsafe { self.gpu.device.destroy_shader_module(module, None) };
        let pipeline = made.and_then(|made| self.validated(shader.label, made, Garbage::Pipeline))?;
        Ok(Kernel { pipeline: self.pipelines.insert(pipeline).into(), shader: shader.clone() })
    }

    pub(crate) fn make_raster(&mut self, desc: &RasterDesc) -> Result<Kernel> {
        let shader = &desc.shader;
        let needs = [Need::FragmentWrites, Need::StorageBuffers(shader.storage_buffers())];
        self.caps.check(shader.label, if writes_in_fragments(shader) { &needs } else { &needs[1..] })?;
        let vertex = self.gpu.module(shader, ShaderStage::Vertex)?;
        let made = self.gpu.module(shader, ShaderStage::Fragment).and_then(|fragment| {
            let made = self.gpu.raster(desc, [vertex, fragment], self.cache);
            // SAFETY: as above.
            unsafe { self.gpu.device.destroy_shader_module(fragment, None) };
            made
        });
        // SAFETY: as above.
        unsafe { self.gpu.device.destroy_shader_module(vertex, None) };
        let pipeline = made.and_then(|made| self.validated(shader.label, made, Garbage::Pipeline))?;
        Ok(Kernel { pipeline: self.pipelines.insert(pipeline).into(), shader: shader.clone() })
    }

    pub(crate) fn forget_pipeline(&mut self, id: PipelineId) {
        let Some(pipeline) = self.pipelines.remove(id.0) else { return };
        self.forget_sets(|of, _| of == id);
        self.throw_away(Garbage::Pipeline(pipeline));
    }

    pub(crate) fn pipeline(&self, id: PipelineId, what: &str) -> &Pipeline {
        self.pipelines.expect(id.0, what)
    }
}

impl Gpu {
    fn module(&self, shader: &Shader, stage: ShaderStage) -> Result<vk::ShaderModule> {
        let words = shader.spirv(stage, &self.spirv())?;
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: naga has validated what the words were made from.
        let module = unsafe { self.device.create_shader_module(&info, None) };
        let module = module.map_err(|code| error(code, shader.label, 0))?;
        self.name(module, shader.label);
        Ok(module)
    }

    fn layouts(&self, shader: &Shader) -> Result<(vk::DescriptorSetLayout, vk::PipelineLayout)> {
        let label = shader.label;
        let bindings: Vec<_> = shader.slots.iter().map(layout_binding).collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive.
        let set = unsafe { self.device.create_descriptor_set_layout(&info, None) };
        let set = set.map_err(|code| error(code, label, 0))?;
        self.name(set, label);
        let sets = [set];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        // SAFETY: as above.
        let layout = unsafe { self.device.create_pipeline_layout(&info, None) }.map_err(|code| {
            // SAFETY: nothing uses it.
            unsafe { self.device.destroy_descriptor_set_layout(set, None) };
            error(code, label, 0)
        })?;
        self.name(layout, label);
        Ok((set, layout))
    }

    /// What came of creating one pipeline.
    fn pipeline(
        &self,
        made: Result<Vec<vk::Pipeline>, (Vec<vk::Pipeline>, vk::Result)>,
        label: Label,
        set_layout: vk::DescriptorSetLayout,
        layout: vk::PipelineLayout,
        point: vk::PipelineBindPoint,
    ) -> Result<Pipeline> {
        let pipeline = Pipeline { pipeline: vk::Pipeline::null(), layout, set_layout, point };
        match made {
            Ok(made) => {
                self.name(made[0], label);
                Ok(Pipeline { pipeline: made[0], ..pipeline })
            }
            Err((_, code)) => {
                self.destroy_pipeline(pipeline);
                Err(error(code, label, 0))
            }
        }
    }

    fn raster(&self, desc: &RasterDesc, modules: [vk::ShaderModule; 2], cache: vk::PipelineCache) -> Result<Pipeline> {
        let shader = &desc.shader;
        let names = [ShaderStage::Vertex, ShaderStage::Fragment].map(|stage| shader.entry_point(stage));
        let [vertex, fragment] = names;
        let (vertex, fragment) = (c_name(&vertex?.name), c_name(&fragment?.name));
        let (set_layout, layout) = self.layouts(shader)?;
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, modules[0], &vertex),
            stage(vk::ShaderStageFlags::FRAGMENT, modules[1], &fragment),
        ];
        let input = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let rasterization = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = depth_state(desc.depth);
        let blends: Vec<_> = desc.targets.iter().map(|&(_, blend)| blend_state(blend)).collect();
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let dynamic = vk::PipelineDynamicStateCreateInfo::default()
            .dynamic_states(&[vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR]);
        let formats: Vec<_> = desc.targets.iter().map(|&(format, _)| texture_format(format)).collect();
        let depth_format = match desc.depth {
            tressfx_core::backend::Depth::Off => vk::Format::UNDEFINED,
            tressfx_core::backend::Depth::TestWrite(_) => vk::Format::D32_SFLOAT,
        };
        let mut targets = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(&formats)
            .depth_attachment_format(depth_format);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(layout)
            .push_next(&mut targets);
        // SAFETY: modules and layout are alive and belong together, and all pointers live until the call is over.
        let made = unsafe { self.device.create_graphics_pipelines(cache, &[info], None) };
        self.pipeline(made, shader.label, set_layout, layout, vk::PipelineBindPoint::GRAPHICS)
    }

    pub(crate) fn destroy_pipeline(&self, pipeline: Pipeline) {
        // SAFETY: the caller knows that the GPU has finished with it; null is nothing to destroy.
        unsafe {
            self.device.destroy_pipeline(pipeline.pipeline, None);
            self.device.destroy_pipeline_layout(pipeline.layout, None);
            self.device.destroy_descriptor_set_layout(pipeline.set_layout, None);
        }
    }
}

fn stage<'a>(
    stage: vk::ShaderStageFlags,
    module: vk::ShaderModule,
    entry: &'a std::ffi::CStr,
) -> vk::PipelineShaderStageCreateInfo<'a> {
    vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(entry)
}

fn c_name(name: &str) -> std::ffi::CString {
    std::ffi::CString::new(name).expect("WGSL names hold no zero")
}

fn writes_in_fragments(shader: &Shader) -> bool {
    let writes = |slot: &tressfx_core::shader::ShaderSlot| slot.kind == tressfx_core::shader::SlotKind::ReadWrite;
    shader.slots.iter().any(|slot| writes(slot) && slot.stages.has(Stages::FRAGMENT))
}
