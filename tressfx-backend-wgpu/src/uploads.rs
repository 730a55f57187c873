//! Uploads: a belt of buffers that the CPU fills and that come back once the GPU has read them.
//!
//! Uploads take effect in the order of the list, so they are copies in the encoder and not writes of the queue.

use std::ops::Range;

use tressfx_core::error::{Error, Result};
use wgpu::{BufferUsages, MapMode};

use crate::WgpuBackend;
use crate::staging::{self, Mapping, Pool, State};

/// Bytes of a list that go into one buffer.
const BLOCK: usize = 64 << 20;

/// All buffers of uploads.
#[derive(Debug, Default)]
pub(crate) struct Belt {
    /// Mapped: ready to be filled.
    free: Pool,
    /// Named by encoders, or on their way back.
    out: Vec<(wgpu::Buffer, State)>,
}

/// The bytes of a list, in buffers.
#[derive(Debug)]
pub(crate) struct Uploads {
    block: usize,
    buffers: Vec<wgpu::Buffer>,
}

impl Belt {
    /// Takes buffers back that the GPU has read.
    fn collect(&mut self) {
        for (buffer, state) in std::mem::take(&mut self.out) {
            match state.get() {
                Mapping::Waiting => self.out.push((buffer, state)),
                Mapping::Done => self.free.give(buffer),
                Mapping::Failed => {}
                Mapping::Discarded => {
                    let state = staging::map_now(&buffer, MapMode::Write);
                    self.out.push((buffer, state));
                }
            }
        }
    }

    /// How many there are.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.free.count() + self.out.len()
    }

    /// After the last command of `encoder` that reads them.
    pub(crate) fn give_back(&mut self, encoder: &wgpu::CommandEncoder, uploads: Uploads) {
        for buffer in uploads.buffers {
            let state = staging::map_on_submit(encoder, &buffer, MapMode::Write, buffer.size());
            self.out.push((buffer, state));
        }
    }
}

impl WgpuBackend {
    /// Puts the bytes of a list into buffers.
    pub(crate) fn fill_uploads(&mut self, bytes: &[u8]) -> Result<Uploads> {
        let most = usize::try_from(self.catalog.caps().max_buffer_bytes).unwrap_or(usize::MAX);
        let block = BLOCK.min(most / 4 * 4).max(4);
        let mut uploads = Uploads { block, buffers: Vec::new() };
        if bytes.is_empty() {
            return Ok(uploads);
        }
        self.uploads.collect();
        for block in bytes.chunks(block) {
            let size = block.len().next_multiple_of(4);
            let buffer = match self.uploads.free.take(size as u64) {
                Some(buffer) => buffer,
                None => self.guarded("hair.uploads", size as u64, |backend| {
                    let usage = BufferUsages::MAP_WRITE | BufferUsages::COPY_SRC;
                    Ok(staging::create(&backend.device, size as u64, usage, true))
                })?,
            };
            let mut mapped = buffer
                .get_mapped_range_mut(..size as u64)
                .map_err(|error| Error::Backend { label: "hair.uploads", message: error.to_string() })?;
            mapped.slice(..block.len()).copy_from_slice(block);
            drop(mapped);
            buffer.unmap();
            uploads.buffers.push(buffer);
        }
        Ok(uploads)
    }
}

impl Uploads {
    /// Copies a part of the list's bytes, which may lie in several buffers.
    pub(crate) fn copy(&self, encoder: &mut wgpu::CommandEncoder, data: &Range<usize>, to: &wgpu::Buffer, offset: u64) {
        let mut start = data.start;
        while start < data.end {
            let (index, within) = (start / self.block, start % self.block);
            let end = data.end.min((index + 1) * self.block);
            let target = offset + (start - data.start) as u64;
            encoder.copy_buffer_to_buffer(&self.buffers[index], within as u64, to, target, (end - start) as u64);
            start = end;
        }
    }
}
