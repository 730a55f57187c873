//! Bytes that come back from the GPU.

use ash::vk;
use gpu_allocator::MemoryLocation;
use tressfx_core::backend::Format;
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::Ticket;

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::frame::Garbage;
use crate::resource::HostBuffer;
use crate::tables::whole;

/// A copy on its way to the CPU.
#[derive(Debug)]
pub(crate) struct PendingRead {
    copy: HostBuffer,
    /// How many bytes were asked for.
    bytes: u64,
    /// The recording that makes it.
    recording: u64,
}

impl PendingRead {
    pub(crate) fn destroy(self, gpu: &Gpu) {
        gpu.free_host(self.copy);
    }
}

impl VulkanBackend {
    fn pending(&mut self, ticket: Ticket, bytes: u64, recording: u64) -> Result<vk::Buffer> {
        let copy = self.gpu.host_buffer("hair.read_back", bytes.max(4), MemoryLocation::GpuToCpu)?;
        let buffer = copy.buffer;
        // A list that is recorded again brings its bytes again, whether anybody asked for the first or not.
        if let Some(unread) = self.reads.insert(ticket, PendingRead { copy, bytes, recording }) {
            self.throw_away(Garbage::Host(unread.copy));
        }
        Ok(buffer)
    }

    pub(crate) fn encode_read_buffer(
        &mut self,
        commands: vk::CommandBuffer,
        (src, offset, bytes): (BufferId, u64, u64),
        ticket: Ticket,
        recording: u64,
    ) -> Result<()> {
        let copy = self.pending(ticket, bytes, recording)?;
        let region = vk::BufferCopy { src_offset: offset, dst_offset: 0, size: bytes };
        let src = self.buffer(src, "read buffer").buffer;
        if bytes == 0 {
            return Ok(());
        }
        // SAFETY: the command buffer is being recorded, and both buffers live until it has run.
        unsafe { self.gpu.device.cmd_copy_buffer(commands, src, copy, &[region]) };
        Ok(())
    }

    pub(crate) fn encode_read_texture(
        &mut self,
        commands: vk::CommandBuffer,
        src: TextureId,
        ticket: Ticket,
        recording: u64,
    ) -> Result<()> {
        let bytes = self.texture(src, "read texture").bytes();
        let copy = self.pending(ticket, bytes, recording)?;
        let texture = self.texture(src, "read texture");
        let [width, height] = texture.size;
        // Rows without padding.
        let region = vk::BufferImageCopy::default()
            .image_subresource(layers(texture.format))
            .image_extent(vk::Extent3D { width, height, depth: 1 });
        let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        // SAFETY: as above; the barrier before it has put the texture into this layout.
        unsafe { self.gpu.device.cmd_copy_image_to_buffer(commands, texture.image, layout, copy, &[region]) };
        Ok(())
    }

    pub(crate) fn take_read(&mut self, ticket: Ticket) -> Option<Vec<u8>> {
        let recording = self.reads.get(&ticket)?.recording;
        if !self.frames.has_run(&self.gpu, recording) {
            return None;
        }
        let PendingRead { copy, bytes, .. } = self.reads.remove(&ticket)?;
        let bytes = copy.memory.mapped_slice().map(|all| all[..bytes as usize].to_vec());
        self.throw_away(Garbage::Host(copy));
        bytes
    }

    /// Drops the read-backs of a recording that never ran.
    pub(crate) fn forget_reads(&mut self, recording: u64) {
        for (_, read) in self.reads.extract_if(|_, read| read.recording == recording) {
            self.gpu.free_host(read.copy);
        }
    }
}

fn layers(format: Format) -> vk::ImageSubresourceLayers {
    vk::ImageSubresourceLayers { aspect_mask: whole(format).aspect_mask, layer_count: 1, ..Default::default() }
}
