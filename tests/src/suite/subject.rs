//! The backend under test, and words for what most cases do with it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use bytemuck::NoUninit;
use tressfx_core::backend::{
    Backend, Blend, BufferDesc, BufferUse, ComputeDesc, Depth, Format, Kernel, RasterDesc, TextureDesc,
};
use tressfx_core::id::{BufferId, Resource, TextureId};
use tressfx_core::pass::{Draw, Grid, Load, PassList, RasterPass, Ticket};
use tressfx_core::shader::{Module, Shader, ShaderSource, Specialization};

use super::{Make, words};

/// What the shaders of the suite may import.
const LIBRARY: &[Module] = &[("cover", include_str!("cover.wgsl"))];

/// A shader of the suite.
pub(super) const fn source(label: &'static str, text: &'static str) -> ShaderSource {
    ShaderSource { label, root: ("root", text), library: LIBRARY }
}

/// A backend, and the list that it will run next.
pub(crate) struct Subject<'a> {
    pub(crate) backend: Box<dyn Backend>,
    pub(super) list: PassList,
    pub(super) make: Make<'a>,
}

impl<'a> Subject<'a> {
    pub(super) fn new(backend: Box<dyn Backend>, make: Make<'a>) -> Self {
        Self { backend, list: PassList::new(), make }
    }

    /// Another backend of the same kind.
    pub(super) fn another(&self) -> Box<dyn Backend> {
        (self.make)().expect("a second backend")
    }

    /// A buffer of zeros.
    pub(super) fn buffer(&mut self, words: usize, usage: BufferUse) -> BufferId {
        let desc = BufferDesc { label: "suite.buffer", bytes: 4 * words as u64, usage };
        self.backend.create_buffer(&desc).expect("a buffer")
    }

    /// A storage buffer of zeros.
    pub(super) fn zeros(&mut self, words: usize) -> BufferId {
        self.buffer(words, BufferUse::Storage)
    }

    /// A storage buffer that is filled by the list.
    pub(super) fn storage<T: NoUninit>(&mut self, data: &[T]) -> BufferId {
        self.filled(data, BufferUse::Storage)
    }

    /// A uniform buffer that is filled by the list.
    pub(super) fn uniform<T: NoUninit>(&mut self, data: &[T]) -> BufferId {
        self.filled(data, BufferUse::Uniform)
    }

    /// A buffer that is filled by the list.
    pub(super) fn filled<T: NoUninit>(&mut self, data: &[T], usage: BufferUse) -> BufferId {
        let buffer = self.buffer(size_of_val(data) / 4, usage);
        self.list.upload(buffer, 0, data);
        buffer
    }

    /// A texture.
    pub(super) fn texture(&mut self, size: [u32; 2], format: Format) -> TextureId {
        self.backend.create_texture(&TextureDesc { label: "suite.texture", size, format }).expect("a texture")
    }

    /// A compute kernel that is not specialised.
    pub(super) fn compute(&mut self, source: &ShaderSource) -> Kernel {
        self.specialised(source, &Specialization::new())
    }

    /// A compute kernel.
    pub(super) fn specialised(&mut self, source: &ShaderSource, specialization: &Specialization) -> Kernel {
        let shader = Arc::new(Shader::new(source, specialization).expect("the suite's shaders are fine"));
        self.backend.create_compute(&ComputeDesc { shader }).expect("a compute kernel")
    }

    /// A raster kernel.
    pub(super) fn raster(&mut self, source: &ShaderSource, targets: &[(Format, Blend)], depth: Depth) -> Kernel {
        let shader = Arc::new(Shader::new(source, &Specialization::new()).expect("the suite's shaders are fine"));
        let desc = RasterDesc { shader, targets: targets.to_vec(), depth };
        self.backend.create_raster(&desc).expect("a raster kernel")
    }

    /// Has the list run a kernel over groups.
    pub(super) fn dispatch(&mut self, kernel: &Kernel, resources: &[(&str, Resource)], groups: [u32; 3]) {
        self.list.compute(kernel, &kernel.bind(resources), Grid(groups));
    }

    /// Has the list draw into one colour target.
    pub(super) fn draw(&mut self, target: TextureId, load: Load<[f32; 4]>, draws: Vec<Draw>) {
        let colors = vec![(target, load)];
        self.list.raster(RasterPass { label: "suite.draw", colors, depth: None, draws });
    }

    /// Runs what the list holds, and begins a new one.
    pub(super) fn run(&mut self) {
        let list = std::mem::take(&mut self.list);
        self.backend.run(&list).expect("the list runs");
    }

    /// What came back, after running what the list holds.
    pub(super) fn read(&mut self, ticket: Ticket) -> Vec<u8> {
        if !self.list.commands.is_empty() {
            self.run();
        }
        self.backend.read(ticket).expect("the list has run, so the bytes are there")
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

    /// Has `mistake` made, and holds that it panics.
    pub(super) fn assert_noticed(&mut self, what: &str, mistake: impl FnOnce(&mut Self)) {
        match catch_unwind(AssertUnwindSafe(|| mistake(self))) {
            Ok(()) => panic!("{what}: nobody noticed"),
            Err(panic) => assert!(!words(&*panic).is_empty(), "{what}: the panic has words"),
        }
        self.list = PassList::new();
    }
}

/// A draw of one instance.
pub(super) fn draw(kernel: &Kernel, resources: &[(&str, Resource)], vertices: u32) -> Draw {
    Draw { kernel: kernel.clone(), bindings: kernel.bind(resources), vertices, instances: 1 }
}

/// Words that look random and are the same everywhere.
pub(super) fn noise(count: usize, seed: u32) -> Vec<u32> {
    let mix = |x: u32| (x ^ (x >> 15)).wrapping_mul(0x2c1b_3c6d);
    (0..count as u32).map(|i| mix(mix(i.wrapping_mul(0x9e37_79b9) ^ seed)) ^ i).collect()
}
