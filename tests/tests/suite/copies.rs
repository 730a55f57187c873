//! A backend on the CPU that runs no passes: it uploads, clears, copies and reads back.

use std::collections::HashMap;
use std::ops::Range;

use tressfx_core::backend::{Backend, BufferDesc, Caps, ComputeDesc, Kernel, Memory, RasterDesc, TextureDesc, Timing};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{Command, PassList, Ticket};

/// Ids, rules and refusals are those of the backend that runs nothing.
pub(crate) struct Copies {
    null: NullBackend,
    buffers: HashMap<BufferId, Vec<u8>>,
    reads: HashMap<Ticket, Vec<u8>>,
}

impl Copies {
    pub(crate) fn new() -> Self {
        let caps = Caps { compute: false, raster: false, fragment_writes: false, ..Caps::webgpu_default() };
        Self { null: NullBackend::new(caps), buffers: HashMap::new(), reads: HashMap::new() }
    }

    fn part(&self, buffer: BufferId, offset: u64, bytes: u64) -> Vec<u8> {
        self.buffers[&buffer][range(offset, bytes)].to_vec()
    }

    fn write(&mut self, buffer: BufferId, offset: u64, data: &[u8]) {
        let buffer = self.buffers.get_mut(&buffer).expect("it is alive");
        buffer[range(offset, data.len() as u64)].copy_from_slice(data);
    }
}

fn range(offset: u64, bytes: u64) -> Range<usize> {
    offset as usize..(offset + bytes) as usize
}

impl Backend for Copies {
    fn caps(&self) -> &Caps {
        self.null.caps()
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        let made = self.null.create_buffer(desc)?;
        self.buffers.insert(made, vec![0; desc.bytes as usize]);
        Ok(made)
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        self.null.create_texture(desc)
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        self.null.create_compute(desc)
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<Kernel> {
        self.null.create_raster(desc)
    }

    fn destroy(&mut self, resource: Resource) {
        self.null.destroy(resource);
        if let Resource::Buffer(id) = resource {
            self.buffers.remove(&id);
        }
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.null.destroy_pipeline(pipeline);
    }

    fn run(&mut self, list: &PassList) -> Result<()> {
        self.null.run(list)?;
        for command in &list.commands {
            match command {
                Command::Upload { dst, offset, data } => self.write(*dst, *offset, &list.bytes[data.clone()]),
                Command::Clear { dst, offset, bytes } => self.write(*dst, *offset, &vec![0; *bytes as usize]),
                Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                    let data = self.part(*src, *src_offset, *bytes);
                    self.write(*dst, *dst_offset, &data);
                }
                Command::ReadBuffer { src, offset, bytes, ticket } => {
                    let data = self.part(*src, *offset, *bytes);
                    self.reads.insert(*ticket, data);
                }
                other => panic!("{other:?}: the caps have no passes"),
            }
        }
        Ok(())
    }

    fn read(&mut self, ticket: Ticket) -> Option<Vec<u8>> {
        self.reads.remove(&ticket)
    }

    fn timings(&mut self) -> Vec<Timing> {
        Vec::new()
    }

    fn memory(&self) -> Memory {
        self.null.memory()
    }
}
