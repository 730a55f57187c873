//! What the lists name: resources and pipelines of every kind, some destroyed, some of another backend.

use std::sync::Arc;

use tressfx_core::backend::{
    Backend, Blend, BufferDesc, BufferUses, ComputeDesc, Depth, DepthOrder, Format, RasterDesc, TextureDesc,
    TextureUses,
};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::PassList;
use tressfx_core::shader::{Kernel, RasterPipeline, Shader, ShaderSource, Specialization};

/// Bytes of every buffer.
pub(super) const BYTES: u64 = 4096;
/// Width and height of most textures.
pub(super) const SIZE: [u32; 2] = [8, 8];

/// Resources and pipelines of one backend.
#[derive(Debug)]
pub struct World {
    /// Copied and bound in every way, and counts of passes and draws.
    pub(super) buffer: BufferId,
    pub(super) other: BufferId,
    /// What sound commands write; nothing else does.
    pub(super) marker: BufferId,
    /// As [`World::buffer`], for uniforms.
    pub(super) uniform: BufferId,
    /// Neither copied from nor bound.
    pub(super) copy_target: BufferId,
    /// Neither copied to nor bound.
    pub(super) copy_source: BufferId,
    /// Neither copied nor bound as a uniform, nor counts.
    pub(super) storage: BufferId,
    /// Destroyed before any list was begun.
    pub(super) gone: BufferId,
    /// Of another backend.
    pub(super) foreign: BufferId,
    pub(super) color: TextureId,
    pub(super) second: TextureId,
    /// 128 texels wide: rows of 512 bytes.
    pub(super) wide: TextureId,
    pub(super) uint: TextureId,
    pub(super) half: TextureId,
    pub(super) float: TextureId,
    pub(super) depth: TextureId,
    /// Drawn to alone.
    pub(super) target: TextureId,
    /// Read by shaders alone.
    pub(super) sampled: TextureId,
    pub(super) gone_texture: TextureId,
    pub(super) foreign_texture: TextureId,
    /// Where the device has compute and raster passes.
    pub(super) passes: Option<Passes>,
    pub(super) alignment: u64,
    pub(super) max_targets: u32,
}

/// Pipelines, and what they alone need.
#[derive(Debug)]
pub(super) struct Passes {
    pub(super) mix: Kernel,
    pub(super) twice: Kernel,
    pub(super) look: Kernel,
    pub(super) store: Kernel,
    pub(super) gone_kernel: Kernel,
    pub(super) foreign_kernel: Kernel,
    pub(super) fill: RasterPipeline,
    pub(super) deep: RasterPipeline,
    pub(super) two: RasterPipeline,
    pub(super) sample: RasterPipeline,
    pub(super) pull: RasterPipeline,
    /// Where fragments can write.
    pub(super) write: Option<RasterPipeline>,
    pub(super) gone_pipeline: RasterPipeline,
    pub(super) foreign_pipeline: RasterPipeline,
    /// Written by compute passes.
    pub(super) stored: TextureId,
    /// Of a size that the device does not bind at once, if buffers can be as large.
    pub(super) large_uniform: Option<BufferId>,
}

const MIX: &str = "@group(0) @binding(0) var<uniform> params: vec4<u32>;
    @group(0) @binding(1) var<storage, read> input: array<u32, 16>;
    @group(0) @binding(2) var<storage, read_write> output: array<u32>;
    @compute @workgroup_size(16) fn mix(@builtin(local_invocation_index) i: u32) { output[i] = input[i] + params.x; }";

const TWICE: &str = "@group(0) @binding(0) var<storage, read_write> one: array<u32>;
    @group(0) @binding(1) var<storage, read_write> other: array<u32>;
    @compute @workgroup_size(1) fn twice() { one[0] = 1u; other[0] = 2u; }";

const LOOK: &str = "@group(0) @binding(0) var plain: texture_2d<f32>;
    @group(0) @binding(1) var filtered: texture_2d<f32>;
    @group(0) @binding(2) var how: sampler;
    @group(0) @binding(3) var ints: texture_2d<u32>;
    @group(0) @binding(4) var depths: texture_depth_2d;
    @group(0) @binding(5) var<storage, read_write> output: array<vec4<f32>>;
    @compute @workgroup_size(1) fn look() {
        let at = vec2<u32>(0u);
        output[0] = textureLoad(plain, at, 0) + textureSampleLevel(filtered, how, vec2<f32>(0.5), 0.0)
            + vec4<f32>(f32(textureLoad(ints, at, 0).x), textureLoad(depths, at, 0), 0.0, 0.0);
    }";

