//! Honest caps: what is claimed works, what is not claimed is refused with the need, and what is measured makes sense.

use std::fmt::Write;
use std::sync::Arc;

use tressfx_core::backend::{Blend, BufferDesc, ComputeDesc, Depth, Format, RasterDesc, TextureDesc};
use tressfx_core::error::{Error, Need, Result};
use tressfx_core::pass::{Load, RasterPass};
use tressfx_core::shader::{Shader, ShaderSource, Specialization};

use super::kernels::{ADD_ONE, COVER, PAINT, TURN};
use super::subject::{Subject, draw, source};

/// More than this is not asked for, so that the suite runs everywhere.
const MOST_BYTES: u64 = 256 << 20;
const MOST_BUFFERS: u32 = 64;

/// A kernel that adds up the first words of `count` storage buffers, the last of which it writes.
fn sum_of(count: u32) -> Arc<Shader> {
    let mut text = String::new();
    for i in 0..count {
        let access = if i + 1 == count { "read_write" } else { "read" };
        writeln!(text, "@group(0) @binding({i}) var<storage, {access}> b{i}: array<u32>;").expect("a string");
    }
    let sum: Vec<String> = (0..count).map(|i| format!("b{i}[0]")).collect();
    write!(text, "@compute @workgroup_size(1) fn sum() {{ b{}[0] = {}; }}", count - 1, sum.join(" + "))
        .expect("a string");
    let source = ShaderSource { label: "suite.sum", root: ("root", text.leak()), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).expect("a sum"))
}

pub(super) fn as_many_storage_buffers_as_claimed_are_bound(t: &mut Subject) {
    let count = t.backend.caps().max_storage_buffers_per_stage.min(MOST_BUFFERS);
    let kernel = t.backend.create_compute(&ComputeDesc::new(sum_of(count))).expect("the caps say so");
    let buffers: Vec<_> = (0..count).map(|i| t.storage(&[1 << (i % 24)])).collect();
    let names: Vec<String> = (0..count).map(|i| format!("b{i}")).collect();
    let resources: Vec<_> = names.iter().map(String::as_str).zip(buffers.iter().map(|&b| b.into())).collect();
    t.dispatch(&kernel, &resources, [1; 3]);
    assert_eq!(t.words(buffers[count as usize - 1], 1), [(0..count).map(|i| 1 << (i % 24)).sum::<u32>()]);
}

pub(super) fn the_largest_binding_is_written_to_its_end(t: &mut Subject) {
    const LAST: ShaderSource = source(
        "suite.last",
        "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(1) fn last() { values[arrayLength(&values) - 1u] = arrayLength(&values); values[0] = 7u; }",
    );
    let caps = t.backend.caps();
    let bytes = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes).min(MOST_BYTES) / 4 * 4;
    let kernel = t.compute(&LAST);
    let desc = BufferDesc::storage("suite.largest", bytes);
    let largest = t.backend.create_buffer(&desc).expect("the caps say so");
    t.dispatch(&kernel, &[("values", largest.into())], [1; 3]);
    let [first, last] = [0, bytes - 4].map(|offset| t.list.read_buffer(largest, offset, 4));
    assert_eq!((t.read_words(first), t.read_words(last)), (vec![7], vec![(bytes / 4) as u32]));
    let end = t.list.read_buffer(largest, bytes - 16, 12);
    assert_eq!(t.read_words(end), [0; 3]);
}

pub(super) fn the_longest_textures_are_cleared_to_their_ends(t: &mut Subject) {
    let edge = t.backend.caps().max_texture_size.min(1 << 16);
    for size in [[edge, 1], [1, edge]] {
        let texture = t.texture(size, Format::Rgba8);
        t.draw(texture, Load::Clear([1.0, 0.0, 0.0, 1.0]), Vec::new());
        assert_eq!(t.texel_words(texture), vec![0xff00_00ff; edge as usize], "{size:?}");
    }
}

