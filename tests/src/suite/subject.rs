//! The backend under test, and words for what most cases do with it.

use std::sync::Arc;

use bytemuck::NoUninit;
use tressfx_core::backend::{Blend, BufferDesc, ComputeDesc, Depth, Format, RasterDesc, Run, TextureDesc};
use tressfx_core::error::{Error, Label};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Draw, Grid, Load, PassList, RasterPass, Ticket};
use tressfx_core::shader::{Binding, Kernel, Module, RasterPipeline, Shader, ShaderSource, Specialization};

use super::Make;

/// What the shaders of the suite may import.
const LIBRARY: &[Module] = &[("cover", include_str!("cover.wgsl"))];

/// A shader of the suite.
pub(super) const fn source(label: &'static str, text: &'static str) -> ShaderSource {
    ShaderSource { label, root: ("root", text), library: LIBRARY }
}

/// What describes a buffer of a size: one of the constructors of [`BufferDesc`].
pub(super) type Describe = fn(Label, u64) -> BufferDesc;

/// A backend, and the list that it will run next.
pub(crate) struct Subject<'a> {
    pub(crate) backend: Box<dyn Run>,
    pub(super) list: PassList,
    pub(super) make: Make<'a>,
}

impl<'a> Subject<'a> {
    pub(super) fn new(backend: Box<dyn Run>, make: Make<'a>) -> Self {
        Self { backend, list: PassList::new(), make }
    }

    /// Another backend of the same kind.
    pub(super) fn another(&self) -> Box<dyn Run> {
        (self.make)().expect("a second backend")
    }

    /// A buffer of zeros.
    pub(super) fn buffer(&mut self, words: usize, desc: Describe) -> BufferId {
        self.backend.create_buffer(&desc("suite.buffer", 4 * words as u64)).expect("a buffer")
    }

    /// A storage buffer of zeros.
    pub(super) fn zeros(&mut self, words: usize) -> BufferId {
        self.buffer(words, BufferDesc::storage)
    }

    /// A storage buffer that is filled by the list.
    pub(super) fn storage<T: NoUninit>(&mut self, data: &[T]) -> BufferId {
        self.filled(data, BufferDesc::storage)
    }

    /// A uniform buffer that is filled by the list.
    pub(super) fn uniform<T: NoUninit>(&mut self, data: &[T]) -> BufferId {
        self.filled(data, BufferDesc::uniform)
    }

    /// A buffer that is filled by the list.
    pub(super) fn filled<T: NoUninit>(&mut self, data: &[T], desc: Describe) -> BufferId {
        let buffer = self.buffer(size_of_val(data) / 4, desc);
        self.list.upload(buffer, 0, data);
        buffer
    }

    /// A texture.
    pub(super) fn texture(&mut self, size: [u32; 2], format: Format) -> TextureId {
        self.backend.create_texture(&TextureDesc::new("suite.texture", size, format)).expect("a texture")
    }

    /// A texture that compute passes write too.
    pub(super) fn storage_texture(&mut self, size: [u32; 2], format: Format) -> TextureId {
        let desc = TextureDesc::new("suite.storage_texture", size, format).storage();
        self.backend.create_texture(&desc).expect("a texture that is written")
    }

    /// A compute kernel that is not specialised.
    pub(super) fn compute(&mut self, source: &ShaderSource) -> Kernel {
        self.specialized(source, &Specialization::new())
    }

    /// A compute kernel.
    pub(super) fn specialized(&mut self, source: &ShaderSource, specialization: &Specialization) -> Kernel {
        let shader = Arc::new(Shader::new(source, specialization).expect("the suite's shaders are fine"));
        self.backend.create_compute(&ComputeDesc::new(shader)).expect("a compute kernel")
    }