const STORE: &str = "@group(0) @binding(0) var written: texture_storage_2d<rgba8unorm, write>;
    @group(0) @binding(1) var read: texture_2d<f32>;
    @compute @workgroup_size(1) fn store() {
        textureStore(written, vec2<u32>(0u), textureLoad(read, vec2<u32>(1u), 0));
    }";

const VERTEX: &str = "@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
        return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
    }";

const FILL: &str = "@group(0) @binding(0) var<uniform> color: vec4<f32>;
    @fragment fn fragment() -> @location(0) vec4<f32> { return color; }";

const TWO: &str = "struct Two { @location(0) one: vec4<f32>, @location(1) other: vec4<f32> }
    @fragment fn fragment() -> Two { return Two(vec4<f32>(0.0), vec4<f32>(1.0)); }";

const SAMPLE: &str = "@group(0) @binding(0) var picture: texture_2d<f32>;
    @group(0) @binding(1) var how: sampler;
    @fragment fn fragment() -> @location(0) vec4<f32> { return textureSample(picture, how, vec2<f32>(0.5)); }";

const PULL: &str = "@group(0) @binding(0) var<storage, read> colors: array<u32>;
    @fragment fn fragment() -> @location(0) vec4<f32> { return unpack4x8unorm(colors[0]); }";

const WRITE: &str = "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
    @fragment fn fragment() -> @location(0) vec4<f32> { values[0] = 1u; return vec4<f32>(1.0); }";

/// A shader of the tests.
pub(super) fn shader(label: &'static str, text: &'static str) -> Arc<Shader> {
    let source = ShaderSource { label, root: ("root", text), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).expect("a sound shader"))
}

/// A raster shader of the tests.
pub(super) fn drawn(label: &'static str, fragment: &str) -> Arc<Shader> {
    shader(label, format!("{VERTEX}\n{fragment}").leak())
}

impl World {
    /// Makes everything.
    ///
    /// # Panics
    /// If a backend refuses it.
    pub fn new(backend: &mut dyn Backend, another: &mut dyn Backend) -> Self {
        let mut buffer = |label, uses| {
            backend.create_buffer(&BufferDesc::new(label, BYTES, uses)).unwrap_or_else(|error| panic!("{error}"))
        };
        let all = BufferUses::STORAGE | BufferUses::INDIRECT | BufferUses::COPIES;
        let [main, other, marker, gone] = ["buffer", "other", "marker", "gone"].map(|label| buffer(label, all));
        let uniform = buffer("uniform", BufferUses::UNIFORM | BufferUses::COPIES);
        let copy_target = buffer("copy_target", BufferUses::COPY_DESTINATION);
        let copy_source = buffer("copy_source", BufferUses::COPY_SOURCE);
        let storage = buffer("storage", BufferUses::STORAGE);
        let foreign = (0..32).map(|_| another.create_buffer(&BufferDesc::new("foreign", BYTES, all))).last();
        let foreign = foreign.expect("32 of them").expect("a buffer of another backend");
        let mut texture = |label, size, format| {
            backend.create_texture(&TextureDesc::new(label, size, format)).unwrap_or_else(|error| panic!("{error}"))
        };
        let [color, second, gone_texture] =
            ["color", "second", "gone"].map(|label| texture(label, SIZE, Format::Rgba8));
        let wide = texture("wide", [128, 4], Format::Rgba8);
        let uint = texture("uint", SIZE, Format::R32Uint);
        let half = texture("half", SIZE, Format::Rgba16F);
        let float = texture("float", SIZE, Format::R32F);
        let depth = texture("depth", SIZE, Format::Depth32F);
        let mut only = |label, uses| {
            let desc = TextureDesc::new(label, SIZE, Format::Rgba8).with_uses(uses);
            backend.create_texture(&desc).unwrap_or_else(|error| panic!("{error}"))
        };
        let target = only("target", TextureUses::TARGET);
        let sampled = only("sampled", TextureUses::SAMPLED);
        let foreign_texture = (0..32)
            .map(|_| another.create_texture(&TextureDesc::new("foreign", SIZE, Format::Rgba8)))
            .last()
            .expect("32 of them")
            .expect("a texture of another backend");
        backend.destroy(gone.into());
        backend.destroy(gone_texture.into());
        let caps = backend.caps().clone();
        Self {
            buffer: main,
            other,
            marker,
            uniform,
            copy_target,
            copy_source,
            storage,
            gone,
            foreign,
            color,
            second,
            wide,
            uint,
            half,
            float,
            depth,
            target,
            sampled,
            gone_texture,
            foreign_texture,
            passes: (caps.compute && caps.raster).then(|| Passes::new(backend, another)),
            alignment: caps.binding_alignment,
            max_targets: caps.max_color_targets,
        }
    }

