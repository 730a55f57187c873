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

/// A buffer that is mapped once somebody asks for it.
#[derive(Debug)]
pub(crate) struct Mapped {
    buffer: wgpu::Buffer,
    result: Option<Arc<OnceLock<bool>>>,
}

impl Mapped {
    pub(crate) fn new(device: &wgpu::Device, bytes: u64) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("hair.read_back"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { buffer, result: None }
    }

    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// The bytes if the GPU is done; otherwise asks for them, without waiting. Must not be called before the copy was
    /// submitted.
    pub(crate) fn bytes(&mut self, device: &wgpu::Device) -> Option<wgpu::BufferView> {
        if self.result.is_none() {
            let result = Arc::new(OnceLock::new());
            self.result = Some(result.clone());
            self.buffer.map_async(wgpu::MapMode::Read, .., move |mapped| {
                let _ = result.set(mapped.is_ok());
            });
        }
        let _ = device.poll(wgpu::PollType::Poll);
        let mapped = *self.result.as_ref()?.get()?;
        mapped.then(|| self.buffer.get_mapped_range(..).ok()).flatten()
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
        let rows = Rows { count: size.height, bytes, padded };
        self.reads.insert(ticket, PendingRead { copy, rows });
    }

    pub(crate) fn take_read(&mut self, ticket: Ticket) -> Option<Vec<u8>> {
        let pending = self.reads.get_mut(&ticket)?;
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

    /// Waits for everything that was submitted.
    pub(crate) fn wait(&mut self) -> Result<()> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check_lost()?;
        waited.map(|_| ()).map_err(|error| Error::DeviceLost { reason: error.to_string() })
    }
}
