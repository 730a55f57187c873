//! Buffers on the CPU, and what a list does with them.

use std::collections::HashMap;
use std::ops::Range;

use tressfx_core::backend::{
    Backend, BufferDesc, Caps, ComputeDesc, Kernel, Memory, Need, RasterDesc, Record, TextureDesc, Timing,
};
use tressfx_core::check::check;
use tressfx_core::error::{Error, Result};
use tressfx_core::hazards::accesses;
use tressfx_core::id::{BufferId, PipelineId, Resource, Slots, TextureId};
use tressfx_core::pass::{Command, PassList, Ticket};

/// A backend that moves bytes and runs no kernel.
#[derive(Debug)]
pub(crate) struct CpuBackend {
    caps: Caps,
    buffers: Slots<Vec<u8>>,
    textures: Slots<TextureDesc>,
    reads: HashMap<Ticket, Vec<u8>>,
    memory: Memory,
}

impl CpuBackend {
    /// An empty one.
    pub(crate) fn new() -> Self {
        Self {
            // The caps are the promise: what they say no to is never asked for, by the library nor by the suite.
            caps: Caps {
                adapter: String::from("the CPU, buffers alone"),
                compute: false,
                raster: false,
                read_back: true,
                fragment_writes: false,
                ..Caps::webgpu_default()
            },
            buffers: Slots::default(),
            textures: Slots::default(),
            reads: HashMap::new(),
            memory: Memory::default(),
        }
    }

    fn buffer(&self, id: BufferId, range: Range<u64>, what: &str) -> &[u8] {
        &self.buffers.expect(id.0, what)[range.start as usize..range.end as usize]
    }

    fn buffer_mut(&mut self, id: BufferId, range: Range<u64>, what: &str) -> &mut [u8] {
        // An id that outlived its buffer is a mistake of the program: `expect` says so, by the name of the command.
        self.buffers.expect(id.0, what);
        let bytes = self.buffers.get_mut(id.0).expect("it was just there");
        &mut bytes[range.start as usize..range.end as usize]
    }

    /// All that a command names must be alive, before anything of the list takes effect.
    fn assert_alive(&self, command: &Command) {
        for (resource, _) in accesses(command) {
            match resource {
                Resource::Buffer(BufferId(slot)) => drop(self.buffers.expect(slot, "record")),
                Resource::Texture(TextureId(slot)) => drop(self.textures.expect(slot, "record")),
            }
        }
    }

    fn execute(&mut self, command: &Command, bytes: &[u8]) -> Result<()> {
        match command {
            Command::Upload { dst, offset, data } => {
                let data = &bytes[data.clone()];
                self.buffer_mut(*dst, *offset..*offset + data.len() as u64, "upload").copy_from_slice(data);
            }
            Command::Clear { dst, offset, bytes } => {
                self.buffer_mut(*dst, *offset..*offset + *bytes, "clear").fill(0);
            }
            Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                let data = self.buffer(*src, *src_offset..*src_offset + *bytes, "copy").to_vec();
                self.buffer_mut(*dst, *dst_offset..*dst_offset + *bytes, "copy").copy_from_slice(&data);
            }
            Command::ReadBuffer { src, offset, bytes, ticket } => {
                let data = self.buffer(*src, *offset..*offset + *bytes, "read buffer").to_vec();
                self.reads.insert(*ticket, data);
            }
            // Nobody can have drawn to it, so it still begins as zeros.
            Command::ReadTexture { src, ticket } => {
                let bytes = self.textures.expect(src.0, "read texture").bytes();
                self.reads.insert(*ticket, vec![0; bytes as usize]);
            }
            Command::Compute(pass) => self.caps.check(pass.kernel.label(), &[Need::Compute])?,
            Command::Raster(pass) => self.caps.check(pass.label, &[Need::Raster])?,
        }
        Ok(())
    }
}

impl Backend for CpuBackend {
    fn caps(&self) -> &Caps {
        &self.caps
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        self.caps.check(desc.label, &[Need::StorageBindingBytes(desc.bytes)])?;
        let mut bytes = Vec::new();
        let out_of_memory = |_| Error::OutOfMemory { label: desc.label, bytes: desc.bytes };
        bytes.try_reserve_exact(desc.bytes as usize).map_err(out_of_memory)?;
        bytes.resize(desc.bytes as usize, 0);
        self.memory.add(desc.bytes);
        Ok(self.buffers.insert(bytes).into())
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        self.caps.check(desc.label, &[Need::TextureEdge(desc.size[0].max(desc.size[1]))])?;
        self.memory.add(desc.bytes());
        Ok(self.textures.insert(*desc).into())
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        self.caps.check(desc.shader.label, &[Need::Compute])?;
        unreachable!("the caps say no")
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<Kernel> {
        self.caps.check(desc.shader.label, &[Need::Raster])?;
        unreachable!("the caps say no")
    }

    fn destroy(&mut self, resource: Resource) {
        // Nothing is in flight: a CPU has finished when `run` returns.
        let bytes = match resource {
            Resource::Buffer(BufferId(slot)) => self.buffers.remove(slot).map(|bytes| bytes.len() as u64),
            Resource::Texture(TextureId(slot)) => self.textures.remove(slot).map(|desc| desc.bytes()),
        };
        self.memory.remove(bytes.unwrap_or(0));
    }

    fn destroy_pipeline(&mut self, _pipeline: PipelineId) {}

    fn run(&mut self, list: &PassList) -> Result<()> {
        self.record(&mut (), list)
    }

    fn read(&mut self, ticket: Ticket) -> Option<Vec<u8>> {
        self.reads.remove(&ticket)
    }

    fn timings(&mut self) -> Vec<Timing> {
        Vec::new()
    }

    fn memory(&self) -> Memory {
        self.memory
    }
}

impl Record for CpuBackend {
    type Encoder = ();

    fn record(&mut self, _encoder: &mut (), list: &PassList) -> Result<()> {
        // The rules of a list are checked by core, so that no backend has to.
        check(list);
        list.commands.iter().for_each(|command| self.assert_alive(command));
        list.commands.iter().try_for_each(|command| self.execute(command, &list.bytes))
    }
}
