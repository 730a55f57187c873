//! Honest caps: what is claimed works, what is not claimed is refused with the need, and what is measured makes sense.

use std::fmt::Write;
use std::sync::Arc;

use tressfx_core::backend::{Blend, BufferDesc, BufferUse, ComputeDesc, Depth, Format, Need, RasterDesc, TextureDesc};
use tressfx_core::error::{Error, Result};
use tressfx_core::pass::Load;
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
    let kernel = t.backend.create_compute(&ComputeDesc { shader: sum_of(count) }).expect("the caps say so");
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
    let desc = BufferDesc { label: "suite.largest", bytes, usage: BufferUse::Storage };
    let largest = t.backend.create_buffer(&desc).expect("the caps say so");
    t.dispatch(&kernel, &[("values", largest.into())], [1; 3]);
    let [first, last] = [0, bytes - 4].map(|offset| t.list.read_buffer(largest, offset, 4));
    assert_eq!((t.read_words(first), t.read_words(last)), (vec![7], vec![(bytes / 4) as u32]));
    let end = t.list.read_buffer(largest, bytes - 16, 12);
    assert_eq!(t.read_words(end), [0; 3]);
}

pub(super) fn the_longest_textures_are_cleared_to_their_ends(t: &mut Subject) {
    let edge = t.backend.caps().max_texture_edge.min(1 << 16);
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
        let desc = BufferDesc { label: "suite.huge", bytes, usage: BufferUse::Storage };
        assert_refused(t.backend.create_buffer(&desc), Need::StorageBindingBytes(bytes));
    }
    assert_eq!(t.backend.memory().bytes, 0, "what was refused takes nothing");
}

pub(super) fn textures_beyond_the_caps_are_refused(t: &mut Subject) {
    let edge = t.backend.caps().max_texture_edge + 1;
    for size in [[edge, 1], [1, edge]] {
        let desc = TextureDesc { label: "suite.long", size, format: Format::Rgba8 };
        assert_refused(t.backend.create_texture(&desc), Need::TextureEdge(edge));
    }
    assert_eq!(t.backend.memory().bytes, 0, "what was refused takes nothing");
}

pub(super) fn bindings_beyond_the_caps_are_refused(t: &mut Subject) {
    let count = t.backend.caps().max_storage_buffers_per_stage;
    if count < MOST_BUFFERS {
        let shader = sum_of(count + 1);
        assert_refused(t.backend.create_compute(&ComputeDesc { shader }), Need::StorageBuffers(count + 1));
    }
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
    let compute = t.backend.create_compute(&ComputeDesc { shader: shader(&ADD_ONE) }).map(drop);
    hold(caps.compute, compute, Need::Compute);
    let mut raster = |source| {
        let targets = vec![(Format::Rgba8, Blend::Replace)];
        t.backend.create_raster(&RasterDesc { shader: shader(source), targets, depth: Depth::Off }).map(drop)
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
    t.dispatch(&turner, &[("input", a.into()), ("output", b.into())], [16, 1, 1]);
    t.list.clear(a, 0, 4096);
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&painter, &[("colors", b.into())], 3)]);
    t.dispatch(&turner, &[("input", b.into()), ("output", a.into())], [16, 1, 1]);
    t.run();
    let timings = t.backend.timings();
    if !t.backend.caps().timestamps {
        return assert!(timings.is_empty(), "the caps have no timestamps");
    }
    let labels: Vec<_> = timings.iter().map(|timing| timing.label).collect();
    assert_eq!(labels, ["suite.turn", "suite.draw", "suite.turn"]);
    assert_eq!(timings.iter().map(|timing| timing.bytes).collect::<Vec<_>>(), [8192; 3], "each resource once");
    assert_eq!(timings[0].begin, 0.0);
    assert!(timings.is_sorted_by(|one, other| one.begin <= other.begin), "{timings:?}");
    assert!(timings.iter().all(|timing| timing.nanoseconds >= 0.0 && timing.nanoseconds < 1e9), "{timings:?}");
}

pub(super) fn caps_fit_the_library(t: &mut Subject) {
    let caps = t.backend.caps();
    assert!(!caps.adapter.is_empty(), "people want to read it");
    if caps.compute {
        assert!(caps.max_storage_buffers_per_stage >= 8 && caps.max_storage_binding_bytes >= 128 << 20, "{caps:?}");
    }
    if caps.raster {
        assert!(caps.max_texture_edge >= 4096, "{caps:?}");
    }
    assert!(!caps.timestamps || caps.compute || caps.raster, "timestamps are of passes");
}
