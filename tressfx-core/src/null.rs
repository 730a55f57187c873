//! A backend that runs nothing and remembers what it was asked: the place to start one's own from.

use std::sync::Arc;

use crate::backend::{
    Backend, BufferDesc, Caps, ComputeDesc, Kernel, Memory, Need, RasterDesc, Record, TextureDesc, Timing,
};
use crate::check::check;
use crate::error::{Label, Result};
use crate::hazards::Hazards;
use crate::id::{BufferId, PipelineId, Resource, Slots, TextureId};
use crate::pass::{Command, PassList, Ticket};
use crate::shader::{Shader, ShaderStage, SlotKind, Stages};

/// Accepts what a device with its caps would accept, runs nothing.
#[derive(Debug)]
pub struct NullBackend {
    caps: Caps,
    buffers: Slots<BufferDesc>,
    textures: Slots<TextureDesc>,
    pipelines: Slots<Label>,
    hazards: Hazards,
    memory: Memory,
    /// Labels of all passes that it was given, in order.
    pub ran: Vec<Label>,
    /// The shaders of all pipelines that it was asked for, in order.
    pub shaders: Vec<Arc<Shader>>,
    /// How many commands had to wait for an earlier one.
    pub barriers: usize,
}

impl Default for NullBackend {
    fn default() -> Self {
        Self::new(Caps { adapter: String::from("none"), read_back: false, ..Caps::webgpu_default() })
    }
}

impl NullBackend {
    /// A backend that claims `caps`.
    pub fn new(caps: Caps) -> Self {
        Self {
            caps,
            buffers: Slots::default(),
            textures: Slots::default(),
            pipelines: Slots::default(),
            hazards: Hazards::default(),
            memory: Memory::default(),
            ran: Vec::new(),
            shaders: Vec::new(),
            barriers: 0,
        }
    }

    fn kernel(&mut self, shader: &Arc<Shader>) -> Kernel {
        self.shaders.push(shader.clone());
        Kernel { pipeline: self.pipelines.insert(shader.label).into(), shader: shader.clone() }
    }

    fn assert_alive(&self, command: &Command) {
        for (resource, _) in crate::hazards::accesses(command) {
            match resource {
                Resource::Buffer(BufferId(slot)) => drop(self.buffers.expect(slot, "record")),
                Resource::Texture(TextureId(slot)) => drop(self.textures.expect(slot, "record")),
            }
        }
        let kernels: Vec<&Kernel> = match command {
            Command::Compute(pass) => vec![&pass.kernel],
            Command::Raster(pass) => pass.draws.iter().map(|draw| &draw.kernel).collect(),
            _ => Vec::new(),
        };
        for kernel in kernels {
            self.pipelines.expect(kernel.pipeline.0, kernel.label());
        }
    }
}

impl Backend for NullBackend {
    fn caps(&self) -> &Caps {
        &self.caps
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        self.caps.check(desc.label, &[Need::StorageBindingBytes(desc.bytes)])?;
        self.memory.add(desc.bytes);
        Ok(self.buffers.insert(*desc).into())
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        self.caps.check(desc.label, &[Need::TextureEdge(desc.size[0].max(desc.size[1]))])?;
        self.memory.add(desc.bytes());
        Ok(self.textures.insert(*desc).into())
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        desc.shader.entry_point(ShaderStage::Compute)?;
        let needs = [Need::Compute, Need::StorageBuffers(desc.shader.storage_buffers())];
        self.caps.check(desc.shader.label, &needs)?;
        Ok(self.kernel(&desc.shader))
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<Kernel> {
        desc.shader.entry_point(ShaderStage::Vertex)?;
        desc.shader.entry_point(ShaderStage::Fragment)?;
        self.caps.check(desc.shader.label, &[Need::Raster, Need::StorageBuffers(desc.shader.storage_buffers())])?;
        if desc.shader.slots.iter().any(|slot| slot.kind == SlotKind::ReadWrite && slot.stages.has(Stages::FRAGMENT)) {
            self.caps.check(desc.shader.label, &[Need::FragmentWrites])?;
        }
        Ok(self.kernel(&desc.shader))
    }

    fn destroy(&mut self, resource: Resource) {
        self.hazards.forget(resource);
        let bytes = match resource {
            Resource::Buffer(BufferId(slot)) => self.buffers.remove(slot).map(|desc| desc.bytes),
            Resource::Texture(TextureId(slot)) => self.textures.remove(slot).map(|desc| desc.bytes()),
        };
        self.memory.remove(bytes.unwrap_or(0));
    }

    fn destroy_pipeline(&mut self, PipelineId(slot): PipelineId) {
        self.pipelines.remove(slot);
    }

    fn run(&mut self, list: &PassList) -> Result<()> {
        self.record(&mut (), list)
    }

    fn read(&mut self, _ticket: Ticket) -> Option<Vec<u8>> {
        None
    }

    fn timings(&mut self) -> Vec<Timing> {
        Vec::new()
    }

    fn memory(&self) -> Memory {
        self.memory
    }
}

impl Record for NullBackend {
    type Encoder = ();

    fn record(&mut self, _encoder: &mut (), list: &PassList) -> Result<()> {
        check(list);
        for command in &list.commands {
            self.assert_alive(command);
            self.barriers += usize::from(!self.hazards.before(command).is_empty());
        }
        self.ran.extend(list.labels());
        Ok(())
    }
}
