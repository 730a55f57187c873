//! Buffers and images of the engine, from its allocator.

use std::sync::PoisonError;

use anyhow::{Context, Result};
use tressfx_backend_vulkan::ash::vk;
use tressfx_backend_vulkan::gpu_allocator::MemoryLocation;
use tressfx_backend_vulkan::gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};

use crate::gpu::Gpu;

/// A buffer that the CPU sees.
pub(crate) struct Buffer {
    pub(crate) buffer: vk::Buffer,
    memory: Allocation,
}

/// An image and a view of all of it.
pub(crate) struct Image {
    pub(crate) image: vk::Image,
    pub(crate) view: vk::ImageView,
    memory: Allocation,
}

impl Buffer {
    pub(crate) fn write(&mut self, bytes: &[u8]) -> Result<()> {
        let memory = self.memory.mapped_slice_mut().context("the CPU sees this memory")?;
        memory[..bytes.len()].copy_from_slice(bytes);
        Ok(())
    }

    pub(crate) fn read(&self, bytes: usize) -> Result<Vec<u8>> {
        Ok(self.memory.mapped_slice().context("the CPU sees this memory")?[..bytes].to_vec())
    }
}

impl Gpu {
    fn allocate(
        &self,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<Allocation> {
        let allocation_scheme = AllocationScheme::GpuAllocatorManaged;
        let desc = AllocationCreateDesc { name: "engine", requirements, location, linear, allocation_scheme };
        Ok(self.allocator.lock().unwrap_or_else(PoisonError::into_inner).allocate(&desc)?)
    }

    fn free(&self, memory: Allocation) -> Result<()> {
        Ok(self.allocator.lock().unwrap_or_else(PoisonError::into_inner).free(memory)?)
    }

    pub(crate) fn buffer(&self, bytes: u64, usage: vk::BufferUsageFlags, location: MemoryLocation) -> Result<Buffer> {
        let info = vk::BufferCreateInfo::default().size(bytes).usage(usage);
        // SAFETY: the device is alive, and the memory is as the buffer requires.
        unsafe {
            let buffer = self.device.create_buffer(&info, None)?;
            let memory = self.allocate(self.device.get_buffer_memory_requirements(buffer), location, true)?;
            self.device.bind_buffer_memory(buffer, memory.memory(), memory.offset())?;
            Ok(Buffer { buffer, memory })
        }
    }

    /// A buffer with these bytes.
    pub(crate) fn filled(&self, bytes: &[u8], usage: vk::BufferUsageFlags) -> Result<Buffer> {
        let mut buffer = self.buffer(bytes.len() as u64, usage, MemoryLocation::CpuToGpu)?;
        buffer.write(bytes)?;
        Ok(buffer)
    }

    pub(crate) fn image(
        &self,
        [width, height]: [u32; 2],
        format: vk::Format,
        usage: vk::ImageUsageFlags,
    ) -> Result<Image> {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        // SAFETY: the device is alive, and the memory is as the image requires.
        unsafe {
            let image = self.device.create_image(&info, None)?;
            let requirements = self.device.get_image_memory_requirements(image);
            let memory = self.allocate(requirements, MemoryLocation::GpuOnly, false)?;
            self.device.bind_image_memory(image, memory.memory(), memory.offset())?;
            let info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(format)
                .subresource_range(whole(format));
            let view = self.device.create_image_view(&info, None)?;
            Ok(Image { image, view, memory })
        }
    }

    pub(crate) fn destroy_buffer(&self, buffer: Buffer) -> Result<()> {
        // SAFETY: the GPU has finished with it.
        unsafe { self.device.destroy_buffer(buffer.buffer, None) };
        self.free(buffer.memory)
    }

    pub(crate) fn destroy_image(&self, image: Image) -> Result<()> {
        // SAFETY: the GPU has finished with it.
        unsafe {
            self.device.destroy_image_view(image.view, None);
            self.device.destroy_image(image.image, None);
        }
        self.free(image.memory)
    }
}

/// The only level and layer of an image.
pub(crate) fn whole(format: vk::Format) -> vk::ImageSubresourceRange {
    let aspect =
        if format == vk::Format::D32_SFLOAT { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR };
    vk::ImageSubresourceRange { aspect_mask: aspect, level_count: 1, layer_count: 1, ..Default::default() }
}