    /// Sound commands; all but the second leave [`World::marker`] other than zero.
    pub(super) fn sound(&self) -> PassList {
        let mut list = PassList::new();
        list.upload(self.marker, 0, &[7u32; 16]);
        list.clear(self.other, 0, 64);
        list.upload(self.marker, 64, &[8u32; 16]);
        list
    }

    /// A depth texture of eight by eight texels.
    pub fn depth(&self) -> TextureId {
        self.depth
    }

    /// The buffer that stays zero as long as nothing of a broken list is done, and its size.
    pub fn marker(&self) -> (BufferId, u64) {
        (self.marker, BYTES)
    }
}

impl Passes {
    fn new(backend: &mut dyn Backend, another: &mut dyn Backend) -> Self {
        let caps = backend.caps().clone();
        let kernel = |backend: &mut dyn Backend, label, text| {
            backend.create_compute(&ComputeDesc::new(shader(label, text))).unwrap_or_else(|error| panic!("{error}"))
        };
        let raster = |backend: &mut dyn Backend, label, text, targets: usize, depth| {
            let desc = RasterDesc::new(drawn(label, text)).depth(depth);
            let desc = (0..targets).fold(desc, |desc, _| desc.target(Format::Rgba8, Blend::Replace));
            backend.create_raster(&desc).unwrap_or_else(|error| panic!("{error}"))
        };
        let stored = TextureDesc::new("stored", SIZE, Format::Rgba8).storage();
        let large = caps.max_uniform_binding_bytes.checked_add(256).filter(|&bytes| bytes <= (1 << 20));
        let gone_kernel = kernel(backend, "gone", MIX);
        backend.destroy_pipeline(gone_kernel.pipeline);
        let gone_pipeline = raster(backend, "gone", FILL, 1, Depth::Off);
        backend.destroy_pipeline(gone_pipeline.pipeline);
        // As many as here, so that no place of theirs is beyond ours.
        let foreign_kernel = (0..8).map(|_| kernel(another, "foreign", MIX)).last().expect("8 of them");
        let foreign_pipeline = (0..4).map(|_| raster(another, "foreign", FILL, 1, Depth::Off)).last();
        Self {
            mix: kernel(backend, "mix", MIX),
            twice: kernel(backend, "twice", TWICE),
            look: kernel(backend, "look", LOOK),
            store: kernel(backend, "store", STORE),
            gone_kernel,
            foreign_kernel,
            fill: raster(backend, "fill", FILL, 1, Depth::Off),
            deep: raster(backend, "deep", FILL, 1, Depth::TestWrite(DepthOrder::Standard)),
            two: raster(backend, "two", TWO, 2, Depth::Off),
            sample: raster(backend, "sample", SAMPLE, 1, Depth::Off),
            pull: raster(backend, "pull", PULL, 1, Depth::Off),
            write: caps.fragment_writes.then(|| raster(backend, "write", WRITE, 1, Depth::Off)),
            gone_pipeline,
            foreign_pipeline: foreign_pipeline.expect("4 of them"),
            stored: backend.create_texture(&stored).expect("a texture that is written"),
            large_uniform: large
                .map(|bytes| backend.create_buffer(&BufferDesc::uniform("large", bytes)).expect("a large buffer")),
        }
    }
}
