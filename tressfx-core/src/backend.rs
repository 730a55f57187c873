//! The contract: what an engine implements so that hair runs on its GPU API.

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
pub use catalog::{Catalog, Swept};
pub use desc::{Blend, BufferDesc, BufferUses, ComputeDesc, Depth, DepthOrder, RasterDesc, TextureDesc, TextureUses};
pub use owner::Owner;

/// A GPU. Object safe: the library only ever sees `&mut dyn Backend`, and only while it creates things.
///
/// It can neither submit nor wait. What breaks a rule of the contract is answered with an error, and does nothing.
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

    /// Gives a resource back. Lists that are begun from now on must not name it; those that were begun before still can. It
    /// is freed once none of them exists any more and no recorded frame can use it. An imported one is only forgotten.
    fn destroy(&mut self, resource: Resource);

    /// As [`destroy`](Backend::destroy), for a pipeline.
    fn destroy_pipeline(&mut self, pipeline: PipelineId);

    /// What has become of a read-back. Its bytes are given once.
    fn read(&mut self, ticket: Ticket) -> ReadBack;

    /// Gives a read-back up: nobody will ask for its bytes.
    fn give_up(&mut self, ticket: Ticket);

    /// Cost of each compute and raster pass of the newest finished list that has any, in its order. They are given once; empty
    /// where there are none yet, or the device cannot time.
    fn timings(&mut self) -> Vec<Timing>;

    /// Bytes of buffers and textures that this backend made, as their descriptions say: now, and at most so far. What is
    /// destroyed no longer counts, even if it is freed later.
    fn memory(&self) -> Memory;
}

/// How an application puts a list into the encoder that it already has.
pub trait Record: Backend {
    /// The engine's own encoder: `wgpu::CommandEncoder`, a command buffer of Vulkan...
    type Encoder: ?Sized;

    /// Writes the commands of `list` into `encoder`. Never submits, never waits, never keeps the encoder.
    ///
    /// # Errors
    /// [`Error::Rule`](crate::Error::Rule) if a command breaks a rule of the contract: nothing was written then. Else what
    /// the device says.
    fn record(&mut self, encoder: &mut Self::Encoder, list: &PassList) -> Result<()>;
}

/// A backend that has a queue of its own, for tests and tools; engines use [`Record`].
pub trait Run: Backend {
    /// Records, submits and waits.
    ///
    /// # Errors
    /// As [`Record::record`].
    fn run(&mut self, list: &PassList) -> Result<()>;
}

/// What has become of a read-back.
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
    /// Whose pass it is: see [`PassList::scope`](crate::pass::PassList::scope).
    pub scope: Option<Arc<str>>,
    /// When it began, in nanoseconds after the first pass of its list.
    pub begin: f64,
    /// Its time.
    pub nanoseconds: f64,
    /// Bytes of all that is bound or drawn to, each resource once: the most that one reading of everything can cost.
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