fn assert_refused<T>(result: Result<T>, wanted: Need) {
    match result {
        Err(Error::Unsupported { label, need, .. }) => {
            assert!(label.starts_with("suite."), "{label} is not the label that was given");
            assert_eq!(need, wanted);
        }
        Err(error) => panic!("{wanted}: {error} does not name the need"),
        Ok(_) => panic!("{wanted}: not refused"),
    }
}

pub(super) fn buffers_beyond_the_caps_are_refused(t: &mut Subject) {
    let caps = t.backend.caps();
    let bytes = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes) / 4 * 4;
    if let Some(bytes) = bytes.checked_add(4) {
        let desc = BufferDesc::storage("suite.huge", bytes);
        assert_refused(t.backend.create_buffer(&desc), Need::StorageBindingBytes(bytes));
    }
    assert_eq!(t.backend.memory().bytes, 0, "what was refused takes nothing");
}

pub(super) fn textures_beyond_the_caps_are_refused(t: &mut Subject) {
    let edge = t.backend.caps().max_texture_size + 1;
    for size in [[edge, 1], [1, edge]] {
        let desc = TextureDesc::new("suite.long", size, Format::Rgba8);
        assert_refused(t.backend.create_texture(&desc), Need::TextureEdge(edge));
    }
    assert_eq!(t.backend.memory().bytes, 0, "what was refused takes nothing");
}

pub(super) fn bindings_beyond_the_caps_are_refused(t: &mut Subject) {
    let count = t.backend.caps().max_storage_buffers_per_stage;
    if count < MOST_BUFFERS {
        let shader = sum_of(count + 1);
        assert_refused(t.backend.create_compute(&ComputeDesc::new(shader)), Need::StorageBuffers(count + 1));
    }
}

/// A kernel of groups of a size that counts its threads, and shares so many words.
fn group_of([x, y, z]: [u32; 3], words: u32) -> Arc<Shader> {
    let text = format!(
        "var<workgroup> held: array<u32, {words}>;
        @group(0) @binding(0) var<storage, read_write> output: array<atomic<u32>, 2>;
        @compute @workgroup_size({x}, {y}, {z}) fn group_of(@builtin(local_invocation_index) i: u32) {{
            held[{words}u - 1u - i % {words}u] = i + 7u;
            workgroupBarrier();
            atomicAdd(&output[0], 1u);
            if (i == 0u) {{ atomicStore(&output[1], held[{words}u - 1u]); }}
        }}"
    );
    let source = ShaderSource { label: "suite.group_of", root: ("root", text.leak()), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).expect("a group"))
}

/// The longest groups that the caps allow along each axis.
fn longest_groups(t: &Subject) -> [[u32; 3]; 3] {
    let caps = t.backend.caps();
    let along = |axis: usize| {
        let mut size = [1; 3];
        size[axis] = caps.max_group_size[axis].min(caps.max_group_threads);
        size
    };
    [0, 1, 2].map(along)
}

pub(super) fn groups_are_as_large_as_claimed(t: &mut Subject) {
    let caps = t.backend.caps().clone();
    let words = caps.max_group_memory_bytes / 4;
    let mut sizes: Vec<_> = longest_groups(t).into_iter().map(|size| (size, 1)).collect();
    let [x, y, _] = caps.max_group_size;
    let wide = [x.min(caps.max_group_threads), y.min(caps.max_group_threads / x.min(caps.max_group_threads)), 1];
    sizes.extend([(wide, 1), ([1; 3], words), (wide, words)]);
    for (size, words) in sizes {
        let shader = group_of(size, words);
        let kernel = t.backend.create_compute(&ComputeDesc::new(shader)).expect("the caps say so");
        let output = t.zeros(2);
        t.dispatch(&kernel, &[("output", output.into())], [3, 1, 1]);
        let threads: u32 = size.iter().product();
        // The last word is written by the threads whose numbers are multiples of `words`; with more than one of them, by any.
        let found = t.words(output, 2);
        assert_eq!(found[0], 3 * threads, "{size:?}, {words} words");
        assert!(
            found[1] >= 7 && (found[1] - 7).is_multiple_of(words) && found[1] - 7 < threads,
            "{size:?}, {words} words"
        );
    }
}

