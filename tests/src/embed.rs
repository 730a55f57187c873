//! What a backend must keep to inside of an engine's frame. [`embed_suite!`](crate::embed_suite!) makes tests of it.

use std::fmt::Display;
use std::sync::Arc;

use tressfx_core::backend::{Backend, BufferDesc, ComputeDesc, Record, Run};
use tressfx_core::error::Error;
pub use tressfx_core::error::Need;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, Load, PassList, RasterPass, Ticket};
use tressfx_core::shader::{Binding, Kernel, Shader, ShaderSource, Specialization};

use crate::suite::say_skipped;

mod in_flight;

pub use in_flight::*;

/// What an engine records into.
pub type Encoder<E> = <<E as Embed>::Backend as Record>::Encoder;

/// A small engine with the backend inside: it owns a device, an encoder, buffers and textures.
pub trait Embed {
    /// The backend.
    type Backend: Record + Run;

    /// The backend, on the engine's device.
    fn backend(&mut self) -> &mut Self::Backend;

    /// Makes a buffer of the engine's with this content, and imports it for compute passes. The engine's own commands find
    /// it as they left it, or as a list left it.
    fn buffer(&mut self, words: [u32; 4]) -> BufferId;

    /// Makes a texture of the engine's of [`TEXTURE_SIZE`] in `Rgba8`, that can be drawn to, sampled and copied, and imports
    /// it; its content is of no matter. After each recording it is to be found ready to be sampled.
    fn texture(&mut self) -> TextureId;

    /// Imports the engine's texture of an id once more, in the use that the last recording left it in. The id may be
    /// forgotten by now.
    fn import_again(&mut self, texture: TextureId) -> TextureId;

    /// An encoder of the engine's.
    fn begin(&mut self) -> Box<Encoder<Self>>;

    /// The engine's own command: makes one word of a buffer of its own zero.
    fn clear_word(&mut self, encoder: &mut Encoder<Self>, buffer: BufferId, word: u64);

    /// The engine's own commands: takes its texture from where it was promised to be found, ready to be sampled, and copies
    /// its first texel into the first word of a buffer of its own.
    fn copy_texel(&mut self, encoder: &mut Encoder<Self>, texture: TextureId, buffer: BufferId);

    /// Submits an encoder; does not wait for it.
    fn submit(&mut self, encoder: Box<Encoder<Self>>);

    /// Waits for everything that was submitted.
    fn wait(&mut self);

    /// Throws an encoder away.
    fn discard(&mut self, encoder: Box<Encoder<Self>>);
}

/// Width and height of the engine's textures: a row is as long as WebGPU asks for in a copy.
pub const TEXTURE_SIZE: [u32; 2] = [64, 2];

/// Runs a case as a test; what is not met of its needs is said.
///
/// Where no engine can be made and `TRESSFX_NO_GPU` says that this is known, the case is skipped as well.
///
/// # Panics
/// Where the promise is broken, or no engine can be made.
pub fn test<E: Embed, F: Display>(name: &str, needs: &[Need], make: impl Fn() -> Result<E, F>, case: fn(&mut E)) {
    let mut engine = match make() {
        Ok(engine) => engine,
        Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => return say_skipped(name, &error.to_string()),
        Err(error) => panic!("{error}"),
    };
    match engine.backend().caps().check("suite", needs) {
        Err(Error::Unsupported { need, .. }) => say_skipped(name, &format!("needs {need}")),
        _ => case(&mut engine),
    }
}

/// Adds one to each of the four `values`.
pub const ADD_ONE: ShaderSource = ShaderSource {
    label: "suite.add_one",
    root: (
        "root",
        "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(4) fn add_one(@builtin(local_invocation_index) i: u32) { values[i] += 1u; }",
    ),
    library: &[],
};

const LOAD: ShaderSource = ShaderSource {
    label: "suite.load",
    root: (
        "root",
        "@group(0) @binding(0) var picture: texture_2d<f32>;
        @group(0) @binding(1) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(4) fn load(@builtin(local_invocation_index) i: u32) {
            values[i] = pack4x8unorm(textureLoad(picture, vec2<i32>(i32(i), 1), 0));
        }",
    ),
    library: &[],
};

/// A kernel of a shader.
///
/// # Panics
/// If the backend makes none.
pub fn compute(backend: &mut dyn Backend, source: &ShaderSource) -> Kernel {
    let shader = Arc::new(Shader::new(source, &Specialization::new()).expect("the suite's shaders are fine"));
    backend.create_compute(&ComputeDesc::new(shader)).expect("a kernel")
}

fn own_buffer(backend: &mut dyn Backend) -> BufferId {
    backend.create_buffer(&BufferDesc::storage("suite.buffer", 16)).expect("a buffer")
}

/// Adds a pass that runs once.
fn once(list: &mut PassList, kernel: &Kernel, bindings: &[(&str, Binding)]) {
    list.compute(kernel, &kernel.bind(bindings).expect("the names of the shader"), Grid([1; 3]));
}

