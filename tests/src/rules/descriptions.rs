//! Descriptions that break rules, or ask for more than there is.

use tressfx_core::backend::{
    Backend, Blend, BufferDesc, BufferUses, Caps, ComputeDesc, Depth, DepthOrder, Format, RasterDesc, TextureDesc,
    TextureUses,
};
use tressfx_core::error::{Error, Result};
use tressfx_core::shader::{Shader, ShaderSource, Specialization};

use super::world::drawn;

/// What is wrong with the answers of a backend to descriptions that it must refuse, and how many those were.
pub fn broken_descriptions(backend: &mut dyn Backend) -> (Vec<String>, usize) {
    let caps = backend.caps().clone();
    let mut answers = Answers::default();
    buffers(backend, &caps, &mut answers);
    textures(backend, &caps, &mut answers);
    if caps.compute {
        kernels(backend, &mut answers);
    }
    if caps.raster {
        pipelines(backend, &caps, &mut answers);
    }
    let memory = backend.memory().bytes;
    if memory != 0 {
        answers.complaints.push(format!("{memory} bytes of what was refused"));
    }
    (answers.complaints, answers.count)
}

#[derive(Default)]
struct Answers {
    complaints: Vec<String>,
    count: usize,
}

impl Answers {
    /// It must be an error of the caller's, which says so in these words.
    fn hold<T>(&mut self, what: &str, answer: Result<T>, says: &str) {
        self.count += 1;
        match answer {
            Err(error @ (Error::Rule { .. } | Error::Unsupported { .. } | Error::Shader { .. }))
                if error.to_string().contains(says) => {}
            Err(error) => self.complaints.push(format!("{what}: {error} does not say `{says}`")),
            Ok(_) => self.complaints.push(format!("{what}: not refused")),
        }
    }
}

fn buffers(backend: &mut dyn Backend, caps: &Caps, answers: &mut Answers) {
    let all = BufferUses::STORAGE | BufferUses::UNIFORM | BufferUses::INDIRECT | BufferUses::COPIES;
    for (bytes, uses, says) in [
        (0, BufferUses::STORAGE, "0 bytes"),
        (3, BufferUses::STORAGE, "3 bytes"),
        (6, BufferUses::COPIES, "6 bytes"),
        (u64::MAX, all, "bytes"),
        (u64::MAX - 3, all, "a buffer of"),
        (caps.max_buffer_bytes / 4 * 4 + 4, BufferUses::COPIES, "a buffer of"),
        (16, BufferUses::default(), "no use"),
    ] {
        let answer = backend.create_buffer(&BufferDesc::new("rules.buffer", bytes, uses));
        answers.hold(&format!("a buffer of {bytes} bytes for {uses:?}"), answer, says);
    }
}

fn textures(backend: &mut dyn Backend, caps: &Caps, answers: &mut Answers) {
    let edge = caps.max_texture_size + 1;
    for size in [[0, 1], [1, 0], [0, 0], [edge, 1], [1, edge], [u32::MAX, u32::MAX]] {
        let answer = backend.create_texture(&TextureDesc::new("rules.texture", size, Format::Rgba8));
        answers.hold(
            &format!("a texture of {size:?}"),
            answer,
            if size.contains(&0) { "a size" } else { "a texture edge" },
        );
    }
    for format in Format::ALL {
        let desc = TextureDesc::new("rules.texture", [4, 4], format);
        let answer = backend.create_texture(&desc.with_uses(TextureUses::default()));
        answers.hold(&format!("{format:?} for nothing"), answer, "no use");
        if !format.is_storage() {
            let answer = backend.create_texture(&desc.with_uses(TextureUses::STORAGE));
            answers.hold(&format!("{format:?} that is written"), answer, "no compute pass writes");
        }
    }
    let depth = TextureDesc::new("rules.texture", [4, 4], Format::Depth32F);
    let answer = backend.create_texture(&depth.with_uses(TextureUses::COPY_DESTINATION));
    answers.hold("depth that is copied to", answer, "depth is not copied to");
}

/// Shaders that no device runs as kernels.
const KERNELS: [(&str, &str, &str); 8] = [
    ("no entry point", "fn helper() {}", "no Compute entry point"),
    (
        "two entry points",
        "@compute @workgroup_size(1) fn a() {} @compute @workgroup_size(1) fn b() {}",
        "more than one",
    ),
    ("too many threads", "@compute @workgroup_size(1024, 1024, 64) fn a() {}", "groups of"),
    (
        "another group of bindings",
        "@group(1) @binding(0) var<uniform> a: vec4<u32>;
        @group(0) @binding(0) var<storage, read_write> b: array<u32>;
        @compute @workgroup_size(1) fn main() { b[0] = a.x; }",
        "only @group(0) is used",
    ),
    (
        "two bindings of one number",
        "@group(0) @binding(0) var<uniform> a: vec4<u32>;
        @group(0) @binding(0) var<storage, read_write> b: array<u32>;
        @compute @workgroup_size(1) fn main() { b[0] = a.x; }",
        "conflict",
    ),
    (
        "a storage texture that is read alone",
        "@group(0) @binding(0) var a: texture_storage_2d<r32uint, read>;
        @group(0) @binding(1) var<storage, read_write> b: array<u32>;
        @compute @workgroup_size(1) fn main() { b[0] = textureLoad(a, vec2<u32>()).x; }",
        "no kind of binding",
    ),
    (
        "a binding number beyond all",
        "@group(0) @binding(4000000000) var<storage, read_write> b: array<u32>;
        @compute @workgroup_size(1) fn main() { b[0] = 1u; }",
        "binding",
    ),
    (
        "a size of groups that is decided later",
        "override size: u32 = 8;
        @compute @workgroup_size(size) fn main() {}",
        "overrid",
    ),
];

