//! Bytes that come back from the GPU.

use std::collections::{HashMap, HashSet};

use tressfx_core::backend::{Format, ReadBack};
use tressfx_core::error::Result;
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Command, PassList, Ticket};
use wgpu::{BufferUsages, MapMode, PollType};

use crate::WgpuBackend;
use crate::error::ignoring;
use crate::staging::{self, Mapping, Pool, State};

/// All read-backs that nobody has given up.
#[derive(Debug, Default)]
pub(crate) struct Reads {
    pending: HashMap<Ticket, Pending>,
    /// They will never come.
    failed: HashSet<Ticket>,
    /// Buffers for the next ones.
    free: Pool,
}

/// A read-back that is on its way, in a buffer.
#[derive(Debug)]
struct Pending {
    buffer: wgpu::Buffer,
    rows: Rows,
    state: State,
}

/// Rows of a copy: WebGPU pads them, the caller gets them tight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    count: usize,
    bytes: usize,
    padded: usize,
}

impl Rows {
    fn of_buffer(bytes: u64) -> Self {
        Self { count: 1, bytes: bytes as usize, padded: bytes as usize }
    }

    pub(crate) fn of_texture([width, height]: [u32; 2], format: Format) -> Self {
        let bytes = width as usize * format.bytes() as usize;
        let padded = bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        Self { count: height as usize, bytes, padded }
    }

    /// Bytes of the copy; none is too small for a buffer.
    pub(crate) fn total(self) -> u64 {
        (self.count * self.padded).max(4) as u64
    }

    fn tight(self, bytes: &[u8]) -> Vec<u8> {
        let mut tight = Vec::with_capacity(self.count * self.bytes);
        for row in bytes.chunks(self.padded.max(1)).take(self.count) {
            tight.extend_from_slice(&row[..self.bytes]);
        }
        tight
    }
}

impl WgpuBackend {
    /// Buffers for all that a list reads back, in its order.
    pub(crate) fn prepare_reads(&mut self, list: &PassList) -> Result<Vec<(wgpu::Buffer, Rows)>> {
        let mut prepared = Vec::new();
        for command in list.commands() {
            let rows = match command {
                Command::ReadBuffer { bytes, .. } => Rows::of_buffer(*bytes),
                Command::ReadTexture { src, .. } => match self.catalog.texture_desc(*src) {
                    Some(desc) => Rows::of_texture(desc.size, desc.format),
                    None => continue,
                },
                _ => continue,
            };
            let buffer = match self.reads.free.take(rows.total()) {
                Some(buffer) => buffer,
                None => self.guarded("hair.read_back", rows.total(), |backend| {
                    let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
                    Ok(staging::create(&backend.device, rows.total(), usage, false))
                })?,
            };
            prepared.push((buffer, rows));
        }
        Ok(prepared)
    }

    /// After the copy.
    pub(crate) fn expect_read(
        &mut self,
        encoder: &wgpu::CommandEncoder,
        (buffer, rows): (wgpu::Buffer, Rows),
        ticket: Ticket,
    ) {
        let state = staging::map_on_submit(encoder, &buffer, MapMode::Read, rows.total());
        self.reads.failed.remove(&ticket);
        self.reads.pending.insert(ticket, Pending { buffer, rows, state });
    }

    pub(crate) fn encode_read_texture(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        src: TextureId,
        (buffer, rows): &(wgpu::Buffer, Rows),
    ) {
        let texture = &self.catalog.texture(src).texture;
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(rows.padded as u32), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer, layout },
            wgpu::Extent3d { width: texture.width(), height: texture.height(), depth_or_array_layers: 1 },
        );
    }

    pub(crate) fn take_read(&mut self, ticket: Ticket) -> ReadBack {
        let Some(pending) = self.reads.pending.get(&ticket) else {
            return if self.reads.failed.contains(&ticket) { ReadBack::Failed } else { ReadBack::Unknown };
        };
        if pending.state.get() == Mapping::Waiting && self.loss.poll(&self.device, PollType::Poll).is_err() {
            return self.reads.fail(ticket);
        }
        match pending.state.get() {
            Mapping::Waiting => ReadBack::Pending,
            Mapping::Done => self.bytes_of(ticket),
            Mapping::Failed => {
                self.loss.note();
                self.reads.fail(ticket)
            }
            Mapping::Discarded => self.reads.fail(ticket),
        }
    }

    /// The bytes of a read-back that is mapped.
    fn bytes_of(&mut self, ticket: Ticket) -> ReadBack {
        let Some(Pending { buffer, rows, .. }) = self.reads.pending.remove(&ticket) else { return ReadBack::Unknown };
        let bytes = ignoring(&self.device, || {
            let bytes = buffer.get_mapped_range(..rows.total()).map(|mapped| rows.tight(&mapped));
            buffer.unmap();
            bytes
        });
        match bytes {
            Ok(bytes) => {
                self.reads.free.give(buffer);
                ReadBack::Ready(bytes)
            }
            Err(_) => self.reads.fail(ticket),
        }
    }
}

impl Reads {
    fn fail(&mut self, ticket: Ticket) -> ReadBack {
        self.pending.remove(&ticket);
        self.failed.insert(ticket);
        ReadBack::Failed
    }

    /// How many buffers there are.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.free.count() + self.pending.len()
    }

    pub(crate) fn cancel_read(&mut self, ticket: Ticket) {
        self.pending.remove(&ticket);
        self.failed.remove(&ticket);
    }

    /// Takes the buffers of encoders that were thrown away.
    pub(crate) fn collect_discarded(&mut self) {
        let discarded = self.pending.extract_if(|_, pending| pending.state.get() == Mapping::Discarded);
        for (ticket, Pending { buffer, .. }) in discarded {
            self.failed.insert(ticket);
            self.free.give(buffer);
        }
    }
}