/// Adds a pass that adds one to each word of a buffer.
fn add_one<E: Embed>(engine: &mut E, list: &mut PassList, values: BufferId) {
    let kernel = compute(engine.backend(), &ADD_ONE);
    once(list, &kernel, &[("values", values.into())]);
}

/// A list that adds one to each word of a buffer.
fn adding<E: Embed>(engine: &mut E, values: BufferId) -> PassList {
    let mut list = PassList::new();
    add_one(engine, &mut list, values);
    list
}

fn clearing(texture: TextureId, color: [f32; 4]) -> PassList {
    let mut list = PassList::new();
    list.raster(RasterPass::new("suite.clear").color(texture, Load::Clear(color)));
    list
}

/// Has an encoder recorded, submits it and waits.
fn frame<E: Embed>(engine: &mut E, record: impl FnOnce(&mut E, &mut Encoder<E>)) {
    let mut encoder = engine.begin();
    record(engine, &mut encoder);
    engine.submit(encoder);
    engine.wait();
}

fn record<E: Embed>(engine: &mut E, encoder: &mut Encoder<E>, list: &PassList) {
    engine.backend().record(encoder, list).expect("the list is recorded");
}

fn words<E: Embed>(engine: &mut E, ticket: Ticket) -> Vec<u32> {
    let read = engine.backend().read(ticket);
    bytemuck::pod_collect_to_vec(&read.ready().expect("submitted and waited for"))
}

/// The four words of a buffer, brought back in a list of their own.
fn content<E: Embed>(engine: &mut E, buffer: BufferId) -> Vec<u32> {
    let mut list = PassList::new();
    let ticket = list.read_buffer(buffer, 0, 16);
    frame(engine, |engine, encoder| record(engine, encoder, &list));
    words(engine, ticket)
}

/// A list takes its place among the engine's own commands, and may be recorded twice.
pub fn a_list_goes_between_the_engines_own_commands<E: Embed>(engine: &mut E) {
    let values = engine.buffer([10, 20, 30, 40]);
    let list = adding(engine, values);
    frame(engine, |engine, encoder| {
        engine.clear_word(encoder, values, 0);
        record(engine, encoder, &list);
        engine.clear_word(encoder, values, 3);
        record(engine, encoder, &list);
    });
    assert_eq!(content(engine, values), [2, 22, 32, 1]);
}

/// Lists in one encoder see each other's results, and uploads of one do not reach the other.
pub fn two_lists_share_an_encoder<E: Embed>(engine: &mut E) {
    let values = own_buffer(engine.backend());
    let (mut first, mut second) = (PassList::new(), PassList::new());
    first.upload(values, 0, &[1u32, 2, 3, 4]);
    add_one(engine, &mut first, values);
    let early = first.read_buffer(values, 0, 16);
    second.upload(values, 4, &[7u32]);
    add_one(engine, &mut second, values);
    let late = second.read_buffer(values, 0, 16);
    frame(engine, |engine, encoder| {
        record(engine, encoder, &first);
        record(engine, encoder, &second);
    });
    assert_eq!(words(engine, early), [2, 3, 4, 5]);
    assert_eq!(words(engine, late), [3, 8, 5, 6]);
}

/// What is recorded and thrown away never happens, and harms nothing that follows.
pub fn recording_alone_runs_nothing<E: Embed>(engine: &mut E) {
    let values = own_buffer(engine.backend());
    // Once for real, so that the buffer is more than an id.
    assert_eq!(content(engine, values), [0; 4]);
    let list = adding(engine, values);
    let mut encoder = engine.begin();
    record(engine, &mut encoder, &list);
    engine.discard(encoder);
    assert_eq!(content(engine, values), [0; 4]);
    frame(engine, |engine, encoder| record(engine, encoder, &list));
    assert_eq!(content(engine, values), [1; 4]);
}

/// Many frames, each in an encoder of its own.
pub fn frames_follow_each_other<E: Embed>(engine: &mut E) {
    let values = engine.buffer([0, 1, 2, 3]);
    let list = adding(engine, values);
    for _ in 0..100 {
        frame(engine, |engine, encoder| record(engine, encoder, &list));
    }
    assert_eq!(content(engine, values), [100, 101, 102, 103]);
}

/// The library runs lists by itself between the engine's frames.
pub fn runs_and_frames_take_turns<E: Embed>(engine: &mut E) {
    let values = engine.buffer([0; 4]);
    let list = adding(engine, values);
    for _ in 0..3 {
        frame(engine, |engine, encoder| record(engine, encoder, &list));
        engine.backend().run(&list).expect("the list runs");
    }
    assert_eq!(content(engine, values), [6; 4]);
}

/// The engine finds its texture, drawn to, as it was promised to find it.
pub fn an_imported_texture_is_found_as_promised<E: Embed>(engine: &mut E) {
    let (texture, texel) = (engine.texture(), engine.buffer([0; 4]));
    for (color, expected) in [([1.0, 0.0, 0.2, 1.0], 0xff33_00ff), ([0.0, 1.0, 0.0, 0.0], 0x0000_ff00)] {
        frame(engine, |engine, encoder| {
            record(engine, encoder, &clearing(texture, color));
            engine.copy_texel(encoder, texture, texel);
        });
        assert_eq!(content(engine, texel), [expected, 0, 0, 0]);
    }
}