fn kernels(backend: &mut dyn Backend, answers: &mut Answers) {
    for (what, text, says) in KERNELS {
        let source = ShaderSource { label: "rules.kernel", root: ("root", text), library: &[] };
        let shader = Shader::new(&source, &Specialization::new());
        let answer = shader.and_then(|shader| backend.create_compute(&ComputeDesc::new(shader.into())));
        answers.hold(&format!("a kernel with {what}"), answer, says);
    }
}

fn pipelines(backend: &mut dyn Backend, caps: &Caps, answers: &mut Answers) {
    let white =
        || RasterDesc::new(drawn("rules.white", "@fragment fn f() -> @location(0) vec4<f32> { return vec4<f32>(); }"));
    let uint =
        || RasterDesc::new(drawn("rules.uint", "@fragment fn f() -> @location(0) vec4<u32> { return vec4<u32>(); }"));
    let one = || RasterDesc::new(drawn("rules.one", "@fragment fn f() -> @location(0) f32 { return 1.0; }"));
    let nothing = || RasterDesc::new(drawn("rules.nothing", ""));
    let mut hold = |what: &str, desc: RasterDesc, says| answers.hold(what, backend.create_raster(&desc), says);
    hold("no target", white(), "it has no target");
    hold("depth as a colour", white().target(Format::Depth32F, Blend::Replace), "depth is no colour");
    hold("floats into integers", white().target(Format::R32Uint, Blend::Replace), "the shader gives vec4<f32>");
    hold("integers into floats", uint().target(Format::Rgba8, Blend::Replace), "the shader gives vec4<u32>");
    hold("one channel into four", one().target(Format::Rgba8, Blend::Replace), "the shader gives f32");
    hold("one channel, blended", one().target(Format::R16F, Blend::Over), "the shader gives f32");
    hold("no colour", nothing().target(Format::Rgba8, Blend::Replace), "the shader gives nothing");
    let two = white().target(Format::Rgba8, Blend::Replace).target(Format::Rgba8, Blend::Replace);
    hold("a target that the shader does not give", two, "target 1");
    for format in [Format::Rg32F, Format::R32F, Format::R32Uint] {
        for blend in [Blend::Over, Blend::Add, Blend::Multiply, Blend::Min, Blend::Max] {
            let shader = if format.is_uint() { uint() } else { white() };
            hold(&format!("{format:?} with {blend:?}"), shader.target(format, blend), "does not blend");
        }
    }
    if !caps.r11g11b10_targets {
        hold(
            "a format that is not drawn to",
            white().target(Format::R11G11B10F, Blend::Replace),
            "targets of the format",
        );
    }
    let many = (0..=caps.max_color_targets).fold(white(), |desc, _| desc.target(Format::Rgba8, Blend::Replace));
    hold("too many targets", many, "colour targets");
    broken_stages(backend, answers);
}

/// Shaders whose stages do not fit each other, or the contract.
const STAGES: [(&str, &str, &str); 7] = [
    ("no vertex stage", "@fragment fn f() -> @location(0) vec4<f32> { return vec4<f32>(); }", "no Vertex entry point"),
    ("a kernel", "@compute @workgroup_size(1) fn main() {}", "no Vertex entry point"),
    (
        "two fragment stages",
        "@vertex fn v() -> @builtin(position) vec4<f32> { return vec4<f32>(); }
        @fragment fn f() -> @location(0) vec4<f32> { return vec4<f32>(); }
        @fragment fn g() -> @location(0) vec4<f32> { return vec4<f32>(); }",
        "more than one",
    ),
    (
        "something that is not handed on",
        "@vertex fn v() -> @builtin(position) vec4<f32> { return vec4<f32>(); }
        @fragment fn f(@location(0) a: f32) -> @location(0) vec4<f32> { return vec4<f32>(a); }",
        "at location 0",
    ),
    (
        "something of another type",
        "struct V { @builtin(position) at: vec4<f32>, @location(0) a: vec2<f32> }
        @vertex fn v() -> V { return V(vec4<f32>(), vec2<f32>()); }
        @fragment fn f(@location(0) a: f32) -> @location(0) vec4<f32> { return vec4<f32>(a); }",
        "at location 0",
    ),
    (
        "vertices from a buffer",
        "@vertex fn v(@location(0) at: vec3<f32>) -> @builtin(position) vec4<f32> { return vec4<f32>(at, 1.0); }
        @fragment fn f() -> @location(0) vec4<f32> { return vec4<f32>(); }",
        "vertex",
    ),
    (
        "a texture that fragments write",
        "@group(0) @binding(0) var written: texture_storage_2d<rgba8unorm, write>;
        @vertex fn v() -> @builtin(position) vec4<f32> { return vec4<f32>(); }
        @fragment fn f() -> @location(0) vec4<f32> {
            textureStore(written, vec2<u32>(), vec4<f32>());
            return vec4<f32>();
        }",
        "",
    ),
];

fn broken_stages(backend: &mut dyn Backend, answers: &mut Answers) {
    for (what, text, says) in STAGES {
        let source = ShaderSource { label: "rules.stages", root: ("root", text), library: &[] };
        let answer = Shader::new(&source, &Specialization::new()).and_then(|shader| {
            let desc = RasterDesc::new(shader.into()).target(Format::Rgba8, Blend::Replace);
            backend.create_raster(&desc.depth(Depth::Test(DepthOrder::Standard)))
        });
        answers.hold(&format!("a pipeline with {what}"), answer, says);
    }
}
