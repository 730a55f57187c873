//! What kernels bind: one descriptor set for each pipeline and bindings, made once. Frames repeat themselves.

use std::collections::HashMap;

use ash::vk;
use tressfx_core::backend::Kernel;
use tressfx_core::error::Result;
use tressfx_core::id::{PipelineId, Resource};
use tressfx_core::shader::Bindings;

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::error::error;
use crate::frame::Garbage;
use crate::tables::descriptor_type;

/// Sets of one pool.
const SETS: u32 = 128;

/// The sets and the pools that they are from.
#[derive(Debug, Default)]
pub(crate) struct Sets {
    made: HashMap<(PipelineId, Bindings), (vk::DescriptorPool, vk::DescriptorSet)>,
    pools: Vec<vk::DescriptorPool>,
}

impl Sets {
    pub(crate) fn get(&self, kernel: &Kernel, bindings: &Bindings) -> vk::DescriptorSet {
        self.made[&(kernel.pipeline, bindings.clone())].1
    }

    /// A new set, from the newest pool or from a new one.
    fn allocate(
        &mut self,
        gpu: &Gpu,
        layout: vk::DescriptorSetLayout,
    ) -> Result<(vk::DescriptorPool, vk::DescriptorSet)> {
        let layouts = [layout];
        let from = |pool| {
            let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
            // SAFETY: pool and layout are alive.
            unsafe { gpu.device.allocate_descriptor_sets(&info) }.map(|sets| (pool, sets[0]))
        };
        if let Some(Ok(made)) = self.pools.last().map(|&pool| from(pool)) {
            return Ok(made);
        }
        let pool = gpu.pool()?;
        self.pools.push(pool);
        from(pool).map_err(|code| error(code, "hair.sets", 0))
    }

    pub(crate) fn destroy(&mut self, gpu: &Gpu) {
        self.made.clear();
        // SAFETY: the GPU has finished with their sets.
        self.pools.drain(..).for_each(|pool| unsafe { gpu.device.destroy_descriptor_pool(pool, None) });
    }
}

impl Gpu {
    fn pool(&self) -> Result<vk::DescriptorPool> {
        let count = |ty, each: u32| vk::DescriptorPoolSize { ty, descriptor_count: each * SETS };
        let sizes = [
            count(vk::DescriptorType::STORAGE_BUFFER, 8),
            count(vk::DescriptorType::UNIFORM_BUFFER, 4),
            count(vk::DescriptorType::SAMPLED_IMAGE, 4),
        ];
        let info = vk::DescriptorPoolCreateInfo::default()
            .flags(vk::DescriptorPoolCreateFlags::FREE_DESCRIPTOR_SET)
            .max_sets(SETS)
            .pool_sizes(&sizes);
        // SAFETY: the device is alive.
        let pool = unsafe { self.device.create_descriptor_pool(&info, None) };
        let pool = pool.map_err(|code| error(code, "hair.sets", 0))?;
        self.name(pool, "hair.sets");
        Ok(pool)
    }
}

impl VulkanBackend {
    /// Makes sure that the set of a pass exists.
    pub(crate) fn prepare_set(&mut self, kernel: &Kernel, bindings: &Bindings) -> Result<()> {
        let key = (kernel.pipeline, bindings.clone());
        if self.sets.made.contains_key(&key) {
            return Ok(());
        }
        let layout = self.pipeline(kernel.pipeline, kernel.label()).set_layout;
        let made = self.sets.allocate(&self.gpu, layout)?;
        self.gpu.name(made.1, kernel.label());
        self.write_set(made.1, kernel, bindings);
        self.sets.made.insert(key, made);
        Ok(())
    }

    fn write_set(&self, set: vk::DescriptorSet, kernel: &Kernel, bindings: &Bindings) {
        let label = kernel.label();
        for (slot, &resource) in kernel.shader.slots.iter().zip(bindings.resources()) {
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(slot.binding)
                .descriptor_type(descriptor_type(slot.kind));
            let (buffer, image);
            let write = match resource {
                Resource::Buffer(id) => {
                    buffer = [vk::DescriptorBufferInfo {
                        buffer: self.buffer(id, label).buffer,
                        offset: 0,
                        range: vk::WHOLE_SIZE,
                    }];
                    write.buffer_info(&buffer)
                }
                Resource::Texture(id) => {
                    image = [vk::DescriptorImageInfo {
                        sampler: vk::Sampler::null(),
                        image_view: self.texture(id, label).view,
                        image_layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
                    }];
                    write.image_info(&image)
                }
            };
            // SAFETY: the set is new, and what is bound is alive and of the kind that the layout says.
            unsafe { self.gpu.device.update_descriptor_sets(&[write], &[]) };
        }
    }

    /// Forgets sets; they are freed once everything that was recorded so far has run.
    pub(crate) fn forget_sets(&mut self, of: impl Fn(PipelineId, &Bindings) -> bool) {
        let gone: Vec<_> = self.sets.made.extract_if(|(pipeline, bindings), _| of(*pipeline, bindings)).collect();
        for (_, (pool, set)) in gone {
            self.throw_away(Garbage::Set(pool, set));
        }
    }
}