pub(super) fn larger_groups_are_refused(t: &mut Subject) {
    let caps = t.backend.caps().clone();
    for axis in 0..3 {
        let mut size = [1; 3];
        size[axis] = caps.max_group_size[axis] + 1;
        let need = match size[axis] > caps.max_group_threads {
            true => Need::GroupThreads(size[axis]),
            false => Need::GroupSize { axis, threads: size[axis] },
        };
        let shader = group_of(size, 1);
        assert_refused(t.backend.create_compute(&ComputeDesc::new(shader)), need);
    }
    let [x, y, z] = caps.max_group_size;
    if let Some(more) =
        [[x, y, 1], [x, y, z]].into_iter().find(|size| size.iter().product::<u32>() > caps.max_group_threads)
    {
        let shader = group_of(more, 1);
        assert_refused(t.backend.create_compute(&ComputeDesc::new(shader)), Need::GroupThreads(more.iter().product()));
    }
    let shader = group_of([1; 3], caps.max_group_memory_bytes / 4 + 1);
    assert_refused(
        t.backend.create_compute(&ComputeDesc::new(shader)),
        Need::GroupMemory(caps.max_group_memory_bytes / 4 * 4 + 4),
    );
}

/// A kernel that writes its number into each of `count` textures.
fn stores(count: u32) -> Arc<Shader> {
    let mut text = String::new();
    for i in 0..count {
        writeln!(text, "@group(0) @binding({i}) var t{i}: texture_storage_2d<r32uint, write>;").expect("a string");
    }
    let store = |i: u32| format!("textureStore(t{i}, vec2<u32>(0u), vec4<u32>({i}u + 1u));");
    let all: String = (0..count).map(store).collect();
    write!(text, "@compute @workgroup_size(1) fn stores() {{ {all} }}").expect("a string");
    let source = ShaderSource { label: "suite.stores", root: ("root", text.leak()), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).expect("stores"))
}

pub(super) fn as_many_storage_textures_as_claimed_are_written(t: &mut Subject) {
    let count = t.backend.caps().max_storage_textures_per_stage.min(MOST_BUFFERS);
    let kernel = t.backend.create_compute(&ComputeDesc::new(stores(count))).expect("the caps say so");
    let textures: Vec<_> = (0..count).map(|_| t.storage_texture([1, 1], Format::R32Uint)).collect();
    let names: Vec<String> = (0..count).map(|i| format!("t{i}")).collect();
    let bindings: Vec<_> = names.iter().map(String::as_str).zip(textures.iter().map(|&id| id.into())).collect();
    t.dispatch(&kernel, &bindings, [1; 3]);
    for (texture, number) in textures.into_iter().zip(1..) {
        assert_eq!(t.texel_words(texture), [number]);
    }
    if count < MOST_BUFFERS {
        let refused = t.backend.create_compute(&ComputeDesc::new(stores(count + 1)));
        assert_refused(refused, Need::StorageTextures(count + 1));
    }
}

/// A kernel that writes the last word of a uniform of so many bytes.
fn last_of(bytes: u64) -> Arc<Shader> {
    let text = format!(
        "@group(0) @binding(0) var<uniform> all: array<vec4<u32>, {}>;
        @group(0) @binding(1) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(1) fn last_of() {{ output[0] = all[{}].w; }}",
        bytes / 16,
        bytes / 16 - 1
    );
    let source = ShaderSource { label: "suite.last_of", root: ("root", text.leak()), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).expect("a uniform"))
}

/// More than this of uniforms is not asked for.
const MOST_UNIFORM: u64 = 1 << 20;

