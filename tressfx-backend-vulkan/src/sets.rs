//! What pipelines bind: one descriptor set for each pipeline and bindings, made once. Frames repeat themselves.

use std::collections::HashMap;

use ash::vk;
use tressfx_core::error::{Label, Result};
use tressfx_core::id::PipelineId;
use tressfx_core::shader::{Binding, Bindings, Sampler, Shader};

use crate::Resources;
use crate::device::Gpu;
use crate::error::unknown;
use crate::tables::descriptor_type;

/// Sets of one pool.
const SETS: u32 = 128;

/// The sets, the pools that they are from, and the samplers that they name.
#[derive(Debug, Default)]
pub(crate) struct Sets {
    made: HashMap<(PipelineId, Bindings), Set>,
    pools: Vec<Pool>,
    /// Linear and nearest; null until a set names one.
    samplers: [vk::Sampler; 2],
}

/// A descriptor set and its pool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Set {
    set: vk::DescriptorSet,
    pool: vk::DescriptorPool,
}

#[derive(Debug)]
struct Pool {
    pool: vk::DescriptorPool,
    /// Sets that were allocated from it and not freed.
    live: u32,
}

impl Sets {
    /// The set of a pass that was [prepared](Self::prepare).
    pub(crate) fn get(&self, pipeline: PipelineId, bindings: &Bindings) -> vk::DescriptorSet {
        self.made[&(pipeline, bindings.clone())].set
    }

