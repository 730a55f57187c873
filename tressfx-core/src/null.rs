//! A backend that runs nothing and keeps what it was asked: the place to start one's own from.

use std::collections::HashSet;
use std::sync::Arc;

use crate::backend::{
    Backend, BufferDesc, Caps, Catalog, ComputeDesc, Memory, RasterDesc, ReadBack, Record, Run, TextureDesc, Timing,
    Unlisted,
};
use crate::error::{Label, Result};
use crate::hazards::Hazards;
use crate::id::{BufferId, PipelineId, Resource, TextureId};
use crate::pass::{Command, PassList, Ticket};
use crate::shader::{Kernel, RasterPipeline, Shader};

/// Accepts what a device with its caps would accept, runs nothing.
#[derive(Debug)]
pub struct NullBackend {
    catalog: Catalog<(), (), ()>,
    hazards: Hazards,
    /// Tickets of the lists that it was given.
    reads: HashSet<Ticket>,
    /// Labels of all passes that it was given, in order.
    pub ran: Vec<Label>,
    /// The shaders of all pipelines that it was asked for, in order.
    pub shaders: Vec<Arc<Shader>>,
    /// How many commands had to wait for an earlier one.
    pub barriers: usize,
}

impl Default for NullBackend {
    fn default() -> Self {
        Self::new(Caps { adapter: String::from("none"), ..Caps::webgpu_default() })
    }
}

impl NullBackend {
    /// A backend that claims `caps`.
    pub fn new(caps: Caps) -> Self {
        Self {
            catalog: Catalog::new(caps),
            hazards: Hazards::default(),
            reads: HashSet::new(),
            ran: Vec::new(),
            shaders: Vec::new(),
            barriers: 0,
        }
    }

    /// Frees what no list can name any more.
    fn sweep(&mut self) {
        for swept in self.catalog.sweep() {
            match swept {
                Unlisted::Buffer(id, ()) => self.hazards.forget(id.into()),
                Unlisted::Texture(id, ()) => self.hazards.forget(id.into()),
                Unlisted::Pipeline(..) => {}
            }
        }
    }
}

impl Backend for NullBackend {
    fn caps(&self) -> &Caps {
        self.catalog.caps()
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        desc.check(self.caps())?;
        Ok(self.catalog.add_buffer(desc, ()))
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        desc.check(self.caps())?;
        Ok(self.catalog.add_texture(desc, ()))
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        desc.check(self.caps())?;
        self.shaders.push(desc.shader.clone());
        Ok(self.catalog.add_compute(desc, ()))
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        desc.check(self.caps())?;
        self.shaders.push(desc.shader.clone());
        Ok(self.catalog.add_raster(desc, ()))
    }

    fn destroy(&mut self, resource: Resource) {
        self.catalog.destroy(resource);
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.catalog.destroy_pipeline(pipeline);
    }

    /// Nothing ran, so no bytes come back.
    fn read(&mut self, ticket: Ticket) -> ReadBack {
        if self.reads.remove(&ticket) { ReadBack::Failed } else { ReadBack::Unknown }
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

impl Record for NullBackend {
    type Encoder = ();

    fn record(&mut self, _encoder: &mut (), list: &PassList) -> Result<()> {
        self.sweep();
        self.catalog.check(list)?;
        for command in list.commands() {
            self.barriers += usize::from(!self.hazards.waits_before(command).is_empty());
            if let Command::ReadBuffer { ticket, .. } | Command::ReadTexture { ticket, .. } = command {
                self.reads.insert(*ticket);
            }
        }
        self.ran.extend(list.labels());
        Ok(())
    }
}

impl Run for NullBackend {
    fn run(&mut self, list: &PassList) -> Result<()> {
        self.record(&mut (), list)
    }
}
