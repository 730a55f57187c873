//! Bytes that come back from the GPU.

use std::sync::{Arc, OnceLock};

use tressfx_core::error::{Error, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::Ticket;

use crate::WgpuBackend;

/// A copy on its way to the CPU.
#[derive(Debug)]
pub(crate) struct PendingRead {
    copy: Mapped,
    rows: Rows,
}

/// Rows of a copy: WebGPU pads them, the caller gets them tight.
#[derive(Clone, Copy, Debug)]
struct Rows {
    count: u32,
    bytes: u32,
    padded: u32,
}

/// A buffer that comes to the CPU by itself once the encoder that fills it was submitted and has run.
#[derive(Debug)]
pub(crate) struct Mapped {
    buffer: wgpu::Buffer,
    /// Whether it could be mapped; empty until then.
    mapped: Arc<OnceLock<bool>>,
}

impl Mapped {
    pub(crate) fn new(device: &wgpu::Device, bytes: u64) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("hair.read_back"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { buffer, mapped: Arc::default() }
    }

    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// After the last command of `encoder` that fills it.
    pub(crate) fn map_on_submit(&self, encoder: &wgpu::CommandEncoder) {
        let mapped = self.mapped.clone();
        encoder.map_buffer_on_submit(&self.buffer, wgpu::MapMode::Read, .., move |result| {
            let _ = mapped.set(result.is_ok());
        });
    }

    /// The bytes if they are there; never waits.
    pub(crate) fn bytes(&self, device: &wgpu::Device) -> Option<wgpu::BufferView> {
        let _ = device.poll(wgpu::PollType::Poll);
        let mapped = *self.mapped.get()?;
        mapped.then(|| self.buffer.get_mapped_range(..).ok()).flatten()
    }

    /// Whether its encoder was thrown away, and with it what would have mapped it.
    pub(crate) fn is_lost(&self) -> bool {
        Arc::strong_count(&self.mapped) == 1 && self.mapped.get().is_none()
    }
}

impl WgpuBackend {
    pub(crate) fn encode_read_buffer(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        src: BufferId,
        offset: u64,
        bytes: u64,
        ticket: Ticket,
    ) {
        let copy = Mapped::new(&self.device, bytes.max(4));
        encoder.copy_buffer_to_buffer(self.buffer(src, "read buffer"), offset, copy.buffer(), 0, bytes);
        copy.map_on_submit(encoder);
        let rows = Rows { count: 1, bytes: bytes as u32, padded: bytes as u32 };
        self.reads.insert(ticket, PendingRead { copy, rows });
    }

    pub(crate) fn encode_read_texture(&mut self, encoder: &mut wgpu::CommandEncoder, src: TextureId, ticket: Ticket) {
        let source = self.texture(src, "read texture");
        let size = source.texture.size();
        let texel =
            source.texture.format().block_copy_size(None).unwrap_or_else(|| panic!("{}: not readable", source.label));
        let bytes = size.width * texel;
        let padded = bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let copy = Mapped::new(&self.device, u64::from(padded) * u64::from(size.height));
        encoder.copy_texture_to_buffer(
            source.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: copy.buffer(),
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None },
            },
            wgpu::Extent3d { depth_or_array_layers: 1, ..size },
        );
        copy.map_on_submit(encoder);
        let rows = Rows { count: size.height, bytes, padded };
        self.reads.insert(ticket, PendingRead { copy, rows });
    }

    pub(crate) fn take_read(&mut self, ticket: Ticket) -> Option<Vec<u8>> {
        let pending = self.reads.get(&ticket)?;
        let rows = pending.rows;
        let bytes = pending.copy.bytes(&self.device)?;
        let tight = bytes
            .chunks(rows.padded.max(1) as usize)
            .take(rows.count as usize)
            .flat_map(|row| &row[..rows.bytes as usize])
            .copied()
            .collect();
        drop(bytes);
        self.reads.remove(&ticket);
        Some(tight)
    }

    /// Drops the read-backs of encoders that were thrown away.
    pub(crate) fn forget_lost_reads(&mut self) {
        self.reads.retain(|_, read| !read.copy.is_lost());
    }

    /// Waits for everything that was submitted.
    pub(crate) fn wait(&mut self) -> Result<()> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check_lost()?;
        waited.map(|_| ()).map_err(|error| Error::DeviceLost { reason: error.to_string() })
    }
}
