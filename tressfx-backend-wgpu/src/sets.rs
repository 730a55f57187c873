//! Bind groups: made once for a pipeline and its bindings, forgotten with the resources in them.

use std::collections::{HashMap, HashSet};

use tressfx_core::backend::Unlisted;
use tressfx_core::error::Result;
use tressfx_core::id::{PipelineId, Resource};
use tressfx_core::pass::{Command, PassList};
use tressfx_core::shader::{Binding, Bindings, Sampler, Shader};

use crate::WgpuBackend;
use crate::error::ignoring;

/// All bind groups, and the two samplers.
#[derive(Debug)]
pub(crate) struct BindGroups {
    groups: HashMap<(PipelineId, Bindings), wgpu::BindGroup>,
    linear: wgpu::Sampler,
    nearest: wgpu::Sampler,
}

impl BindGroups {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let sampler = |label, filter, mipmap_filter| {
            let desc = wgpu::SamplerDescriptor {
                label: Some(label),
                mag_filter: filter,
                min_filter: filter,
                mipmap_filter,
                ..Default::default()
            };
            ignoring(device, || device.create_sampler(&desc))
        };
        Self {
            groups: HashMap::new(),
            linear: sampler("hair.linear", wgpu::FilterMode::Linear, wgpu::MipmapFilterMode::Nearest),
            nearest: sampler("hair.nearest", wgpu::FilterMode::Nearest, wgpu::MipmapFilterMode::Nearest),
        }
    }

    /// How many there are.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.groups.len()
    }

    /// Forgets the groups of what is gone.
    pub(crate) fn forget<B, T, P>(&mut self, swept: &[Unlisted<B, T, P>]) {
        let mut resources = HashSet::new();
        let mut pipelines = HashSet::new();
        for swept in swept {
            match swept {
                Unlisted::Buffer(id, _) => drop(resources.insert(Resource::from(*id))),
                Unlisted::Texture(id, _) => drop(resources.insert(Resource::from(*id))),
                Unlisted::Pipeline(id, _) => drop(pipelines.insert(*id)),
            }
        }
        self.groups.retain(|(pipeline, bindings), _| {
            !pipelines.contains(pipeline) && !bindings.resources().any(|resource| resources.contains(&resource))
        });
    }
}

impl WgpuBackend {
    /// The bind groups of all passes and draws of a list, in its order. Frames repeat themselves, so they mostly exist.
    pub(crate) fn prepare_bind_groups(&mut self, list: &PassList) -> Result<Vec<wgpu::BindGroup>> {
        let mut groups = Vec::with_capacity(list.commands().len());
        for command in list.commands() {
            match command {
                Command::Compute(pass) => {
                    groups.push(self.bind_group(pass.kernel.pipeline, &pass.kernel.shader, &pass.bindings)?);
                }
                Command::Raster(pass) => {
                    for draw in &pass.draws {
                        groups.push(self.bind_group(draw.pipeline.pipeline, &draw.pipeline.shader, &draw.bindings)?);
                    }
                }
                _ => {}
            }
        }
        Ok(groups)
    }

    fn bind_group(&mut self, pipeline: PipelineId, shader: &Shader, bindings: &Bindings) -> Result<wgpu::BindGroup> {
        let key = (pipeline, bindings.clone());
        if let Some(group) = self.bind_groups.groups.get(&key) {
            return Ok(group.clone());
        }
        let group = self.guarded(shader.label, 0, |backend| {
            let slots = shader.slots.iter().zip(bindings.all());
            let entries: Vec<_> = slots
                .map(|(slot, binding)| wgpu::BindGroupEntry {
                    binding: slot.binding,
                    resource: backend.binding(binding),
                })
                .collect();
            Ok(backend.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(shader.label),
                layout: &backend.catalog.pipeline(pipeline).layout,
                entries: &entries,
            }))
        })?;
        self.bind_groups.groups.insert(key, group.clone());
        Ok(group)
    }

    fn binding(&self, binding: &Binding) -> wgpu::BindingResource<'_> {
        match *binding {
            Binding::Buffer { id, offset, bytes } => wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: self.catalog.buffer(id),
                offset,
                size: bytes.and_then(std::num::NonZeroU64::new),
            }),
            Binding::Texture(id) => wgpu::BindingResource::TextureView(&self.catalog.texture(id).view),
            Binding::Sampler(Sampler::Linear) => wgpu::BindingResource::Sampler(&self.bind_groups.linear),
            Binding::Sampler(_) => wgpu::BindingResource::Sampler(&self.bind_groups.nearest),
            _ => unreachable!("checked with the list"),
        }
    }
}
