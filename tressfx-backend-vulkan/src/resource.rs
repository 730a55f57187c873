//! Buffers and textures: made here, or imported from an engine.

use std::sync::PoisonError;

use ash::vk;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use gpu_allocator::{AllocationError, MemoryLocation};
use tressfx_core::backend::{BufferDesc, Format, Need, TextureDesc};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::{BufferId, Resource, TextureId};

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::error::error;
use crate::tables::{buffer_usages, texture_format, texture_usages, whole};

/// A buffer.
#[derive(Debug)]
pub(crate) struct Buffer {
    pub(crate) buffer: vk::Buffer,
    pub(crate) bytes: u64,
    pub(crate) owner: Owner,
}

/// A texture and its view.
#[derive(Debug)]
pub(crate) struct Texture {
    pub(crate) image: vk::Image,
    pub(crate) view: vk::ImageView,
    pub(crate) size: [u32; 2],
    pub(crate) format: Format,
    pub(crate) owner: Owner,
}

impl Texture {
    pub(crate) fn bytes(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1]) * u64::from(self.format.bytes())
    }
}

/// Whose memory it is.
#[derive(Debug)]
pub(crate) enum Owner {
    /// Ours.
    Us(Allocation),
    /// An engine's: found in one use at the beginning of each recording, and left in another at its end.
    Engine {
        /// As it is found.
        found: Import,
        /// As it is left.
        left: Import,
    },
}

/// A use of an imported resource in the engine's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Import {
    /// The stages that use it.
    pub stage: vk::PipelineStageFlags2,
    /// What they do.
    pub access: vk::AccessFlags2,
    /// The layout of a texture; of no meaning for a buffer.
    pub layout: vk::ImageLayout,
}

impl Import {
    /// Read by fragment shaders.
    pub const SAMPLED: Self = Self {
        stage: vk::PipelineStageFlags2::FRAGMENT_SHADER,
        access: vk::AccessFlags2::SHADER_READ,
        layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
    };

    /// Drawn to as a colour target.
    pub const COLOR_TARGET: Self = Self {
        stage: vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT,
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::COLOR_ATTACHMENT_READ.as_raw() | vk::AccessFlags2::COLOR_ATTACHMENT_WRITE.as_raw(),
        ),
        layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
    };

    /// Drawn to as a depth target.
    pub const DEPTH_TARGET: Self = Self {
        stage: vk::PipelineStageFlags2::from_raw(
            vk::PipelineStageFlags2::EARLY_FRAGMENT_TESTS.as_raw()
                | vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS.as_raw(),
        ),
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
                | vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
        ),
        layout: vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    };

    /// Read and written by compute shaders.
    pub const COMPUTE: Self = Self {
        stage: vk::PipelineStageFlags2::COMPUTE_SHADER,
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::SHADER_READ.as_raw() | vk::AccessFlags2::SHADER_WRITE.as_raw(),
        ),
        layout: vk::ImageLayout::GENERAL,
    };
}