pub(super) fn uniforms_are_as_large_as_claimed(t: &mut Subject) {
    let most = t.backend.caps().max_uniform_binding_bytes / 16 * 16;
    let bytes = most.min(MOST_UNIFORM);
    let kernel = t.backend.create_compute(&ComputeDesc::new(last_of(bytes))).expect("the caps say so");
    let words: Vec<u32> = (0..bytes as u32 / 4).collect();
    let (all, output) = (t.uniform(&words), t.zeros(1));
    t.dispatch(&kernel, &[("all", all.into()), ("output", output.into())], [1; 3]);
    assert_eq!(t.words(output, 1), [bytes as u32 / 4 - 1]);
    if most < MOST_UNIFORM {
        let refused = t.backend.create_compute(&ComputeDesc::new(last_of(most + 16)));
        assert_refused(refused, Need::UniformBindingBytes(most + 16));
        let larger = t.buffer(most as usize / 4 + 64, BufferDesc::uniform);
        t.dispatch(&kernel, &[("all", larger.into()), ("output", output.into())], [1; 3]);
        t.assert_refused("the device binds");
    }
}

pub(super) fn parts_begin_at_every_offset_that_is_claimed(t: &mut Subject) {
    let alignment = t.backend.caps().binding_alignment;
    assert!(alignment.is_power_of_two(), "{alignment}");
    let kernel = t.compute(&TURN);
    let words: Vec<u32> = (0..2048).collect();
    let (input, output) = (t.storage(&words), t.zeros(64));
    for offset in [alignment, 3 * alignment] {
        t.dispatch(&kernel, &[("input", input.range(offset, 256)), ("output", output.into())], [1; 3]);
        let list = std::mem::take(&mut t.list);
        t.backend.run(&list).expect("the caps say so");
        let expected: Vec<u32> = (0..64).rev().map(|i| i + offset as u32 / 4 + 1).collect();
        assert_eq!(t.words(output, 64), expected, "at {offset}");
    }
    if alignment > 4 {
        t.dispatch(&kernel, &[("input", input.range(alignment / 2, 256)), ("output", output.into())], [1; 3]);
        t.assert_refused("is not a multiple of");
    }
}

/// A shader that gives each of `count` targets its number.
fn numbered(count: u32) -> Arc<Shader> {
    let mut text = String::from("import package::cover::cover;\nstruct All {\n");
    (0..count).for_each(|i| writeln!(text, "@location({i}) c{i}: vec4<f32>,").expect("a string"));
    let all: Vec<String> = (0..count).map(|i| format!("vec4<f32>({}.0)", i + 1)).collect();
    write!(
        text,
        "}}
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {{ return cover(index); }}
        @fragment fn fragment() -> All {{ return All({}); }}",
        all.join(", ")
    )
    .expect("a string");
    Arc::new(Shader::new(&source("suite.numbered", text.leak()), &Specialization::new()).expect("targets"))
}

pub(super) fn as_many_targets_as_claimed_are_drawn_to(t: &mut Subject) {
    let count = t.backend.caps().max_color_targets;
    // Some devices have room for few bytes of a pixel, and none has room for fewer than two of each target.
    let desc = |count: u32| {
        (0..count).fold(RasterDesc::new(numbered(count)), |desc, _| desc.target(Format::R16F, Blend::Replace))
    };
    let pipeline = t.backend.create_raster(&desc(count)).expect("the caps say so");
    let targets: Vec<_> = (0..count).map(|_| t.texture([2, 2], Format::R16F)).collect();
    let begin = RasterPass::new("suite.targets").draw(draw(&pipeline, &[], 3));
    t.list.raster(targets.iter().fold(begin, |pass, &target| pass.color(target, Load::Clear([1.0; 4]))));
    for (target, number) in targets.into_iter().zip(1u8..) {
        let found: Vec<u16> = bytemuck::pod_collect_to_vec(&t.texels(target));
        assert_eq!(found, [half::f16::from(number).to_bits(); 4]);
    }
    assert_refused(t.backend.create_raster(&desc(count + 1)), Need::ColorTargets(count + 1));
}

