//! The contract: the traits that a backend implements so that hair runs on a GPU API.

mod caps;
mod catalog;
mod desc;
mod owner;

use std::sync::Arc;

use crate::error::{Label, Result};
use crate::id::{BufferId, PipelineId, Resource, TextureId};
use crate::pass::{PassList, Ticket};
use crate::shader::{Kernel, RasterPipeline};

pub use crate::format::Format;
pub use caps::Caps;
pub use catalog::{Catalog, Unlisted};
pub use desc::{Blend, BufferDesc, BufferUses, ComputeDesc, Depth, DepthOrder, RasterDesc, TextureDesc, TextureUses};
pub use owner::Owner;

/// A GPU. Object safe: the library only ever sees `&mut dyn Backend`, and only while it creates things.
///
/// It can neither submit nor wait. A call that breaks a rule of the contract returns an error and changes nothing.
pub trait Backend {
    /// What the device can do.
    fn caps(&self) -> &Caps;

    /// Makes a buffer, filled with zeros.
    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId>;

    /// Makes a texture with one mip level and one layer, filled with zeros.
    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId>;

    /// Compiles a compute pipeline.
    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel>;

    /// Compiles a raster pipeline.
    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline>;

    /// Destroys a resource. Lists whose first command is written from now on must not name it; older lists still can. It is
    /// freed once none of these older lists exists and no recorded frame can use it. An imported resource is not freed, only
    /// no longer tracked.
    fn destroy(&mut self, resource: Resource);

    /// As [`destroy`](Backend::destroy), for a pipeline.
    fn destroy_pipeline(&mut self, pipeline: PipelineId);

    /// The state of a read-back. The bytes are returned once; later calls give [`ReadBack::Unknown`].
    fn read(&mut self, ticket: Ticket) -> ReadBack;

    /// Cancels a read-back: nobody will ask for its bytes.
    fn cancel_read(&mut self, ticket: Ticket);

    /// The times of the compute and raster passes, in their order, of the newest list that has finished and has passes. They
    /// are returned once. Empty if there are no new ones, or if the device cannot measure time.
    fn timings(&mut self) -> Vec<Timing>;

    /// Bytes of the buffers and textures that this backend made, computed from their descriptions: at present, and the
    /// largest value so far. A destroyed resource no longer counts, even if it is freed later.
    fn memory(&self) -> Memory;
}

/// A backend that writes lists into the encoder of an engine.
pub trait Record: Backend {
    /// The engine's own encoder: `wgpu::CommandEncoder`, a command buffer of Vulkan...
    type Encoder: ?Sized;

    /// Writes the commands of `list` into `encoder`. Never submits, never waits, never keeps the encoder.
    ///
    /// # Errors
    /// [`Error::Rule`](crate::Error::Rule) if a command breaks a rule of the contract; nothing was written then. Otherwise
    /// an error of the device.
    fn record(&mut self, encoder: &mut Self::Encoder, list: &PassList) -> Result<()>;
}

/// A backend that can submit to a queue, for tests and tools; engines use [`Record`].
pub trait Run: Backend {
    /// Records, submits and waits.
    ///
    /// # Errors
    /// As [`Record::record`].
    fn run(&mut self, list: &PassList) -> Result<()>;
}

/// The state of a read-back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReadBack {
    /// The bytes, rows of textures tightly packed.
    Ready(Vec<u8>),
    /// They have not come yet.
    Pending,
    /// They will never come: the list was thrown away, or the device is lost.
    Failed,
    /// No recorded list has this ticket, or its bytes were given already, or it was given up.
    Unknown,
}

impl ReadBack {
    /// The bytes, if they have come.
    pub fn ready(self) -> Option<Vec<u8>> {
        match self {
            Self::Ready(bytes) => Some(bytes),
            _ => None,
        }
    }
}

/// What one pass cost the GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// The pass.
    pub label: Label,
    /// What the pass belongs to, by name: see [`PassList::scope`](crate::pass::PassList::scope).
    pub scope: Option<Arc<str>>,
    /// When it began, in nanoseconds after the first pass of its list.
    pub begin: f64,
    /// How long it took, in nanoseconds.
    pub nanoseconds: f64,
    /// The sum of the sizes of all resources that the pass binds or draws to, each once: the bytes moved if everything is
    /// read or written once.
    pub bytes: u64,
    /// Shader invocations, where the device counts them and was asked to.
    pub invocations: Option<u64>,
}

impl Timing {
    /// A pass that has not been timed yet.
    pub fn new(label: Label, scope: Option<Arc<str>>, bytes: u64) -> Self {
        Self { label, scope, begin: 0.0, nanoseconds: 0.0, bytes, invocations: None }
    }
}

/// Bytes of buffers and textures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// In use now.
    pub bytes: u64,
    /// In use at most so far.
    pub peak: u64,
}

impl Memory {
    /// Counts an allocation.
    pub fn add(&mut self, bytes: u64) {
        self.bytes += bytes;
        self.peak = self.peak.max(self.bytes);
    }

    /// Counts a release.
    pub fn remove(&mut self, bytes: u64) {
        self.bytes = self.bytes.saturating_sub(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_keeps_its_peak() {
        let mut memory = Memory::default();
        memory.add(10);
        memory.remove(4);
        memory.add(3);
        assert_eq!(memory, Memory { bytes: 9, peak: 10 });
    }
}
