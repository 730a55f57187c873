//! Backends that are wrong in one thing, so that the suite itself can be tested: every fault must fail a case.

mod spoil;

use std::collections::{HashMap, HashSet};

use tressfx_core::backend::{
    Backend, Blend, BufferDesc, Caps, ComputeDesc, Depth, DepthOrder, Format, Memory, RasterDesc, ReadBack, Run,
    TextureDesc, Timing,
};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::hazards::accesses;
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shader::{Kernel, RasterPipeline};

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
    /// What is destroyed is gone for lists that were begun before, too.
    DestroyedAtOnce,
    /// EngineCommands that name resources of another backend are left out.
    ForeignIdsIgnored,
    /// Lists that break a rule are left out.
    RulesIgnored,
    /// What comes before a command that breaks a rule is run.
    RulesLate,
    /// What was given up can be read.
    GivenUpIsRead,
    /// Nothing is unknown: it is still to come.
    NothingUnknown,
    /// What is destroyed still counts.
    MemoryNeverFreed,
    /// The caps claim one storage buffer more than there are.
    CapsBoast,
    /// The caps claim one storage texture more than there are.
    CapsBoastTextures,
    /// The caps claim twice the threads of a group.
    CapsBoastThreads,
    /// The caps claim twice the memory of a group.
    CapsBoastMemory,
    /// The caps claim uniform bindings of twice the size.
    CapsBoastUniforms,
    /// The caps claim bindings at any offset.
    CapsBoastAlignment,
    /// The caps claim one colour target more than there are.
    CapsBoastTargets,
    /// The caps deny compute passes, which the device runs.
    CapsDeny,
    /// The second pipeline of a label is the first one, whatever it was specialised on.
    CachedByLabel,
    /// Two bindings of one kind are swapped.
    BindingsSwapped,
    /// Ranges that are bound begin at the start of their buffer.
    RangesFromTheStart,
    /// Of ranges that are bound, the whole rest of the buffer is.
    RangesToTheEnd,
    /// Linear is nearest, and nearest is linear.
    SamplersSwapped,
    /// Every fifth pass is left out.
    PassesDropped,
    /// The grid has one layer.
    GridFlat,
    /// One group runs, whatever the buffer says.
    CountsIgnored,
    /// One instance is drawn, however many are asked for.
    InstancesIgnored,
    /// One triangle is drawn, whatever the buffer says.
    DrawCountsIgnored,
    /// Draws cover the whole target, whatever the viewport says.
    ViewportIgnored,
    /// Pipelines without a fragment stage draw nothing.
    FragmentlessDropped,
    /// Copies to textures begin at the start of the buffer.
    RowsFromTheStart,
    /// Copies to textures do nothing.
    RowsNotCopied,
    /// What compute passes write into textures is lost.
    StorageWritesLost,
    /// Pictures are upside down.
    UpsideDown,
    /// Rows of pictures come back padded to 256 bytes.
    RowsPadded,
    /// Red and blue are swapped.
    RedIsBlue,
    /// sRGB is not encoded.
    SrgbLinear,
    /// Ten bits are eight.
    TenBitsAreEight,
    /// Integers are cleared to zero, whatever is asked for.
    IntegersClearToZero,
    /// Layers replace what they should lie over.
    OverReplaces,
    /// What should be added is multiplied, and the other way round.
    SumsAreProducts,
    /// The smaller is the larger, and the other way round.
    MinIsMax,
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
    /// Depth that should be tested alone is written.
    DepthTestWrites,
    /// Timings come in reverse order.
    TimingsReversed,
    /// Passes take no time.
    TimingsZero,
    /// Timings do not say whose pass it was.
    ScopesForgotten,
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
    given_up: HashSet<Ticket>,
    destroyed: HashSet<Resource>,
    passes: usize,
    memory: Memory,
}

impl<B: Backend> Faulty<B> {
    /// Breaks a backend.
    pub fn new(inner: B, fault: Fault) -> Self {
        let caps = boast(inner.caps().clone(), fault);
        Self {
            inner,
            fault,
            caps,
            sizes: HashMap::new(),
            textures: HashMap::new(),
            kernels: HashMap::new(),
            pictures: HashMap::new(),
            given: HashMap::new(),
            given_up: HashSet::new(),
            destroyed: HashSet::new(),
            passes: 0,
            memory: Memory::default(),
        }
    }

    /// A backend without a fault that claims other caps.
    pub fn claiming(inner: B, caps: Caps) -> Self {
        Self { caps, ..Self::new(inner, Fault::None) }
    }

