//! Buffers and images on memory of the allocator.

use std::sync::PoisonError;

use ash::prelude::VkResult;
use ash::vk;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use gpu_allocator::{AllocationError, MemoryLocation};
use tressfx_core::backend::{Format, TextureDesc};
use tressfx_core::error::{Error, Label, Result};

use crate::device::Gpu;
use crate::error::unknown;
use crate::tables::{texture_format, texture_usages, whole};

/// Memory that the CPU sees.
#[derive(Debug)]
pub(crate) struct HostBuffer {
    pub(crate) buffer: vk::Buffer,
    pub(crate) bytes: u64,
    pub(crate) memory: Allocation,
}

/// What memory is wanted for.
struct Wanted {
    label: Label,
    requirements: vk::MemoryRequirements,
    location: MemoryLocation,
    linear: bool,
}

impl Gpu {
    /// A buffer and its memory.
    pub(crate) fn buffer(
        &self,
        label: Label,
        bytes: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<(vk::Buffer, Allocation)> {
        let info = vk::BufferCreateInfo::default().size(bytes).usage(usage);
        // SAFETY: the device is alive, and the size was held against its limits.
        let buffer = self.create(label, |device| unsafe { device.create_buffer(&info, None) })?;
        // SAFETY: it was just made.
        let requirements = unsafe { self.device.get_buffer_memory_requirements(buffer) };
        let memory = self.allocate(Wanted { label, requirements, location, linear: true }, |memory| {
            // SAFETY: buffer and memory are new, and the memory is as the buffer requires.
            unsafe { self.device.bind_buffer_memory(buffer, memory.memory(), memory.offset()) }
        });
        match memory {
            Ok(memory) => Ok((buffer, memory)),
            Err(error) => {
                // SAFETY: nothing uses it.
                unsafe { self.device.destroy_buffer(buffer, None) };
                Err(error)
            }
        }
    }

    /// Memory that the CPU writes, or reads.
    pub(crate) fn host_buffer(&self, label: Label, bytes: u64, location: MemoryLocation) -> Result<HostBuffer> {
        let usage = match location {
            MemoryLocation::GpuToCpu => vk::BufferUsageFlags::TRANSFER_DST,
            _ => vk::BufferUsageFlags::TRANSFER_SRC,
        };
        let (buffer, memory) = self.buffer(label, bytes, usage, location)?;
        Ok(HostBuffer { buffer, bytes, memory })
    }

    fn allocate(&self, wanted: Wanted, bind: impl FnOnce(&Allocation) -> VkResult<()>) -> Result<Allocation> {
        let Wanted { label: name, requirements, location, linear } = wanted;
        let allocation_scheme = AllocationScheme::GpuAllocatorManaged;
        let desc = AllocationCreateDesc { name, requirements, location, linear, allocation_scheme };
        self.faults.next().map_err(|code| self.failed(code, name, requirements.size))?;
        let mut allocator = self.allocator.lock().unwrap_or_else(PoisonError::into_inner);
        let memory = allocator.allocate(&desc).map_err(|error| match error {
            AllocationError::OutOfMemory => Error::OutOfMemory { label: name, bytes: requirements.size },
            error => Error::Backend { label: name, message: error.to_string() },
        })?;
        if let Err(code) = self.faults.next().and_then(|()| bind(&memory)) {
            // Memory that was just given is taken back.
            let _ = allocator.free(memory);
            return Err(self.failed(code, name, requirements.size));
        }
        Ok(memory)
    }

    pub(crate) fn free(&self, memory: Allocation) {
        // It fails for memory of another allocator only.
        let _ = self.allocator.lock().unwrap_or_else(PoisonError::into_inner).free(memory);
    }

    pub(crate) fn free_host(&self, buffer: HostBuffer) {
        // SAFETY: the caller knows that the GPU has finished with it.
        unsafe { self.device.destroy_buffer(buffer.buffer, None) };
        self.free(buffer.memory);
    }

    pub(crate) fn image(&self, desc: &TextureDesc) -> Result<(vk::Image, Allocation)> {
        let label = desc.label;
        let format = texture_format(desc.format).ok_or_else(|| unknown(label, desc.format))?;
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width: desc.size[0], height: desc.size[1], depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(texture_usages(desc.format, desc.uses));
        // SAFETY: the device is alive, and the size was held against its limits.
        let image = self.create(label, |device| unsafe { device.create_image(&info, None) })?;
        // SAFETY: it was just made.
        let requirements = unsafe { self.device.get_image_memory_requirements(image) };
        let wanted = Wanted { label, requirements, location: MemoryLocation::GpuOnly, linear: false };
        let memory = self.allocate(wanted, |memory| {
            // SAFETY: image and memory are new, and the memory is as the image requires.
            unsafe { self.device.bind_image_memory(image, memory.memory(), memory.offset()) }
        });
        match memory {
            Ok(memory) => Ok((image, memory)),
            Err(error) => {
                // SAFETY: nothing uses it.
                unsafe { self.device.destroy_image(image, None) };
                Err(error)
            }
        }
    }

    pub(crate) fn view(&self, label: Label, image: vk::Image, format: Format) -> Result<vk::ImageView> {
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(texture_format(format).ok_or_else(|| unknown(label, format))?)
            .subresource_range(whole(format));
        // SAFETY: the image is alive.
        self.create(label, |device| unsafe { device.create_image_view(&info, None) })
    }
}
