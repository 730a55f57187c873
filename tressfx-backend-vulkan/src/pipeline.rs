//! Pipelines.

use ash::vk;
use tressfx_core::backend::{ComputeDesc, RasterDesc};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::shader::{Kernel, RasterPipeline, Shader, ShaderStage, SlotKind, Stages};

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::error::unknown;
use crate::frames::Garbage;
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
        desc.check(self.catalog.caps())?;
        self.gpu.check_lost()?;
        let shader = &desc.shader;
        self.gpu.check_slots(shader)?;
        let entry = c_name(&shader.entry_point(ShaderStage::Compute)?.name);
        let module = self.gpu.module(shader, ShaderStage::Compute)?;
        let made = self.gpu.layouts(shader).and_then(|layouts| {
            let stage = stage(vk::ShaderStageFlags::COMPUTE, module, &entry);
            let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layouts.1)];
            self.gpu.pipeline(shader.label, layouts, vk::PipelineBindPoint::COMPUTE, |device| {
                // SAFETY: module and layout are alive and belong together: both come from the shader.
                unsafe { device.create_compute_pipelines(self.cache.cache, &info, None) }
            })
        });
        // SAFETY: a pipeline does not need its module once it is made.
        unsafe { self.gpu.device.destroy_shader_module(module, None) };
        let pipeline = made.and_then(|made| self.heard_about(shader.label, made))?;
        Ok(self.catalog.add_compute(desc, pipeline))
    }

    pub(crate) fn make_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        desc.check(self.catalog.caps())?;
        self.gpu.check_lost()?;
        let shader = &desc.shader;
        self.gpu.check_slots(shader)?;
        let differ = desc.targets.windows(2).any(|pair| pair[0].1 != pair[1].1);
        if differ && !self.gpu.enabled.independent_blend {
            return Err(Error::rule(shader.label, "its targets blend differently, which is not enabled on the device"));
        }
        let vertex = self.gpu.module(shader, ShaderStage::Vertex)?;
        let fragment = shader.has_fragment_stage().then(|| self.gpu.module(shader, ShaderStage::Fragment)).transpose();
        let made = fragment.and_then(|fragment| {
            let made = self.gpu.raster(desc, (vertex, fragment), self.cache.cache);
            // SAFETY: as above; null is nothing to destroy.
            unsafe { self.gpu.device.destroy_shader_module(fragment.unwrap_or_default(), None) };
            made
        });
        // SAFETY: as above.
        unsafe { self.gpu.device.destroy_shader_module(vertex, None) };
        let pipeline = made.and_then(|made| self.heard_about(shader.label, made))?;
        Ok(self.catalog.add_raster(desc, pipeline))
    }

    /// What was made, unless the validation layer had something to say about it.
    fn heard_about(&mut self, label: Label, made: Pipeline) -> Result<Pipeline> {
        match self.check_validation() {
            Ok(()) => Ok(made),
            Err(error) => {
                self.throw_away(Garbage::Pipeline(made));
                Err(Error::Backend { label, message: error.to_string() })
            }
        }
    }
}

impl Gpu {
    /// What a device must have for what a shader binds, beside what the contract counts.
    fn check_slots(&self, shader: &Shader) -> Result<()> {
        let limits = &self.properties.limits;
        for stage in [Stages::COMPUTE, Stages::VERTEX, Stages::FRAGMENT] {
            let count = |of: fn(SlotKind) -> bool| {
                let slots = shader.slots.iter().filter(|slot| slot.stages.intersects(stage) && of(slot.kind));
                slots.count() as u32
            };
            let sampled = |kind: SlotKind| kind.is_texture() && !kind.is_written();
            for (what, count, most) in [
                (
                    "uniform buffers",
                    count(|kind| kind == SlotKind::Uniform),
                    limits.max_per_stage_descriptor_uniform_buffers,
                ),
                ("textures", count(sampled), limits.max_per_stage_descriptor_sampled_images),
                ("samplers", count(|kind| kind == SlotKind::Sampler), limits.max_per_stage_descriptor_samplers),
                ("bindings", count(|_| true), limits.max_per_stage_resources),
            ] {
                if count > most {
                    return Err(Error::rule(shader.label, format!("{count} {what} in a stage, the device has {most}")));
                }
            }
        }
        match shader.slots.iter().find(|slot| slot.kind.is_written() && slot.stages.intersects(Stages::VERTEX)) {
            Some(slot) => Err(Error::rule(shader.label, format!("`{}`: vertex stages write nothing", slot.name))),
            None => Ok(()),
        }
    }