/// Memory that the CPU sees.
#[derive(Debug)]
pub(crate) struct HostBuffer {
    pub(crate) buffer: vk::Buffer,
    pub(crate) bytes: u64,
    pub(crate) memory: Allocation,
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
        // SAFETY: the device is alive.
        let buffer = unsafe { self.device.create_buffer(&info, None) }.map_err(|code| error(code, label, bytes))?;
        self.name(buffer, label);
        // SAFETY: it was just made.
        let requirements = unsafe { self.device.get_buffer_memory_requirements(buffer) };
        let bind = |memory: &Allocation| {
            // SAFETY: buffer and memory are new, and the memory is as the buffer requires.
            unsafe { self.device.bind_buffer_memory(buffer, memory.memory(), memory.offset()) }
        };
        match self.allocate(label, requirements, location, true, bind) {
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

    fn allocate(
        &self,
        name: Label,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
        bind: impl FnOnce(&Allocation) -> ash::prelude::VkResult<()>,
    ) -> Result<Allocation> {
        let allocation_scheme = AllocationScheme::GpuAllocatorManaged;
        let desc = AllocationCreateDesc { name, requirements, location, linear, allocation_scheme };
        let mut allocator = self.allocator.lock().unwrap_or_else(PoisonError::into_inner);
        let memory = allocator.allocate(&desc).map_err(|error| match error {
            AllocationError::OutOfMemory => Error::OutOfMemory { label: name, bytes: requirements.size },
            error => Error::Backend { label: name, message: error.to_string() },
        })?;
        if let Err(code) = bind(&memory) {
            // Memory that was just given is taken back.
            let _ = allocator.free(memory);
            return Err(error(code, name, requirements.size));
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

    fn image(&self, desc: &TextureDesc) -> Result<(vk::Image, Allocation)> {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(texture_format(desc.format))
            .extent(vk::Extent3D { width: desc.size[0], height: desc.size[1], depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(texture_usages(desc.format));
        // SAFETY: the device is alive, and the size was held against its limits.
        let image = unsafe { self.device.create_image(&info, None) };
        let image = image.map_err(|code| error(code, desc.label, desc.bytes()))?;
        self.name(image, desc.label);
        // SAFETY: it was just made.
        let requirements = unsafe { self.device.get_image_memory_requirements(image) };
        let bind = |memory: &Allocation| {
            // SAFETY: image and memory are new, and the memory is as the image requires.
            unsafe { self.device.bind_image_memory(image, memory.memory(), memory.offset()) }
        };
        match self.allocate(desc.label, requirements, MemoryLocation::GpuOnly, false, bind) {
            Ok(memory) => Ok((image, memory)),
            Err(error) => {
                // SAFETY: nothing uses it.
                unsafe { self.device.destroy_image(image, None) };
                Err(error)
            }
        }
    }

    fn view(&self, label: Label, image: vk::Image, format: Format) -> Result<vk::ImageView> {
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(texture_format(format))
            .subresource_range(whole(format));
        // SAFETY: the image is alive.
        let view = unsafe { self.device.create_image_view(&info, None) }.map_err(|code| error(code, label, 0))?;
        self.name(view, label);
        Ok(view)
    }

    pub(crate) fn destroy_buffer(&self, buffer: Buffer) {
        if let Owner::Us(memory) = buffer.owner {
            // SAFETY: the caller knows that the GPU has finished with it.
            unsafe { self.device.destroy_buffer(buffer.buffer, None) };
            self.free(memory);
        }
    }

    pub(crate) fn destroy_texture(&self, texture: Texture) {
        // SAFETY: the caller knows that the GPU has finished with it. The view is ours even of an engine's image.
        unsafe { self.device.destroy_image_view(texture.view, None) };
        if let Owner::Us(memory) = texture.owner {
            // SAFETY: as above.
            unsafe { self.device.destroy_image(texture.image, None) };
            self.free(memory);
        }
    }
}

impl VulkanBackend {
    /// Makes an engine's buffer known. It stays the engine's.
    ///
    /// # Safety
    /// It is a buffer of this device with `bytes` bytes and the usages that its passes and copies ask for, and it lives
    /// until its id was destroyed and everything recorded with it has run.
    pub unsafe fn import_buffer(&mut self, buffer: vk::Buffer, bytes: u64, found: Import, left: Import) -> BufferId {
        self.buffers.insert(Buffer { buffer, bytes, owner: Owner::Engine { found, left } }).into()
    }

    /// Makes an engine's texture known: 2D; its first mip level and layer are used. It stays the engine's.
    ///
    /// # Errors
    /// If no view of it can be made.
    ///
    /// # Safety
    /// It is a texture of this device, as `desc` says, with the usages that its passes and copies ask for, and it lives
    /// until its id was destroyed and everything recorded with it has run.
    pub unsafe fn import_texture(
        &mut self,
        image: vk::Image,
        desc: &TextureDesc,
        found: Import,
        left: Import,
    ) -> Result<TextureId> {
        let view = self.gpu.view(desc.label, image, desc.format)?;
        let owner = Owner::Engine { found, left };
        Ok(self.textures.insert(Texture { image, view, size: desc.size, format: desc.format, owner }).into())
    }

    pub(crate) fn make_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        self.caps.check(desc.label, &[Need::StorageBindingBytes(desc.bytes)])?;
        let usage = buffer_usages(desc.usage);
        let (buffer, memory) = self.gpu.buffer(desc.label, desc.bytes, usage, MemoryLocation::GpuOnly)?;
        self.memory.add(desc.bytes);
        let slot = self.buffers.insert(Buffer { buffer, bytes: desc.bytes, owner: Owner::Us(memory) });
        let id = BufferId::from(slot);
        self.not_zeroed.push(id.into());
        Ok(id)
    }

    pub(crate) fn make_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        self.caps.check(desc.label, &[Need::TextureEdge(desc.size[0].max(desc.size[1]))])?;
        let (image, memory) = self.gpu.image(desc)?;
        let view = match self.gpu.view(desc.label, image, desc.format) {
            Ok(view) => view,
            Err(error) => {
                // SAFETY: nothing uses it.
                unsafe { self.gpu.device.destroy_image(image, None) };
                self.gpu.free(memory);
                return Err(error);
            }
        };
        self.memory.add(desc.bytes());
        let owner = Owner::Us(memory);
        let slot = self.textures.insert(Texture { image, view, size: desc.size, format: desc.format, owner });
        let id = TextureId::from(slot);
        self.not_zeroed.push(id.into());
        Ok(id)
    }

    /// Forgets a resource; it is freed once everything that was recorded so far has run.
    pub(crate) fn forget(&mut self, resource: Resource) {
        let (garbage, bytes) = match resource {
            Resource::Buffer(id) => {
                let Some(buffer) = self.buffers.remove(id.0) else { return };
                let bytes = if matches!(buffer.owner, Owner::Us(_)) { buffer.bytes } else { 0 };
                (crate::frame::Garbage::Buffer(buffer), bytes)
            }
            Resource::Texture(id) => {
                let Some(texture) = self.textures.remove(id.0) else { return };
                let bytes = if matches!(texture.owner, Owner::Us(_)) { texture.bytes() } else { 0 };
                (crate::frame::Garbage::Texture(texture), bytes)
            }
        };
        self.memory.remove(bytes);
        self.hazards.forget(resource);
        self.frames.forget(resource);
        self.not_zeroed.retain(|&other| other != resource);
        self.forget_sets(|_, bindings| bindings.resources().contains(&resource));
        self.throw_away(garbage);
    }

    pub(crate) fn buffer(&self, id: BufferId, what: &str) -> &Buffer {
        self.buffers.expect(id.0, what)
    }

    pub(crate) fn texture(&self, id: TextureId, what: &str) -> &Texture {
        self.textures.expect(id.0, what)
    }

    /// What a resource takes in memory, whoever owns it.
    pub(crate) fn bytes(&self, resource: Resource) -> u64 {
        match resource {
            Resource::Buffer(id) => self.buffer(id, "record").bytes,
            Resource::Texture(id) => self.texture(id, "record").bytes(),
        }
    }
}
