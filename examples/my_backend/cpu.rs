//! Buffers and textures on the CPU, and what a list does with them.

use std::collections::HashMap;

use tressfx_core::backend::{
    Backend, BufferDesc, Caps, Catalog, ComputeDesc, Memory, RasterDesc, ReadBack, Record, Run, TextureDesc, Timing,
};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::pass::{Command, PassList, Ticket};
use tressfx_core::shader::{Kernel, RasterPipeline};

/// A backend that moves bytes and runs no kernel.
#[derive(Debug)]
pub(crate) struct CpuBackend {
    /// Descriptions, ids, rules and the count of memory are core's; the backend keeps its own things beside them. There are no
    /// pipelines, so nothing is kept of them.
    catalog: Catalog<Vec<u8>, Vec<u8>, ()>,
    reads: HashMap<Ticket, Vec<u8>>,
}

impl CpuBackend {
    /// An empty one.
    pub(crate) fn new() -> Self {
        // The caps are the promise: what they say no to is refused by core, and never asked for by the library or the suite.
        let mut caps = Caps::webgpu_default();
        caps.adapter = String::from("the CPU, without passes");
        (caps.compute, caps.raster, caps.fragment_writes) = (false, false, false);
        Self { catalog: Catalog::new(caps), reads: HashMap::new() }
    }

    fn part(&self, id: BufferId, offset: u64, bytes: u64) -> &[u8] {
        &self.catalog.buffer(id)[offset as usize..(offset + bytes) as usize]
    }

    fn part_mut(&mut self, id: BufferId, offset: u64, bytes: u64) -> &mut [u8] {
        &mut self.catalog.buffer_mut(id)[offset as usize..(offset + bytes) as usize]
    }

    /// Rows of a buffer, `row_bytes` apart, become a texture.
    fn copy_to_texture(&mut self, src: BufferId, offset: u64, row_bytes: u32, dst: TextureId) {
        let width = self.catalog.texture_desc(dst).map_or(0, |desc| desc.size[0] * desc.format.bytes());
        let rows = self.catalog.buffer(src)[offset as usize..].chunks(row_bytes as usize);
        let height = self.catalog.texture(dst).len() / width as usize;
        let texels = rows.take(height).flat_map(|row| &row[..width as usize]).copied().collect();
        *self.catalog.texture_mut(dst) = texels;
    }

    /// A command that was checked: what it names is there, and its ranges lie within.
    fn execute(&mut self, command: &Command, uploads: &[u8]) -> Result<()> {
        match command {
            Command::Upload { dst, offset, data } => {
                self.part_mut(*dst, *offset, data.len() as u64).copy_from_slice(&uploads[data.clone()]);
            }
            Command::Clear { dst, offset, bytes } => self.part_mut(*dst, *offset, *bytes).fill(0),
            Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                let data = self.part(*src, *src_offset, *bytes).to_vec();
                self.part_mut(*dst, *dst_offset, *bytes).copy_from_slice(&data);
            }
            Command::CopyToTexture { src, offset, row_bytes, dst } => {
                self.copy_to_texture(*src, *offset, *row_bytes, *dst);
            }
            Command::ReadBuffer { src, offset, bytes, ticket } => {
                let data = self.part(*src, *offset, *bytes).to_vec();
                self.reads.insert(*ticket, data);
            }
            Command::ReadTexture { src, ticket } => {
                let data = self.catalog.texture(*src).clone();
                self.reads.insert(*ticket, data);
            }
            // Passes name pipelines, and there are none. The contract may grow by commands that are not known here.
            other => return Err(Error::rule(other.name(), "this backend does not know the command")),
        }
        Ok(())
    }
}

/// So many zeros, if there is memory for them.
fn zeros(label: Label, bytes: u64) -> Result<Vec<u8>> {
    let mut zeros = Vec::new();
    zeros.try_reserve_exact(bytes as usize).map_err(|_| Error::OutOfMemory { label, bytes })?;
    zeros.resize(bytes as usize, 0);
    Ok(zeros)
}

impl Backend for CpuBackend {
    fn caps(&self) -> &Caps {
        self.catalog.caps()
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        desc.check(self.caps())?;
        Ok(self.catalog.add_buffer(desc, zeros(desc.label, desc.bytes)?))
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        desc.check(self.caps())?;
        Ok(self.catalog.add_texture(desc, zeros(desc.label, desc.bytes())?))
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        // Here a kernel would be compiled. The caps have no compute passes, so core refuses every one.
        desc.check(self.caps())?;
        Ok(self.catalog.add_compute(desc, ()))
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        desc.check(self.caps())?;
        Ok(self.catalog.add_raster(desc, ()))
    }

    fn destroy(&mut self, resource: Resource) {
        // Lists that were begun before may still name it: it is freed by a later sweep.
        self.catalog.destroy(resource);
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.catalog.destroy_pipeline(pipeline);
    }

    fn read(&mut self, ticket: Ticket) -> ReadBack {
        // Nothing is ever pending: a CPU has finished when `run` returns.
        self.reads.remove(&ticket).map_or(ReadBack::Unknown, ReadBack::Ready)
    }

    fn cancel_read(&mut self, ticket: Ticket) {
        self.reads.remove(&ticket);
    }

    fn timings(&mut self) -> Vec<Timing> {
        Vec::new()
    }

    fn memory(&self) -> Memory {
        self.catalog.memory()
    }
}

impl Record for CpuBackend {
    type Encoder = ();

    fn record(&mut self, _encoder: &mut (), list: &PassList) -> Result<()> {
        // What no list can name any more goes; a graphics API would have to wait for frames in flight as well.
        drop(self.catalog.sweep());
        // All rules are held by core before the first command takes effect. After it, look-ups cannot fail.
        self.catalog.check(list)?;
        list.commands().iter().try_for_each(|command| self.execute(command, list.bytes()))
    }
}

impl Run for CpuBackend {
    fn run(&mut self, list: &PassList) -> Result<()> {
        self.record(&mut (), list)
    }
}