    fn module(&self, shader: &Shader, stage: ShaderStage) -> Result<vk::ShaderModule> {
        let words = shader.spirv(stage, &self.spirv())?;
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: naga has validated what the words were made from.
        self.create(shader.label, |device| unsafe { device.create_shader_module(&info, None) })
    }

    fn layouts(&self, shader: &Shader) -> Result<(vk::DescriptorSetLayout, vk::PipelineLayout)> {
        let label = shader.label;
        let binding = |slot| layout_binding(slot).ok_or_else(|| unknown(label, slot.kind));
        let bindings = shader.slots.iter().map(binding).collect::<Result<Vec<_>>>()?;
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive.
        let set = self.create(label, |device| unsafe { device.create_descriptor_set_layout(&info, None) })?;
        let sets = [set];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        // SAFETY: as above.
        let layout = self.create(label, |device| unsafe { device.create_pipeline_layout(&info, None) });
        let layout = layout.inspect_err(|_| {
            // SAFETY: nothing uses it.
            unsafe { self.device.destroy_descriptor_set_layout(set, None) };
        })?;
        Ok((set, layout))
    }

    /// One pipeline. Its layouts go with it where it cannot be made.
    fn pipeline(
        &self,
        label: Label,
        (set_layout, layout): (vk::DescriptorSetLayout, vk::PipelineLayout),
        point: vk::PipelineBindPoint,
        make: impl FnOnce(&ash::Device) -> Result<Vec<vk::Pipeline>, (Vec<vk::Pipeline>, vk::Result)>,
    ) -> Result<Pipeline> {
        let pipeline = self.create(label, |device| make(device).map(|made| made[0]).map_err(|(_, code)| code));
        let without = Pipeline { pipeline: vk::Pipeline::null(), layout, set_layout, point };
        match pipeline {
            Ok(pipeline) => Ok(Pipeline { pipeline, ..without }),
            Err(error) => {
                self.destroy_pipeline(without);
                Err(error)
            }
        }
    }

    fn raster(
        &self,
        desc: &RasterDesc,
        (vertex, fragment): (vk::ShaderModule, Option<vk::ShaderModule>),
        cache: vk::PipelineCache,
    ) -> Result<Pipeline> {
        let shader = &desc.shader;
        let vertex_name = c_name(&shader.entry_point(ShaderStage::Vertex)?.name);
        let mut stages = vec![stage(vk::ShaderStageFlags::VERTEX, vertex, &vertex_name)];
        let fragment_name;
        if let Some(fragment) = fragment {
            fragment_name = c_name(&shader.entry_point(ShaderStage::Fragment)?.name);
            stages.push(stage(vk::ShaderStageFlags::FRAGMENT, fragment, &fragment_name));
        }
        let format = |&(format, _)| texture_format(format).ok_or_else(|| unknown(shader.label, format));
        let formats = desc.targets.iter().map(format).collect::<Result<Vec<_>>>()?;
        let blend = |&(_, blend)| blend_state(blend).ok_or_else(|| unknown(shader.label, blend));
        let blends = desc.targets.iter().map(blend).collect::<Result<Vec<_>>>()?;
        let (depth, depth_format) = depth_state(desc.depth).ok_or_else(|| unknown(shader.label, desc.depth))?;
        let input = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let rasterization = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let dynamic = vk::PipelineDynamicStateCreateInfo::default()
            .dynamic_states(&[vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR]);
        let mut targets = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(&formats)
            .depth_attachment_format(depth_format);
        let layouts = self.layouts(shader)?;
        let info = [vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(layouts.1)
            .push_next(&mut targets)];
        self.pipeline(shader.label, layouts, vk::PipelineBindPoint::GRAPHICS, |device| {
            // SAFETY: modules and layout are alive and belong together, and all pointers live until the call is over.
            unsafe { device.create_graphics_pipelines(cache, &info, None) }
        })
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

/// WGSL names hold no zero.
fn c_name(name: &str) -> std::ffi::CString {
    std::ffi::CString::new(name).unwrap_or_default()
}
