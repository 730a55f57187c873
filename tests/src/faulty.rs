//! Backends that are wrong in one thing, so that the suite itself can be tested: every fault must fail a case.

use std::collections::HashMap;

use tressfx_core::backend::{
    Backend, Blend, BufferDesc, Caps, ComputeDesc, Depth, DepthOrder, Format, Kernel, Memory, RasterDesc, TextureDesc,
    Timing,
};
use tressfx_core::error::{Label, Result};
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::pass::{Command, ComputePass, Grid, Groups, Load, PassList, RasterPass, Ticket};
use tressfx_core::shader::Bindings;

/// What a backend does wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Nothing.
    None,
    /// All uploads happen before the list.
    UploadsFirst,
    /// All read-backs happen after the list.
    ReadsLast,
    /// A read-back is given as often as it is asked for.
    ReadsAgain,
    /// A clear of a part clears all.
    ClearsAll,
    /// A clear does nothing.
    ClearsNothing,
    /// A copy begins at the start of its source.
    CopiesFromTheStart,
    /// Ids of what was destroyed still work.
    StaleIdsLive,
    /// What is destroyed still counts.
    MemoryNeverFreed,
    /// The caps claim one storage buffer more than there are.
    CapsBoast,
    /// The second pipeline of a label is the first one, whatever it was specialised on.
    CachedByLabel,
    /// Two bindings of one kind are swapped.
    BindingsSwapped,
    /// Every fifth pass is left out.
    PassesDropped,
    /// The grid has one layer.
    GridFlat,
    /// One group runs, whatever the buffer says.
    CountsIgnored,
    /// One instance is drawn, however many are asked for.
    InstancesIgnored,
    /// Pictures are upside down.
    UpsideDown,
    /// Rows of pictures come back padded to 256 bytes.
    RowsPadded,
    /// Red and blue are swapped.
    RedIsBlue,
    /// sRGB is not encoded.
    SrgbLinear,
    /// Layers replace what they should lie over.
    OverReplaces,
    /// Colour targets are swapped.
    TargetsSwapped,
    /// Colours that are to be kept are cleared.
    KeepClears,
    /// Colours that are to be cleared are kept.
    ClearKeeps,
    /// Near is far.
    DepthSwapped,
    /// Depth is tested, and forgotten after each draw.
    DepthForgotten,
    /// Timings come in reverse order.
    TimingsReversed,
}

/// A backend that does what `inner` does, but for one fault.
#[derive(Debug)]
pub struct Faulty<B> {
    inner: B,
    fault: Fault,
    caps: Caps,
    /// Bytes of what lives.
    sizes: HashMap<Resource, u64>,
    textures: HashMap<TextureId, TextureDesc>,
    kernels: HashMap<Label, Kernel>,
    pictures: HashMap<Ticket, TextureDesc>,
    given: HashMap<Ticket, Vec<u8>>,
    passes: usize,
    memory: Memory,
}

impl<B: Backend> Faulty<B> {
    /// Breaks a backend.
    pub fn new(inner: B, fault: Fault) -> Self {
        let mut caps = inner.caps().clone();
        caps.max_storage_buffers_per_stage += u32::from(fault == Fault::CapsBoast);
        Self {
            inner,
            fault,
            caps,
            sizes: HashMap::new(),
            textures: HashMap::new(),
            kernels: HashMap::new(),
            pictures: HashMap::new(),
            given: HashMap::new(),
            passes: 0,
            memory: Memory::default(),
        }
    }

    fn format(&self, format: Format) -> Format {
        match (self.fault, format) {
            (Fault::SrgbLinear, Format::Rgba8Srgb) => Format::Rgba8,
            (Fault::SrgbLinear, Format::Bgra8Srgb) => Format::Bgra8,
            (Fault::RedIsBlue, Format::Rgba8) => Format::Bgra8,
            (Fault::RedIsBlue, Format::Bgra8) => Format::Rgba8,
            (_, format) => format,
        }
    }