    /// A raster pipeline.
    pub(super) fn raster(
        &mut self,
        source: &ShaderSource,
        targets: &[(Format, Blend)],
        depth: Depth,
    ) -> RasterPipeline {
        let shader = Arc::new(Shader::new(source, &Specialization::new()).expect("the suite's shaders are fine"));
        let mut desc = RasterDesc::new(shader).depth(depth);
        desc.targets = targets.to_vec();
        self.backend.create_raster(&desc).expect("a raster pipeline")
    }

    /// Has the list run a kernel over groups.
    pub(super) fn dispatch(&mut self, kernel: &Kernel, bindings: &[(&str, Binding)], groups: [u32; 3]) {
        self.list.compute(kernel, &kernel.bind(bindings).expect("bindings"), Grid(groups));
    }

    /// Has the list run a kernel over as many groups as a buffer says.
    pub(super) fn indirect(&mut self, kernel: &Kernel, bindings: &[(&str, Binding)], counts: BufferId, offset: u64) {
        self.list.compute_indirect(kernel, &kernel.bind(bindings).expect("bindings"), counts, offset);
    }

    /// Has the list draw into one colour target.
    pub(super) fn draw(&mut self, target: TextureId, load: Load<[f32; 4]>, draws: Vec<Draw>) {
        let mut pass = RasterPass::new("suite.draw").color(target, load);
        pass.draws = draws;
        self.list.raster(pass);
    }

    /// Runs what the list holds, and begins a new one.
    pub(super) fn run(&mut self) {
        let list = std::mem::take(&mut self.list);
        self.backend.run(&list).expect("the list runs");
    }

    /// What came back, after running what the list holds.
    pub(super) fn read(&mut self, ticket: Ticket) -> Vec<u8> {
        if !self.list.commands().is_empty() {
            self.run();
        }
        self.backend.read(ticket).ready().expect("the list has run, so the bytes are there")
    }

    /// As [`read`](Self::read), in words.
    pub(super) fn read_words(&mut self, ticket: Ticket) -> Vec<u32> {
        bytemuck::pod_collect_to_vec(&self.read(ticket))
    }

    /// Runs what the list holds and brings the first words of a buffer home.
    pub(super) fn words(&mut self, buffer: BufferId, count: usize) -> Vec<u32> {
        let ticket = self.list.read_buffer(buffer, 0, 4 * count as u64);
        self.read_words(ticket)
    }

    /// Runs what the list holds and brings a texture home.
    pub(super) fn texels(&mut self, texture: TextureId) -> Vec<u8> {
        let ticket = self.list.read_texture(texture);
        self.read(ticket)
    }

    /// As [`texels`](Self::texels), a word for each texel of four bytes.
    pub(super) fn texel_words(&mut self, texture: TextureId) -> Vec<u32> {
        bytemuck::pod_collect_to_vec(&self.texels(texture))
    }

    /// Holds that the list is refused because of its last command, and that the answer says `what`.
    #[track_caller]
    pub(super) fn assert_refused(&mut self, what: &str) {
        let list = std::mem::take(&mut self.list);
        let last = list.commands().last().expect("a list with a mistake in it");
        let expected = format!("command {}, {}", list.commands().len() - 1, last.name());
        match self.backend.run(&list) {
            Err(Error::Rule { place, message }) => {
                assert!(place.starts_with(&expected), "{place}: {message}: not {expected}");
                assert!(message.contains(what), "{place}: {message}: nothing of `{what}`");
            }
            other => panic!("{expected}: {other:?} is not the error of a broken rule"),
        }
    }
}

/// A draw of one instance.
pub(super) fn draw(pipeline: &RasterPipeline, bindings: &[(&str, Binding)], vertices: u32) -> Draw {
    Draw::new(pipeline, &pipeline.bind(bindings).expect("bindings"), vertices, 1)
}

/// Words that look random and are the same everywhere.
pub(super) fn noise(count: usize, seed: u32) -> Vec<u32> {
    let mix = |x: u32| (x ^ (x >> 15)).wrapping_mul(0x2c1b_3c6d);
    (0..count as u32).map(|i| mix(mix(i.wrapping_mul(0x9e37_79b9) ^ seed)) ^ i).collect()
}