/// What one list draws into the engine's texture, another loads, after the engine used it.
pub fn an_imported_texture_keeps_its_content<E: Embed>(engine: &mut E) {
    let (texture, texel) = (engine.texture(), engine.buffer([0; 4]));
    let values = own_buffer(engine.backend());
    let kernel = compute(engine.backend(), &LOAD);
    let mut load = PassList::new();
    once(&mut load, &kernel, &[("picture", texture.into()), ("values", values.into())]);
    frame(engine, |engine, encoder| {
        record(engine, encoder, &clearing(texture, [0.2, 0.4, 0.6, 0.8]));
        engine.copy_texel(encoder, texture, texel);
        record(engine, encoder, &load);
    });
    assert_eq!(content(engine, values), [0xcc99_6633; 4]);
    assert_eq!(content(engine, texel)[0], 0xcc99_6633);
}

/// Forgetting an import leaves the engine what is the engine's.
pub fn an_imported_texture_outlives_its_id<E: Embed>(engine: &mut E) {
    let texture = engine.texture();
    frame(engine, |engine, encoder| record(engine, encoder, &clearing(texture, [1.0, 0.0, 0.0, 1.0])));
    engine.backend().destroy(texture.into());
    let again = engine.import_again(texture);
    assert_ne!(texture, again);
    let mut list = PassList::new();
    let ticket = list.read_texture(again);
    frame(engine, |engine, encoder| record(engine, encoder, &list));
    assert_eq!(words(engine, ticket), vec![0xff00_00ff; (TEXTURE_SIZE[0] * TEXTURE_SIZE[1]) as usize]);
}

/// What the engine made does not count as the backend's.
pub fn imports_do_not_count_as_memory<E: Embed>(engine: &mut E) {
    let before = engine.backend().memory();
    let (buffer, texture) = (engine.buffer([0; 4]), engine.texture());
    assert_eq!(engine.backend().memory(), before);
    engine.backend().destroy(buffer.into());
    engine.backend().destroy(texture.into());
    assert_eq!(engine.backend().memory(), before);
}

/// A list recorded is timed as one that is run.
pub fn recorded_lists_are_timed<E: Embed>(engine: &mut E) {
    let values = engine.buffer([0; 4]);
    let mut list = adding(engine, values);
    add_one(engine, &mut list, values);
    frame(engine, |engine, encoder| record(engine, encoder, &list));
    let labels: Vec<_> = engine.backend().timings().iter().map(|timing| timing.label).collect();
    let expected = if engine.backend().caps().timestamps { 2 } else { 0 };
    assert_eq!(labels, vec!["suite.add_one"; expected]);
}

/// One `#[test]` for each promise of a backend inside of an engine.
///
/// Takes a closure without arguments that makes a fresh engine: `Result<impl Embed, impl Display>`.
#[macro_export]
macro_rules! embed_suite {
    ($make:expr) => {
        $crate::embed_suite! { $make;
            a_list_goes_between_the_engines_own_commands: [Compute ReadBack];
            two_lists_share_an_encoder: [Compute ReadBack];
            recording_alone_runs_nothing: [Compute ReadBack];
            frames_follow_each_other: [Compute ReadBack];
            runs_and_frames_take_turns: [Compute ReadBack];
            an_imported_texture_is_found_as_promised: [Raster ReadBack];
            an_imported_texture_keeps_its_content: [Compute Raster ReadBack];
            an_imported_texture_outlives_its_id: [Raster ReadBack];
            imports_do_not_count_as_memory: [];
            recorded_lists_are_timed: [Compute];
            nothing_is_there_before_the_submit: [Compute ReadBack];
            times_stay_when_a_list_without_passes_follows: [Compute ReadBack];
            what_is_recorded_outlives_its_ids: [Compute Raster ReadBack];
            many_lists_are_in_flight: [Compute ReadBack];
            textures_survive_what_is_thrown_away: [Raster ReadBack];
            new_resources_survive_what_is_thrown_away: [Compute Raster ReadBack];
            what_is_destroyed_may_be_thrown_away: [Compute Raster ReadBack];
            a_list_outlives_what_is_destroyed_before_it_is_recorded: [Compute ReadBack];
            a_read_back_is_given_once_and_can_be_given_up: [Compute ReadBack];
            parameters_change_with_frames_in_flight: [Compute ReadBack];
        }
    };
    ($make:expr; $($case:ident: [$($need:ident)*];)*) => {$(
        #[test]
        #[allow(clippy::redundant_closure, reason = "a closure is what is asked for, whatever it calls")]
        fn $case() {
            let needs = &[$($crate::embed::Need::$need),*];
            $crate::embed::test(stringify!($case), needs, $make, $crate::embed::$case);
        }
    )*};
}
