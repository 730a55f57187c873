//! Where a backend keeps its resources, with their descriptions.

use super::{BufferDesc, Caps, ComputeDesc, Memory, RasterDesc, TextureDesc};
use crate::check;
use crate::error::Result;
use crate::id::{BufferId, PipelineId, Resource, Slots, TextureId};
use crate::pass::PassList;
use crate::shader::{Kernel, RasterPipeline};

/// A resource: what it was described as, whether its memory counts as ours, and what the backend keeps of it.
#[derive(Debug)]
struct Entry<D, V> {
    desc: D,
    is_owned: bool,
    value: V,
}

/// What a pipeline was made from.
#[derive(Debug)]
pub(crate) enum PipelineDesc {
    Compute(ComputeDesc),
    Raster(RasterDesc),
}

/// All resources of a backend with their descriptions: buffers as `B`, textures as `T`, pipelines as `P`.
///
/// It checks lists and descriptions against the rules of the contract, keeps a destroyed resource for as long as a list can
/// name it, and counts memory. So all backends allow and refuse the same things.
#[derive(Debug)]
pub struct Catalog<B, T, P> {
    caps: Caps,
    buffers: Slots<Entry<BufferDesc, B>>,
    textures: Slots<Entry<TextureDesc, T>>,
    pipelines: Slots<Entry<PipelineDesc, P>>,
    memory: Memory,
}

/// A destroyed resource that no list can name any more. The backend frees it once no recorded frame can use it.
#[derive(Debug)]
pub enum Unlisted<B, T, P> {
    /// A buffer: its id, and the backend's object.
    Buffer(BufferId, B),
    /// A texture, as [`Unlisted::Buffer`].
    Texture(TextureId, T),
    /// A pipeline, as [`Unlisted::Buffer`].
    Pipeline(PipelineId, P),
}

impl<B, T, P> Catalog<B, T, P> {
    /// An empty catalog of a device.
    pub fn new(caps: Caps) -> Self {
        Self {
            caps,
            buffers: Slots::default(),
            textures: Slots::default(),
            pipelines: Slots::default(),
            memory: Memory::default(),
        }
    }

    /// What the device can do.
    pub fn caps(&self) -> &Caps {
        &self.caps
    }

    /// Adds a buffer that the backend made. [Check](BufferDesc::check) the description before you make it.
    pub fn add_buffer(&mut self, desc: &BufferDesc, value: B) -> BufferId {
        self.memory.add(desc.bytes);
        self.buffers.insert(Entry { desc: *desc, is_owned: true, value }).into()
    }

    /// Adds a buffer that belongs to an engine; its memory does not count.
    pub fn import_buffer(&mut self, desc: &BufferDesc, value: B) -> BufferId {
        self.buffers.insert(Entry { desc: *desc, is_owned: false, value }).into()
    }

    /// Adds a texture that the backend made. [Check](TextureDesc::check) the description before you make it.
    pub fn add_texture(&mut self, desc: &TextureDesc, value: T) -> TextureId {
        self.memory.add(desc.bytes());
        self.textures.insert(Entry { desc: *desc, is_owned: true, value }).into()
    }

    /// Adds a texture that belongs to an engine; its memory does not count.
    pub fn import_texture(&mut self, desc: &TextureDesc, value: T) -> TextureId {
        self.textures.insert(Entry { desc: *desc, is_owned: false, value }).into()
    }

    /// Adds a compute pipeline. [Check](ComputeDesc::check) the description before you make it.
    pub fn add_compute(&mut self, desc: &ComputeDesc, value: P) -> Kernel {
        let entry = Entry { desc: PipelineDesc::Compute(desc.clone()), is_owned: true, value };
        Kernel { pipeline: self.pipelines.insert(entry).into(), shader: desc.shader.clone() }
    }

    /// Adds a raster pipeline. [Check](RasterDesc::check) the description before you make it.
    pub fn add_raster(&mut self, desc: &RasterDesc, value: P) -> RasterPipeline {
        let entry = Entry { desc: PipelineDesc::Raster(desc.clone()), is_owned: true, value };
        RasterPipeline { pipeline: self.pipelines.insert(entry).into(), shader: desc.shader.clone() }
    }

    /// Marks a resource as destroyed. Says whether it was there.
    pub fn destroy(&mut self, resource: Resource) -> bool {
        let owned = match resource {
            Resource::Buffer(id) => self.buffers.retire(id.0).map(|entry| (entry.is_owned, entry.desc.bytes)),
            Resource::Texture(id) => self.textures.retire(id.0).map(|entry| (entry.is_owned, entry.desc.bytes())),
        };
        if let Some((true, bytes)) = owned {
            self.memory.remove(bytes);
        }
        owned.is_some()
    }

    /// Marks a pipeline as destroyed.
    pub fn destroy_pipeline(&mut self, id: PipelineId) {
        self.pipelines.retire(id.0);
    }