    fn format(&self, format: Format) -> Format {
        match (self.fault, format) {
            (Fault::SrgbLinear, Format::Rgba8Srgb) => Format::Rgba8,
            (Fault::SrgbLinear, Format::Bgra8Srgb) => Format::Bgra8,
            (Fault::TenBitsAreEight, Format::Rgb10A2) => Format::Rgba8,
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

    /// Whether a list names what it must not, where the fault is to see that in another way than core.
    fn names(&self, list: &PassList, gone: impl Fn(&Resource) -> bool) -> bool {
        list.commands().iter().flat_map(accesses).any(|(resource, _)| gone(&resource))
    }
}

/// What is claimed of a device.
fn boast(mut caps: Caps, fault: Fault) -> Caps {
    match fault {
        Fault::CapsBoast => caps.max_storage_buffers_per_stage += 1,
        Fault::CapsBoastTextures => caps.max_storage_textures_per_stage += 1,
        Fault::CapsBoastThreads => caps.max_group_threads *= 2,
        Fault::CapsBoastMemory => caps.max_group_memory_bytes *= 2,
        Fault::CapsBoastUniforms => caps.max_uniform_binding_bytes *= 2,
        Fault::CapsBoastAlignment => caps.binding_alignment = 4,
        Fault::CapsBoastTargets => caps.max_color_targets += 1,
        Fault::CapsDeny => caps.compute = false,
        _ => {}
    }
    caps
}

/// What is done instead of a blend.
fn blended(fault: Fault, blend: Blend) -> Blend {
    match (fault, blend) {
        (Fault::OverReplaces, _) => Blend::Replace,
        (Fault::SumsAreProducts, Blend::Add) => Blend::Multiply,
        (Fault::SumsAreProducts, Blend::Multiply) => Blend::Add,
        (Fault::MinIsMax, Blend::Min) => Blend::Max,
        (Fault::MinIsMax, Blend::Max) => Blend::Min,
        (_, blend) => blend,
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
        let changed = TextureDesc::new(desc.label, desc.size, self.format(desc.format)).with_uses(desc.uses);
        let made = self.inner.create_texture(&changed)?;
        self.sizes.insert(made.into(), desc.bytes());
        self.memory.add(desc.bytes());
        self.textures.insert(made, *desc);
        Ok(made)
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        let made = self.inner.create_compute(desc)?;
        Ok(self.cached(made))
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        let mut desc = desc.clone();
        for (format, blend) in &mut desc.targets {
            (*format, *blend) = (self.format(*format), blended(self.fault, *blend));
        }
        desc.depth = match (self.fault, desc.depth) {
            (Fault::DepthSwapped, Depth::TestWrite(DepthOrder::Standard)) => Depth::TestWrite(DepthOrder::Reverse),
            (Fault::DepthSwapped, Depth::TestWrite(DepthOrder::Reverse)) => Depth::TestWrite(DepthOrder::Standard),
            (Fault::DepthTestWrites, Depth::Test(order)) => Depth::TestWrite(order),
            (_, depth) => depth,
        };
        self.inner.create_raster(&desc)
    }

    fn destroy(&mut self, resource: Resource) {
        let bytes = self.sizes.remove(&resource).unwrap_or(0);
        self.destroyed.insert(resource);
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

    fn read(&mut self, ticket: Ticket) -> ReadBack {
        let bytes = match self.inner.read(ticket) {
            ReadBack::Ready(bytes) if !self.given_up.contains(&ticket) => bytes,
            ReadBack::Unknown if self.fault == Fault::NothingUnknown => return ReadBack::Pending,
            ReadBack::Unknown => return self.given.get(&ticket).cloned().map_or(ReadBack::Unknown, ReadBack::Ready),
            other => return other,
        };
        if self.fault == Fault::ReadsAgain {
            self.given.insert(ticket, bytes.clone());
        }
        ReadBack::Ready(match self.pictures.remove(&ticket) {
            Some(desc) => self.picture(bytes, &desc),
            None => bytes,
        })
    }

    fn cancel_read(&mut self, ticket: Ticket) {
        self.given_up.insert(ticket);
        if self.fault != Fault::GivenUpIsRead {
            self.inner.cancel_read(ticket);
        }
    }

    fn timings(&mut self) -> Vec<Timing> {
        let mut timings = self.inner.timings();
        if self.fault == Fault::TimingsReversed {
            timings.reverse();
        }
        for timing in &mut timings {
            match self.fault {
                Fault::TimingsZero => timing.nanoseconds = 0.0,
                Fault::ScopesForgotten => timing.scope = None,
                _ => {}
            }
        }
        timings
    }

    fn memory(&self) -> Memory {
        self.memory
    }
}

impl<B: Run> Run for Faulty<B> {
    fn run(&mut self, list: &PassList) -> Result<()> {
        let destroyed = self.fault == Fault::DestroyedAtOnce;
        if destroyed && self.names(list, |resource| self.destroyed.contains(resource)) {
            return Err(Error::rule("a list", "it names what was destroyed"));
        }
        let list = self.spoiled(list);
        match (self.inner.run(&list), self.fault) {
            (Err(Error::Rule { .. }), Fault::RulesIgnored) => Ok(()),
            (Err(error @ Error::Rule { .. }), Fault::RulesLate) => {
                let one = |command: &_| self.inner.run(&list.with_commands(vec![Clone::clone(command)]));
                list.commands().iter().try_for_each(one).and(Err(error))
            }
            (result, _) => result,
        }
    }
}
