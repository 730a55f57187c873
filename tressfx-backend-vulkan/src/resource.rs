//! Buffers and textures: made here, or imported from an engine.

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocation;
use tressfx_core::backend::{BufferDesc, Format, TextureDesc};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::tables::{buffer_usages, has_view};
use crate::uses::EngineUse;

/// A buffer.
#[derive(Debug)]
pub(crate) struct Buffer {
    pub(crate) buffer: vk::Buffer,
    pub(crate) owner: Ownership,
}

/// A texture and its view.
#[derive(Debug)]
pub(crate) struct Texture {
    pub(crate) image: vk::Image,
    /// Null where it is only copied.
    pub(crate) view: vk::ImageView,
    pub(crate) size: [u32; 2],
    pub(crate) format: Format,
    pub(crate) owner: Ownership,
}

/// Whose memory it is.
#[derive(Debug)]
pub(crate) enum Ownership {
    /// Ours.
    Us(Allocation),
    /// An engine's. Each recording begins with a barrier from its initial use and ends with one to its final use.
    Engine {
        /// The engine's use before each recording.
        initial_use: EngineUse,
        /// The engine's use after each recording.
        final_use: EngineUse,
    },
}

impl Gpu {
    pub(crate) fn destroy_buffer(&self, buffer: Buffer) {
        if let Ownership::Us(memory) = buffer.owner {
            // SAFETY: the caller knows that the GPU has finished with it.
            unsafe { self.device.destroy_buffer(buffer.buffer, None) };
            self.free(memory);
        }
    }

    pub(crate) fn destroy_texture(&self, texture: Texture) {
        // SAFETY: the caller knows that the GPU has finished with it. The view is ours even of an engine's image.
        unsafe { self.device.destroy_image_view(texture.view, None) };
        if let Ownership::Us(memory) = texture.owner {
            // SAFETY: as above.
            unsafe { self.device.destroy_image(texture.image, None) };
            self.free(memory);
        }
    }

    fn view_of(&self, desc: &TextureDesc, image: vk::Image) -> Result<vk::ImageView> {
        match has_view(desc.uses) {
            true => self.view(desc.label, image, desc.format),
            false => Ok(vk::ImageView::null()),
        }
    }
}

impl VulkanBackend {
    /// Makes an engine's buffer known. It stays the engine's. Before each recording that uses it the engine has used it as
    /// `initial_use` says, after it as `final_use` says.
    ///
    /// # Errors
    /// Those of [`BufferDesc::check`].
    ///
    /// # Safety
    /// It is a buffer of this device, as `desc` says, whose usages are those that `desc` names. It lives until its id was
    /// destroyed and the backend [uses](Self::uses) it no more, or until the backend is gone.
    pub unsafe fn import_buffer(
        &mut self,
        buffer: vk::Buffer,
        desc: &BufferDesc,
        initial_use: EngineUse,
        final_use: EngineUse,
    ) -> Result<BufferId> {
        desc.check(self.catalog.caps())?;
        Ok(self.catalog.import_buffer(desc, Buffer { buffer, owner: Ownership::Engine { initial_use, final_use } }))
    }

    /// Makes an engine's texture known: 2D; its first mip level and layer are used. It stays the engine's. Before each
    /// recording that uses it the engine has used it as `initial_use` says, after it as `final_use` says.
    ///
    /// # Errors
    /// Those of [`TextureDesc::check`], or if no view of it can be made.
    ///
    /// # Safety
    /// As [`import_buffer`](Self::import_buffer).
    pub unsafe fn import_texture(
        &mut self,
        image: vk::Image,
        desc: &TextureDesc,
        initial_use: EngineUse,
        final_use: EngineUse,
    ) -> Result<TextureId> {
        desc.check(self.catalog.caps())?;
        let view = self.gpu.view_of(desc, image)?;
        let owner = Ownership::Engine { initial_use, final_use };
        let texture = Texture { image, view, size: desc.size, format: desc.format, owner };
        Ok(self.catalog.import_texture(desc, texture))
    }

    pub(crate) fn make_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        desc.check(self.catalog.caps())?;
        self.gpu.check_lost()?;
        let usage = buffer_usages(desc.uses);
        let (buffer, memory) = self.gpu.buffer(desc.label, desc.bytes, usage, MemoryLocation::GpuOnly)?;
        let id = self.catalog.add_buffer(desc, Buffer { buffer, owner: Ownership::Us(memory) });
        self.tracker.not_zeroed.push(id.into());
        Ok(id)
    }

    pub(crate) fn make_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        desc.check(self.catalog.caps())?;
        self.gpu.check_lost()?;
        let (image, memory) = self.gpu.image(desc)?;
        let view = match self.gpu.view_of(desc, image) {
            Ok(view) => view,
            Err(error) => {
                // SAFETY: nothing uses it.
                unsafe { self.gpu.device.destroy_image(image, None) };
                self.gpu.free(memory);
                return Err(error);
            }
        };
        let owner = Ownership::Us(memory);
        let id = self.catalog.add_texture(desc, Texture { image, view, size: desc.size, format: desc.format, owner });
        self.tracker.not_zeroed.push(id.into());
        Ok(id)
    }
}