    /// The first kernel of the label where the fault is to cache so.
    fn cached(&mut self, made: Kernel) -> Kernel {
        match self.fault {
            Fault::CachedByLabel => self.kernels.entry(made.label()).or_insert(made).clone(),
            _ => made,
        }
    }

    fn spoiled(&mut self, list: &PassList) -> PassList {
        let mut list = list.clone();
        match self.fault {
            Fault::UploadsFirst => list.commands.sort_by_key(|command| !matches!(command, Command::Upload { .. })),
            Fault::ReadsLast => list.commands.sort_by_key(|command| matches!(command, Command::ReadBuffer { .. })),
            _ => {}
        }
        list.commands = list.commands.into_iter().flat_map(|command| self.spoil(command)).collect();
        list
    }

    /// What is done instead of a command.
    fn spoil(&mut self, mut command: Command) -> Vec<Command> {
        match (self.fault, &mut command) {
            (Fault::ClearsAll, Command::Clear { dst, offset, bytes }) => {
                (*offset, *bytes) = (0, self.sizes.get(&(*dst).into()).copied().unwrap_or(*bytes));
            }
            (Fault::ClearsNothing, Command::Clear { .. }) => return Vec::new(),
            (Fault::CopiesFromTheStart, Command::Copy { src_offset, .. }) => *src_offset = 0,
            (Fault::PassesDropped, Command::Compute(_) | Command::Raster(_)) => {
                self.passes += 1;
                return if self.passes.is_multiple_of(5) { Vec::new() } else { vec![command] };
            }
            (_, Command::Compute(pass)) => self.spoil_compute(pass),
            (Fault::DepthForgotten, Command::Raster(pass)) => return forgetful(pass),
            (_, Command::Raster(pass)) => self.spoil_raster(pass),
            (_, Command::ReadTexture { src, ticket }) => {
                self.textures.get(src).map(|desc| self.pictures.insert(*ticket, *desc));
            }
            _ => {}
        }
        vec![command]
    }

    fn spoil_compute(&self, pass: &mut ComputePass) {
        match (self.fault, &mut pass.groups) {
            (Fault::GridFlat, Groups::Grid(Grid(groups))) => groups[2] = 1,
            (Fault::CountsIgnored, groups @ Groups::Indirect { .. }) => *groups = Groups::Grid(Grid([1; 3])),
            (Fault::BindingsSwapped, _) => pass.bindings = swapped(&pass.kernel, &pass.bindings),
            _ => {}
        }
    }

    fn spoil_raster(&self, pass: &mut RasterPass) {
        match self.fault {
            Fault::InstancesIgnored => pass.draws.iter_mut().for_each(|draw| draw.instances = draw.instances.min(1)),
            Fault::KeepClears => pass.colors.iter_mut().for_each(|(_, load)| {
                if *load == Load::Keep {
                    *load = Load::Clear([0.0; 4]);
                }
            }),
            Fault::ClearKeeps => pass.colors.iter_mut().for_each(|(_, load)| *load = Load::Keep),
            Fault::TargetsSwapped => {
                let format = |id: &TextureId| self.textures.get(id).map(|desc| desc.format);
                if pass.colors.len() > 1 && format(&pass.colors[0].0) == format(&pass.colors[1].0) {
                    pass.colors.swap(0, 1);
                }
            }
            _ => {}
        }
    }

    /// What a picture comes back as.
    fn picture(&self, bytes: Vec<u8>, desc: &TextureDesc) -> Vec<u8> {
        let row = (desc.size[0] * desc.format.bytes()) as usize;
        match self.fault {
            Fault::UpsideDown => bytes.chunks(row).rev().flatten().copied().collect(),
            Fault::RowsPadded => {
                let padding = vec![0; row.next_multiple_of(256) - row];
                bytes.chunks(row).flat_map(|row| row.iter().chain(&padding)).copied().collect()
            }
            _ => bytes,
        }
    }
}

