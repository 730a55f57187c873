//! Pipelines.

use std::borrow::Cow;

use tressfx_core::backend::{ComputeDesc, RasterDesc};
use tressfx_core::error::Result;
use tressfx_core::shader::{Kernel, RasterPipeline, Shader, ShaderStage};

use crate::WgpuBackend;
use crate::tables::{blend_state, depth_state, layout_entry, texture_format};

/// A pipeline and the layout of its one bind group.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) stage: Stage,
    pub(crate) layout: wgpu::BindGroupLayout,
}

/// Which kind of pipeline it is.
#[derive(Debug)]
pub(crate) enum Stage {
    Compute(wgpu::ComputePipeline),
    Raster(wgpu::RenderPipeline),
}

impl WgpuBackend {
    pub(crate) fn make_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        desc.check(self.catalog.caps())?;
        let shader = &desc.shader;
        let entry = &shader.entry_point(ShaderStage::Compute)?.name;
        let pipeline = self.guarded(shader.label, 0, |backend| {
            let (module, layout, pipeline_layout) = backend.parts(shader)?;
            let pipeline = backend.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(shader.label),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: compilation_options(),
                cache: None,
            });
            Ok(Pipeline { stage: Stage::Compute(pipeline), layout })
        })?;
        Ok(self.catalog.add_compute(desc, pipeline))
    }

    pub(crate) fn make_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        desc.check(self.catalog.caps())?;
        let shader = &desc.shader;
        let vertex = &shader.entry_point(ShaderStage::Vertex)?.name;
        let fragment = match shader.has_fragment_stage() {
            true => Some(&shader.entry_point(ShaderStage::Fragment)?.name),
            false => None,
        };
        let pipeline = self.guarded(shader.label, 0, |backend| {
            let (module, layout, pipeline_layout) = backend.parts(shader)?;
            let pipeline = backend.raster_pipeline(desc, &module, [Some(vertex), fragment], &pipeline_layout)?;
            Ok(Pipeline { stage: Stage::Raster(pipeline), layout })
        })?;
        Ok(self.catalog.add_raster(desc, pipeline))
    }

    fn raster_pipeline(
        &self,
        desc: &RasterDesc,
        module: &wgpu::ShaderModule,
        [vertex, fragment]: [Option<&String>; 2],
        layout: &wgpu::PipelineLayout,
    ) -> Result<wgpu::RenderPipeline> {
        let mut targets = Vec::new();
        for &(format, blend) in &desc.targets {
            let format = texture_format(format)?;
            targets.push(Some(wgpu::ColorTargetState {
                format,
                blend: blend_state(blend)?,
                write_mask: wgpu::ColorWrites::ALL,
            }));
        }
        let fragment = fragment.map(|entry| wgpu::FragmentState {
            module,
            entry_point: Some(entry),
            compilation_options: compilation_options(),
            targets: &targets,
        });
        Ok(self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(desc.shader.label),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: vertex.map(String::as_str),
                compilation_options: compilation_options(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: depth_state(desc.depth)?,
            multisample: wgpu::MultisampleState::default(),
            fragment,
            multiview_mask: None,
            cache: None,
        }))
    }

    fn parts(&self, shader: &Shader) -> Result<(wgpu::ShaderModule, wgpu::BindGroupLayout, wgpu::PipelineLayout)> {
        let label = Some(shader.label);
        let descriptor = wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Naga(Cow::Owned(shader.module().clone())),
        };
        let checks = wgpu::ShaderRuntimeChecks { force_loop_bounding: false, ..wgpu::ShaderRuntimeChecks::checked() };
        // SAFETY: all checks of memory accesses stay on. Off is only the counter that ends endless loops, which costs
        // every turn of every loop; the library's loops end by their own bounds.
        let module = unsafe { self.device.create_shader_module_trusted(descriptor, checks) };
        let entries = shader.slots.iter().map(layout_entry).collect::<Result<Vec<_>>>()?;
        let layout =
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        Ok((module, layout, pipeline_layout))
    }
}

fn compilation_options() -> wgpu::PipelineCompilationOptions<'static> {
    // No kernel relies on group memory being zero.
    wgpu::PipelineCompilationOptions { zero_initialize_workgroup_memory: false, ..Default::default() }
}