/// Fragments that write, for backends that cannot.
const WRITE: ShaderSource = source(
    "suite.write",
    "import package::cover::cover;
    @group(0) @binding(0) var<storage, read_write> values: array<u32>;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
    @fragment fn fragment() -> @location(0) vec4<f32> { values[0] = 1u; return vec4<f32>(1.0); }",
);

/// What the caps lack is refused; what they have is made.
pub(super) fn kernels_are_made_or_refused_as_the_caps_say(t: &mut Subject) {
    let caps = t.backend.caps().clone();
    let hold = |have: bool, made: Result<()>, need: Need| match have {
        true => made.unwrap_or_else(|error| panic!("the caps have {need}: {error}")),
        false => assert_refused(made, need),
    };
    let shader = |source| Arc::new(Shader::new(source, &Specialization::new()).expect("a shader"));
    let compute = t.backend.create_compute(&ComputeDesc::new(shader(&ADD_ONE))).map(drop);
    hold(caps.compute, compute, Need::Compute);
    let mut raster = |source| {
        let desc = RasterDesc::new(shader(source)).target(Format::Rgba8, Blend::Replace);
        t.backend.create_raster(&desc).map(drop)
    };
    hold(caps.raster, raster(&COVER), Need::Raster);
    if caps.raster {
        hold(caps.fragment_writes, raster(&WRITE), Need::FragmentWrites);
    }
}

pub(super) fn timings_are_in_order_or_not_there(t: &mut Subject) {
    let (turner, painter) = (t.compute(&TURN), t.raster(&PAINT, &[(Format::Rgba8, Blend::Replace)], Depth::Off));
    let [a, b] = [t.zeros(1024), t.zeros(1024)];
    let target = t.texture([32, 32], Format::Rgba8);
    t.list.scope(Some("left".into()));
    t.dispatch(&turner, &[("input", a.into()), ("output", b.into())], [16, 1, 1]);
    t.list.clear(a, 0, 4096);
    t.list.scope(Some("right".into()));
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&painter, &[("colors", b.into())], 3)]);
    t.list.scope(None);
    t.dispatch(&turner, &[("input", b.into()), ("output", a.into())], [16, 1, 1]);
    t.run();
    let timings = t.backend.timings();
    if !t.backend.caps().timestamps {
        return assert!(timings.is_empty(), "the caps have no timestamps");
    }
    let labels: Vec<_> = timings.iter().map(|timing| timing.label).collect();
    assert_eq!(labels, ["suite.turn", "suite.draw", "suite.turn"]);
    let scopes: Vec<_> = timings.iter().map(|timing| timing.scope.as_deref()).collect();
    assert_eq!(scopes, [Some("left"), Some("right"), None]);
    assert_eq!(timings.iter().map(|timing| timing.bytes).collect::<Vec<_>>(), [8192; 3], "each resource once");
    assert_eq!(timings[0].begin, 0.0);
    assert!(timings.is_sorted_by(|one, other| one.begin <= other.begin), "{timings:?}");
    // 1,024 threads take a while, and all passes come after each other.
    assert!(timings.iter().all(|timing| timing.nanoseconds > 0.0 && timing.nanoseconds < 1e9), "{timings:?}");
    let ends = timings.iter().map(|timing| timing.begin + timing.nanoseconds);
    assert!(timings.iter().skip(1).zip(ends).all(|(next, end)| end <= next.begin + 1.0), "{timings:?}");
    assert!(t.backend.timings().is_empty(), "they are given once");
}

pub(super) fn caps_fit_the_library(t: &mut Subject) {
    let caps = t.backend.caps();
    assert!(!caps.adapter.is_empty(), "people want to read it");
    if caps.compute {
        assert!(caps.max_storage_buffers_per_stage >= 8 && caps.max_storage_binding_bytes >= 128 << 20, "{caps:?}");
    }
    if caps.raster {
        assert!(caps.max_texture_size >= 4096, "{caps:?}");
    }
    assert!(!caps.timestamps || caps.compute || caps.raster, "timestamps are of passes");
}