/// The bindings with the first two of one kind swapped.
fn swapped(kernel: &Kernel, bindings: &Bindings) -> Bindings {
    let slots = &kernel.shader.slots;
    let mut resources = bindings.resources().to_vec();
    let pairs = (0..slots.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    if let Some((i, j)) = pairs.into_iter().find(|&(i, j)| slots[i].kind == slots[j].kind) {
        resources.swap(i, j);
    }
    let named: Vec<_> = slots.iter().map(|slot| slot.name.as_str()).zip(resources).collect();
    kernel.bind(&named)
}

/// A pass for each draw, which begins with the depth that the whole pass began with.
fn forgetful(pass: &RasterPass) -> Vec<Command> {
    let colors = pass.colors.iter().map(|&(texture, _)| (texture, Load::Keep)).collect();
    let keeping = RasterPass { colors, ..pass.clone() };
    let one = |(i, draw)| RasterPass { draws: vec![draw], ..if i == 0 { pass.clone() } else { keeping.clone() } };
    match pass.draws.len() {
        0 | 1 => vec![Command::Raster(pass.clone())],
        _ => pass.draws.iter().cloned().enumerate().map(one).map(Command::Raster).collect(),
    }
}

impl<B: Backend> Backend for Faulty<B> {
    fn caps(&self) -> &Caps {
        &self.caps
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        let made = self.inner.create_buffer(desc)?;
        self.sizes.insert(made.into(), desc.bytes);
        self.memory.add(desc.bytes);
        Ok(made)
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        let made = self.inner.create_texture(&TextureDesc { format: self.format(desc.format), ..*desc })?;
        self.sizes.insert(made.into(), desc.bytes());
        self.memory.add(desc.bytes());
        self.textures.insert(made, *desc);
        Ok(made)
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        let made = self.inner.create_compute(desc)?;
        Ok(self.cached(made))
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<Kernel> {
        let mut desc = desc.clone();
        for (format, blend) in &mut desc.targets {
            *format = self.format(*format);
            if self.fault == Fault::OverReplaces {
                *blend = Blend::Replace;
            }
        }
        desc.depth = match (self.fault, desc.depth) {
            (Fault::DepthSwapped, Depth::TestWrite(DepthOrder::Standard)) => Depth::TestWrite(DepthOrder::Reverse),
            (Fault::DepthSwapped, Depth::TestWrite(DepthOrder::Reverse)) => Depth::TestWrite(DepthOrder::Standard),
            (_, depth) => depth,
        };
        self.inner.create_raster(&desc)
    }

    fn destroy(&mut self, resource: Resource) {
        let bytes = self.sizes.remove(&resource).unwrap_or(0);
        if self.fault != Fault::MemoryNeverFreed {
            self.memory.remove(bytes);
        }
        if self.fault != Fault::StaleIdsLive {
            self.inner.destroy(resource);
        }
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.kernels.retain(|_, kernel| kernel.pipeline != pipeline);
        if self.fault != Fault::StaleIdsLive {
            self.inner.destroy_pipeline(pipeline);
        }
    }

    fn run(&mut self, list: &PassList) -> Result<()> {
        let list = self.spoiled(list);
        self.inner.run(&list)
    }

    fn read(&mut self, ticket: Ticket) -> Option<Vec<u8>> {
        let Some(bytes) = self.inner.read(ticket) else { return self.given.get(&ticket).cloned() };
        if self.fault == Fault::ReadsAgain {
            self.given.insert(ticket, bytes.clone());
        }
        Some(match self.pictures.remove(&ticket) {
            Some(desc) => self.picture(bytes, &desc),
            None => bytes,
        })
    }

    fn timings(&mut self) -> Vec<Timing> {
        let mut timings = self.inner.timings();
        if self.fault == Fault::TimingsReversed {
            timings.reverse();
        }
        timings
    }

    fn memory(&self) -> Memory {
        self.memory
    }
}
