//! Pipelines and what they bind.

use std::borrow::Cow;

use tressfx_core::backend::{ComputeDesc, Kernel, Need, RasterDesc};
use tressfx_core::error::Result;
use tressfx_core::id::{PipelineId, Resource};
use tressfx_core::shader::{Bindings, Shader, ShaderStage};

use crate::WgpuBackend;
use crate::tables::{blend_state, depth_state, layout_entry, texture_format};

/// A pipeline and the layout of its one bind group.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) stage: Stage,
    layout: wgpu::BindGroupLayout,
}

/// Which kind of pipeline it is.
#[derive(Debug)]
pub(crate) enum Stage {
    Compute(wgpu::ComputePipeline),
    Raster(wgpu::RenderPipeline),
}

impl WgpuBackend {
    pub(crate) fn make_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        let shader = &desc.shader;
        let entry = shader.entry_point(ShaderStage::Compute)?.name.clone();
        self.caps.check(shader.label, &[Need::StorageBuffers(shader.storage_buffers())])?;
        let pipeline = self.guarded(shader.label, 0, |backend| {
            let (module, layout, pipeline_layout) = backend.parts(shader);
            let pipeline = backend.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(shader.label),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(&entry),
                compilation_options: compilation_options(),
                cache: None,
            });
            Pipeline { stage: Stage::Compute(pipeline), layout }
        })?;
        Ok(Kernel { pipeline: self.pipelines.insert(pipeline).into(), shader: shader.clone() })
    }

    pub(crate) fn make_raster(&mut self, desc: &RasterDesc) -> Result<Kernel> {
        let shader = &desc.shader;
        let vertex = shader.entry_point(ShaderStage::Vertex)?.name.clone();
        let fragment = shader.entry_point(ShaderStage::Fragment)?.name.clone();
        self.caps.check(shader.label, &[Need::StorageBuffers(shader.storage_buffers())])?;
        let targets: Vec<_> = desc
            .targets
            .iter()
            .map(|&(format, blend)| {
                Some(wgpu::ColorTargetState {
                    format: texture_format(format),
                    blend: blend_state(blend),
                    write_mask: wgpu::ColorWrites::ALL,
                })
            })
            .collect();
        let pipeline = self.guarded(shader.label, 0, |backend| {
            let (module, layout, pipeline_layout) = backend.parts(shader);
            let pipeline = backend.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(shader.label),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(&vertex),
                    compilation_options: compilation_options(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: depth_state(desc.depth),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(&fragment),
                    compilation_options: compilation_options(),
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            });
            Pipeline { stage: Stage::Raster(pipeline), layout }
        })?;
        Ok(Kernel { pipeline: self.pipelines.insert(pipeline).into(), shader: shader.clone() })
    }

    fn parts(&self, shader: &Shader) -> (wgpu::ShaderModule, wgpu::BindGroupLayout, wgpu::PipelineLayout) {
        let label = Some(shader.label);
        let descriptor = wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Naga(Cow::Owned(shader.module().clone())),
        };
        let checks = wgpu::ShaderRuntimeChecks { force_loop_bounding: false, ..wgpu::ShaderRuntimeChecks::checked() };
        // SAFETY: all checks of memory accesses stay on. Off is only the counter that ends endless loops, which costs
        // every turn of every loop; the library's loops end by their own bounds.
        let module = unsafe { self.device.create_shader_module_trusted(descriptor, checks) };
        let entries: Vec<_> = shader.slots.iter().map(layout_entry).collect();
        let layout =
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        (module, layout, pipeline_layout)
    }

    /// Makes sure that the bind group of a pass exists; frames repeat themselves, so it mostly does.
    pub(crate) fn prepare_bind_group(&mut self, kernel: &Kernel, bindings: &Bindings) {
        let key = (kernel.pipeline, bindings.clone());
        if self.bind_groups.contains_key(&key) {
            return;
        }
        let label = kernel.label();
        let entries: Vec<_> = kernel
            .shader
            .slots
            .iter()
            .zip(bindings.resources())
            .map(|(slot, &resource)| wgpu::BindGroupEntry {
                binding: slot.binding,
                resource: match resource {
                    Resource::Buffer(id) => self.buffer(id, label).as_entire_binding(),
                    Resource::Texture(id) => wgpu::BindingResource::TextureView(&self.texture(id, label).view),
                },
            })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &self.pipeline(kernel.pipeline, label).layout,
            entries: &entries,
        });
        self.bind_groups.insert(key, group);
    }

    pub(crate) fn bind_group(&self, kernel: &Kernel, bindings: &Bindings) -> &wgpu::BindGroup {
        &self.bind_groups[&(kernel.pipeline, bindings.clone())]
    }

    pub(crate) fn pipeline(&self, id: PipelineId, what: &str) -> &Pipeline {
        self.pipelines.expect(id.0, what)
    }
}

fn compilation_options() -> wgpu::PipelineCompilationOptions<'static> {
    // No kernel relies on group memory being zero.
    wgpu::PipelineCompilationOptions { zero_initialize_workgroup_memory: false, ..Default::default() }
}