    /// Makes sure that the set of a pass exists.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        resources: &Resources,
        (pipeline, shader): (PipelineId, &Shader),
        bindings: &Bindings,
    ) -> Result<()> {
        let key = (pipeline, bindings.clone());
        if self.made.contains_key(&key) {
            return Ok(());
        }
        for binding in bindings.all() {
            if let Binding::Sampler(sampler) = binding {
                self.make_sampler(gpu, *sampler)?;
            }
        }
        let set = self.allocate(gpu, resources.pipeline(pipeline).set_layout, shader.label)?;
        if let Err(error) = self.write(gpu, resources, set.set, shader, bindings) {
            self.free(gpu, set);
            return Err(error);
        }
        self.made.insert(key, set);
        Ok(())
    }

    /// A new set, from the first pool that has room or from a new one.
    fn allocate(&mut self, gpu: &Gpu, layout: vk::DescriptorSetLayout, label: Label) -> Result<Set> {
        let layouts = [layout];
        let allocate = |pool: &mut Pool| {
            let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool.pool).set_layouts(&layouts);
            // SAFETY: pool and layout are alive.
            let set = gpu.faults.next().and_then(|()| unsafe { gpu.device.allocate_descriptor_sets(&info) })?[0];
            pool.live += 1;
            gpu.name(set, label);
            Ok(Set { set, pool: pool.pool })
        };
        for pool in self.pools.iter_mut().filter(|pool| pool.live < SETS) {
            match allocate(pool) {
                Err(vk::Result::ERROR_OUT_OF_POOL_MEMORY | vk::Result::ERROR_FRAGMENTED_POOL) => {}
                made => return made.map_err(|code| gpu.failed(code, label, 0)),
            }
        }
        let mut pool = Pool { pool: gpu.pool()?, live: 0 };
        let made = allocate(&mut pool).map_err(|code| gpu.failed(code, label, 0));
        self.pools.push(pool);
        made
    }

    fn write(
        &self,
        gpu: &Gpu,
        resources: &Resources,
        set: vk::DescriptorSet,
        shader: &Shader,
        bindings: &Bindings,
    ) -> Result<()> {
        for (slot, binding) in shader.slots.iter().zip(bindings.all()) {
            let ty = descriptor_type(slot.kind).ok_or_else(|| unknown(shader.label, slot.kind))?;
            let (mut buffer, mut image) = ([vk::DescriptorBufferInfo::default()], [vk::DescriptorImageInfo::default()]);
            match *binding {
                Binding::Buffer { id, offset, bytes } => {
                    let whole = resources.bytes(id.into()).saturating_sub(offset);
                    buffer[0] = buffer[0].buffer(resources.buffer(id).buffer).offset(offset);
                    buffer[0] = buffer[0].range(bytes.unwrap_or(whole));
                }
                Binding::Texture(id) => {
                    let layout = match ty {
                        vk::DescriptorType::STORAGE_IMAGE => vk::ImageLayout::GENERAL,
                        _ => vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
                    };
                    image[0] = image[0].image_view(resources.texture(id).view).image_layout(layout);
                }
                Binding::Sampler(sampler) => image[0] = image[0].sampler(self.samplers[place(sampler)]),
                _ => return Err(unknown(shader.label, binding)),
            }
            let write = vk::WriteDescriptorSet::default().dst_set(set).dst_binding(slot.binding).descriptor_type(ty);
            let write = match slot.kind.is_buffer() {
                true => write.buffer_info(&buffer),
                false => write.image_info(&image),
            };
            // SAFETY: the set is new, and what is bound is alive and of the kind that the layout says.
            unsafe { gpu.device.update_descriptor_sets(&[write], &[]) };
        }
        Ok(())
    }

    fn make_sampler(&mut self, gpu: &Gpu, sampler: Sampler) -> Result<()> {
        let made = &mut self.samplers[place(sampler)];
        if *made != vk::Sampler::null() {
            return Ok(());
        }
        let (filter, label) = match sampler {
            Sampler::Linear => (vk::Filter::LINEAR, "hair.linear"),
            Sampler::Nearest => (vk::Filter::NEAREST, "hair.nearest"),
        };
        let clamped = vk::SamplerAddressMode::CLAMP_TO_EDGE;
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .address_mode_u(clamped)
            .address_mode_v(clamped)
            .address_mode_w(clamped);
        // SAFETY: the device is alive.
        *made = gpu.create(label, |device| unsafe { device.create_sampler(&info, None) })?;
        Ok(())
    }

    /// Takes out the sets of some pipelines and bindings, to be freed once nothing that was recorded can use them.
    pub(crate) fn forget(&mut self, of: impl Fn(PipelineId, &Bindings) -> bool) -> Vec<Set> {
        let gone = self.made.extract_if(|(pipeline, bindings), _| of(*pipeline, bindings));
        gone.map(|(_, set)| set).collect()
    }

    /// Frees a set. A pool without sets is made whole again, and one such pool is kept.
    pub(crate) fn free(&mut self, gpu: &Gpu, set: Set) {
        let Some(index) = self.pools.iter().position(|pool| pool.pool == set.pool) else { return };
        let pool = &mut self.pools[index];
        pool.live -= 1;
        // SAFETY: no recording that can still run binds the set; and none that of a pool which has no others.
        unsafe {
            if pool.live > 0 {
                // It cannot fail.
                let _ = gpu.device.free_descriptor_sets(pool.pool, &[set.set]);
            } else if self.pools.iter().filter(|pool| pool.live == 0).count() > 1 {
                gpu.device.destroy_descriptor_pool(self.pools.swap_remove(index).pool, None);
            } else {
                let _ = gpu.device.reset_descriptor_pool(set.pool, vk::DescriptorPoolResetFlags::empty());
            }
        }
    }

    /// How many pools there are.
    #[cfg(feature = "faults")]
    pub(crate) fn pools(&self) -> usize {
        self.pools.len()
    }

    pub(crate) fn destroy(&mut self, gpu: &Gpu) {
        self.made.clear();
        // SAFETY: the GPU has finished with their sets; null is nothing to destroy.
        unsafe {
            self.pools.drain(..).for_each(|pool| gpu.device.destroy_descriptor_pool(pool.pool, None));
            self.samplers.into_iter().for_each(|sampler| gpu.device.destroy_sampler(sampler, None));
        }
        self.samplers = Default::default();
    }
}

fn place(sampler: Sampler) -> usize {
    match sampler {
        Sampler::Linear => 0,
        Sampler::Nearest => 1,
    }
}

impl Gpu {
    fn pool(&self) -> Result<vk::DescriptorPool> {
        let count = |ty, each: u32| vk::DescriptorPoolSize { ty, descriptor_count: each * SETS };
        let sizes = [
            count(vk::DescriptorType::STORAGE_BUFFER, 8),
            count(vk::DescriptorType::UNIFORM_BUFFER, 4),
            count(vk::DescriptorType::SAMPLED_IMAGE, 4),
            count(vk::DescriptorType::STORAGE_IMAGE, 1),
            count(vk::DescriptorType::SAMPLER, 1),
        ];
        let info = vk::DescriptorPoolCreateInfo::default()
            .flags(vk::DescriptorPoolCreateFlags::FREE_DESCRIPTOR_SET)
            .max_sets(SETS)
            .pool_sizes(&sizes);
        // SAFETY: the device is alive.
        self.create("hair.sets", |device| unsafe { device.create_descriptor_pool(&info, None) })
    }
}
