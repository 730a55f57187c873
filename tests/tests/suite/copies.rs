//! A backend on the CPU that runs no passes: it uploads, clears, copies and reads back.

use std::collections::HashMap;
use std::ops::Range;

use tressfx_core::backend::{
    Backend, BufferDesc, Caps, Catalog, ComputeDesc, Memory, RasterDesc, ReadBack, Run, TextureDesc, Timing,
};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::pass::{Command, PassList, Ticket};
use tressfx_core::shader::{Kernel, RasterPipeline};

/// Ids, rules and refusals are core's; buffers and textures are bytes.
pub(crate) struct Copies {
    catalog: Catalog<Vec<u8>, Vec<u8>, ()>,
    reads: HashMap<Ticket, Vec<u8>>,
}

impl Copies {
    pub(crate) fn new() -> Self {
        let mut caps = Caps::webgpu_default();
        (caps.compute, caps.raster, caps.fragment_writes) = (false, false, false);
        Self { catalog: Catalog::new(caps), reads: HashMap::new() }
    }

    fn part(&self, buffer: BufferId, offset: u64, bytes: u64) -> Vec<u8> {
        self.catalog.buffer(buffer)[range(offset, bytes)].to_vec()
    }

    fn write(&mut self, buffer: BufferId, offset: u64, data: &[u8]) {
        self.catalog.buffer_mut(buffer)[range(offset, data.len() as u64)].copy_from_slice(data);
    }

    fn copy_to_texture(&mut self, src: BufferId, offset: u64, row_bytes: u32, dst: TextureId) {
        let desc = *self.catalog.texture_desc(dst).expect("the list was checked");
        let row = u64::from(desc.size[0] * desc.format.bytes());
        let start = |y: u32| offset + u64::from(y) * u64::from(row_bytes);
        let rows = (0..desc.size[1]).flat_map(|y| self.part(src, start(y), row));
        *self.catalog.texture_mut(dst) = rows.collect();
    }
}

fn range(offset: u64, bytes: u64) -> Range<usize> {
    offset as usize..(offset + bytes) as usize
}

impl Backend for Copies {
    fn caps(&self) -> &Caps {
        self.catalog.caps()
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        desc.check(self.caps())?;
        Ok(self.catalog.add_buffer(desc, vec![0; desc.bytes as usize]))
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        desc.check(self.caps())?;
        Ok(self.catalog.add_texture(desc, vec![0; desc.bytes() as usize]))
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        desc.check(self.caps())?;
        unreachable!("the caps have no compute passes")
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        desc.check(self.caps())?;
        unreachable!("the caps have no raster passes")
    }

    fn destroy(&mut self, resource: Resource) {
        self.catalog.destroy(resource);
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.catalog.destroy_pipeline(pipeline);
    }

    fn read(&mut self, ticket: Ticket) -> ReadBack {
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

impl Run for Copies {
    fn run(&mut self, list: &PassList) -> Result<()> {
        drop(self.catalog.sweep());
        self.catalog.check(list)?;
        for command in list.commands() {
            match command {
                Command::Upload { dst, offset, data } => self.write(*dst, *offset, &list.bytes()[data.clone()]),
                Command::Clear { dst, offset, bytes } => self.write(*dst, *offset, &vec![0; *bytes as usize]),
                Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                    let data = self.part(*src, *src_offset, *bytes);
                    self.write(*dst, *dst_offset, &data);
                }
                Command::CopyToTexture { src, offset, row_bytes, dst } => {
                    self.copy_to_texture(*src, *offset, *row_bytes, *dst);
                }
                Command::ReadBuffer { src, offset, bytes, ticket } => {
                    let data = self.part(*src, *offset, *bytes);
                    self.reads.insert(*ticket, data);
                }
                Command::ReadTexture { src, ticket } => {
                    self.reads.insert(*ticket, self.catalog.texture(*src).clone());
                }
                other => unreachable!("{other:?}: the caps have no passes"),
            }
        }
        Ok(())
    }
}