    /// Takes out the destroyed resources that no list can name any more.
    pub fn sweep(&mut self) -> Vec<Unlisted<B, T, P>> {
        let buffers = self.buffers.sweep().into_iter().map(|(slot, entry)| Unlisted::Buffer(slot.into(), entry.value));
        let textures =
            self.textures.sweep().into_iter().map(|(slot, entry)| Unlisted::Texture(slot.into(), entry.value));
        let pipelines =
            self.pipelines.sweep().into_iter().map(|(slot, entry)| Unlisted::Pipeline(slot.into(), entry.value));
        buffers.chain(textures).chain(pipelines).collect()
    }

    /// Holds a list against the rules of the contract.
    ///
    /// # Errors
    /// [`Error::Rule`](crate::Error::Rule) with the first command that breaks one.
    pub fn check(&self, list: &PassList) -> Result<()> {
        check::check(list, self)
    }

    /// What the backend keeps of a buffer.
    ///
    /// # Panics
    /// If there is none. A list that has passed [`Catalog::check`] names only resources that are there.
    pub fn buffer(&self, id: BufferId) -> &B {
        &self.buffers.get(id.0).unwrap_or_else(|| panic!("{id:?} is no buffer of this backend")).value
    }

    /// As [`Catalog::buffer`], for a texture.
    ///
    /// # Panics
    /// As [`Catalog::buffer`].
    pub fn texture(&self, id: TextureId) -> &T {
        &self.textures.get(id.0).unwrap_or_else(|| panic!("{id:?} is no texture of this backend")).value
    }

    /// As [`Catalog::buffer`], for a pipeline.
    ///
    /// # Panics
    /// As [`Catalog::buffer`].
    pub fn pipeline(&self, id: PipelineId) -> &P {
        &self.pipelines.get(id.0).unwrap_or_else(|| panic!("{id:?} is no pipeline of this backend")).value
    }

    /// As [`Catalog::buffer`], to be changed.
    ///
    /// # Panics
    /// As [`Catalog::buffer`].
    pub fn buffer_mut(&mut self, id: BufferId) -> &mut B {
        &mut self.buffers.get_mut(id.0).unwrap_or_else(|| panic!("{id:?} is no buffer of this backend")).value
    }

    /// As [`Catalog::texture`], to be changed.
    ///
    /// # Panics
    /// As [`Catalog::buffer`].
    pub fn texture_mut(&mut self, id: TextureId) -> &mut T {
        &mut self.textures.get_mut(id.0).unwrap_or_else(|| panic!("{id:?} is no texture of this backend")).value
    }

    /// How a buffer was described, if it is there.
    pub fn buffer_desc(&self, id: BufferId) -> Option<&BufferDesc> {
        self.buffers.get(id.0).map(|entry| &entry.desc)
    }

    /// How a texture was described, if it is there.
    pub fn texture_desc(&self, id: TextureId) -> Option<&TextureDesc> {
        self.textures.get(id.0).map(|entry| &entry.desc)
    }

    /// The size of a resource in bytes, whether the backend or an engine owns it; 0 if it is not there.
    pub fn bytes(&self, resource: Resource) -> u64 {
        match resource {
            Resource::Buffer(id) => self.buffer_desc(id).map_or(0, |desc| desc.bytes),
            Resource::Texture(id) => self.texture_desc(id).map_or(0, TextureDesc::bytes),
        }
    }

    /// Whether a resource is there: it was not destroyed, or not swept yet since a list may still name it.
    pub fn has(&self, resource: Resource) -> bool {
        match resource {
            Resource::Buffer(id) => self.buffers.get(id.0).is_some(),
            Resource::Texture(id) => self.textures.get(id.0).is_some(),
        }
    }

    /// Bytes of what is the backend's own and not destroyed.
    pub fn memory(&self) -> Memory {
        self.memory
    }

    /// Takes everything out: for the end of a backend.
    pub fn drain(&mut self) -> (Vec<B>, Vec<T>, Vec<P>) {
        (
            self.buffers.drain().map(|entry| entry.value).collect(),
            self.textures.drain().map(|entry| entry.value).collect(),
            self.pipelines.drain().map(|entry| entry.value).collect(),
        )
    }
}

impl<B, T, P> check::Described for Catalog<B, T, P> {
    fn caps(&self) -> &Caps {
        &self.caps
    }

    fn buffer(&self, id: BufferId, epoch: u64) -> Option<&BufferDesc> {
        self.buffers.get_in(id.0, epoch).map(|entry| &entry.desc)
    }

    fn texture(&self, id: TextureId, epoch: u64) -> Option<&TextureDesc> {
        self.textures.get_in(id.0, epoch).map(|entry| &entry.desc)
    }

    fn compute(&self, id: PipelineId, epoch: u64) -> Option<&ComputeDesc> {
        match &self.pipelines.get_in(id.0, epoch)?.desc {
            PipelineDesc::Compute(desc) => Some(desc),
            PipelineDesc::Raster(_) => None,
        }
    }

    fn raster(&self, id: PipelineId, epoch: u64) -> Option<&RasterDesc> {
        match &self.pipelines.get_in(id.0, epoch)?.desc {
            PipelineDesc::Raster(desc) => Some(desc),
            PipelineDesc::Compute(_) => None,
        }
    }
}
