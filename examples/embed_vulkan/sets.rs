//! Descriptor sets of the engine, each with one binding.

use anyhow::Result;
use tressfx_backend_vulkan::ash::vk;

use crate::gpu::Gpu;
use crate::pipeline::Pipeline;

impl Gpu {
    pub(crate) fn set_pool(&self) -> Result<vk::DescriptorPool> {
        let size = |ty| vk::DescriptorPoolSize { ty, descriptor_count: 4 };
        let sizes = [size(vk::DescriptorType::UNIFORM_BUFFER), size(vk::DescriptorType::SAMPLED_IMAGE)];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(4).pool_sizes(&sizes);
        // SAFETY: the device is alive.
        Ok(unsafe { self.device.create_descriptor_pool(&info, None) }?)
    }

    pub(crate) fn set(&self, pool: vk::DescriptorPool, pipeline: &Pipeline) -> Result<vk::DescriptorSet> {
        let layouts = [pipeline.set_layout];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: pool and layout are alive.
        Ok(unsafe { self.device.allocate_descriptor_sets(&info) }?[0])
    }

    pub(crate) fn bind_buffer(&self, set: vk::DescriptorSet, buffer: vk::Buffer) {
        let buffer = [vk::DescriptorBufferInfo { buffer, offset: 0, range: vk::WHOLE_SIZE }];
        let ty = vk::DescriptorType::UNIFORM_BUFFER;
        let write = [vk::WriteDescriptorSet::default().dst_set(set).descriptor_type(ty).buffer_info(&buffer)];
        // SAFETY: no frame uses the set yet.
        unsafe { self.device.update_descriptor_sets(&write, &[]) };
    }

    pub(crate) fn bind_image(&self, set: vk::DescriptorSet, image_view: vk::ImageView) {
        let image_layout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
        let image = [vk::DescriptorImageInfo { sampler: vk::Sampler::null(), image_view, image_layout }];
        let ty = vk::DescriptorType::SAMPLED_IMAGE;
        let write = [vk::WriteDescriptorSet::default().dst_set(set).descriptor_type(ty).image_info(&image)];
        // SAFETY: no frame uses the set yet.
        unsafe { self.device.update_descriptor_sets(&write, &[]) };
    }
}
