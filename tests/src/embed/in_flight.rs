//! What was recorded and has not run yet, and what never runs.

use tressfx_core::backend::{Backend, BufferDesc, Format, ReadBack, Record, TextureDesc};
use tressfx_core::error::Error;
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Grid, PassList, Ticket};
use tressfx_core::shader::ShaderSource;

use super::{ADD_ONE, Embed, TEXTURE_SIZE, add_one, adding, clearing, compute, content, frame, once, own_buffer};
use super::{record, words};

const RED: [f32; 4] = [1.0, 0.0, 0.0, 1.0];
const RED_TEXEL: u32 = 0xff00_00ff;
const GREEN: [f32; 4] = [0.0, 1.0, 0.0, 1.0];

fn own_texture(backend: &mut dyn Backend) -> TextureId {
    backend.create_texture(&TextureDesc::new("suite.texture", TEXTURE_SIZE, Format::Rgba8)).expect("a texture")
}

/// Each texel of a texture, brought back in a list of its own.
fn texels<E: Embed>(engine: &mut E, texture: TextureId) -> Vec<u32> {
    let mut list = PassList::new();
    let ticket = list.read_texture(texture);
    frame(engine, |engine, encoder| record(engine, encoder, &list));
    words(engine, ticket)
}

fn filled(texel: u32) -> Vec<u32> {
    vec![texel; (TEXTURE_SIZE[0] * TEXTURE_SIZE[1]) as usize]
}

/// Records lists into an encoder that is thrown away.
fn throw_away<E: Embed>(engine: &mut E, lists: &[&PassList]) {
    let mut encoder = engine.begin();
    lists.iter().for_each(|list| record(engine, &mut encoder, list));
    engine.discard(encoder);
}

/// What is asked for too early is not there, and that it was asked for harms nothing.
pub fn nothing_is_there_before_the_submit<E: Embed>(engine: &mut E) {
    let values = own_buffer(engine.backend());
    let mut list = adding(engine, values);
    let early = list.read_buffer(values, 0, 16);
    let mut next = adding(engine, values);
    let late = next.read_buffer(values, 0, 16);
    let mut encoder = engine.begin();
    for list in [&list, &next] {
        record(engine, &mut encoder, list);
        assert_eq!(engine.backend().timings(), []);
        assert!([early, late].iter().all(|&ticket| engine.backend().read(ticket).ready().is_none()));
    }
    engine.submit(encoder);
    engine.wait();
    let timed = engine.backend().caps().timestamps;
    assert_eq!(engine.backend().timings().len(), usize::from(timed));
    assert_eq!([early, late].map(|ticket| words(engine, ticket)), [[1; 4], [2; 4]]);
}

/// A list that only copies has no times, and those of the list before it can still be asked for.
pub fn times_stay_when_a_list_without_passes_follows<E: Embed>(engine: &mut E) {
    let values = own_buffer(engine.backend());
    let list = adding(engine, values);
    frame(engine, |engine, encoder| record(engine, encoder, &list));
    assert_eq!(content(engine, values), [1; 4]);
    let expected = if engine.backend().caps().timestamps { 1 } else { 0 };
    assert_eq!(engine.backend().timings().len(), expected);
    assert_eq!(engine.backend().timings(), [], "they are given once");
}

/// A list recorded keeps what it needs, whatever is destroyed before it runs.
pub fn what_is_recorded_outlives_its_ids<E: Embed>(engine: &mut E) {
    let (values, texture) = (own_buffer(engine.backend()), own_texture(engine.backend()));
    let kernel = compute(engine.backend(), &ADD_ONE);
    let mut list = clearing(texture, RED);
    list.upload(values, 0, &[5u32, 6, 7, 8]);
    once(&mut list, &kernel, &[("values", values.into())]);
    let (numbers, picture) = (list.read_buffer(values, 0, 16), list.read_texture(texture));
    let mut encoder = engine.begin();
    record(engine, &mut encoder, &list);
    engine.backend().destroy(values.into());
    engine.backend().destroy(texture.into());
    engine.backend().destroy_pipeline(kernel.pipeline);
    assert_eq!(engine.backend().memory().bytes, 0, "what is destroyed does not count any more");
    // Whatever takes the memory now must not take it from the list.
    let next = own_buffer(engine.backend());
    engine.submit(encoder);
    assert_eq!(content(engine, next), [0; 4]);
    assert_eq!(words(engine, numbers), [6, 7, 8, 9]);
    assert_eq!(words(engine, picture), filled(RED_TEXEL));
}

/// Lists submitted one after the other without waiting, each with uploads of its own.
pub fn many_lists_are_in_flight<E: Embed>(engine: &mut E) {
    const LISTS: u32 = 50;
    let values = engine.buffer([0; 4]);
    let kernel = compute(engine.backend(), &ADD_ONE);
    let mut tickets = Vec::<Ticket>::new();
    for i in 0..LISTS {
        let mut list = PassList::new();
        list.upload(values, 0, &[i, 2 * i, 3 * i, 4 * i]);
        once(&mut list, &kernel, &[("values", values.into())]);
        tickets.push(list.read_buffer(values, 0, 16));
        let mut encoder = engine.begin();
        record(engine, &mut encoder, &list);
        engine.submit(encoder);
    }
    engine.wait();
    for (i, ticket) in (0..).zip(tickets) {
        assert_eq!(words(engine, ticket), [i + 1, 2 * i + 1, 3 * i + 1, 4 * i + 1]);
    }
}

/// A texture is as it was before a list that drew to it and read it was thrown away.
pub fn textures_survive_what_is_thrown_away<E: Embed>(engine: &mut E) {
    let (own, imported) = (own_texture(engine.backend()), engine.texture());
    for texture in [own, imported] {
        frame(engine, |engine, encoder| record(engine, encoder, &clearing(texture, RED)));
        let mut reading = clearing(texture, GREEN);
        let ticket = reading.read_texture(texture);
        throw_away(engine, &[&clearing(texture, GREEN), &reading]);
        assert!(engine.backend().read(ticket).ready().is_none(), "it never ran");
        assert_eq!(texels(engine, texture), filled(RED_TEXEL));
    }
}

/// What a list that was thrown away would have used for the first time begins with zeros all the same.
pub fn new_resources_survive_what_is_thrown_away<E: Embed>(engine: &mut E) {
    let (values, texture) = (own_buffer(engine.backend()), own_texture(engine.backend()));
    let adding = adding(engine, values);
    throw_away(engine, &[&adding, &clearing(texture, RED)]);
    assert_eq!(content(engine, values), [0; 4]);
    assert_eq!(texels(engine, texture), filled(0));
}

/// What was made, recorded and destroyed can be thrown away.
pub fn what_is_destroyed_may_be_thrown_away<E: Embed>(engine: &mut E) {
    let (values, texture) = (own_buffer(engine.backend()), own_texture(engine.backend()));
    let list = adding(engine, values);
    let mut encoder = engine.begin();
    record(engine, &mut encoder, &list);
    record(engine, &mut encoder, &clearing(texture, RED));
    engine.backend().destroy(values.into());
    engine.backend().destroy(texture.into());
    engine.discard(encoder);
    let next = own_buffer(engine.backend());
    assert_eq!(content(engine, next), [0; 4]);
}

/// A list that was begun before something was destroyed can be recorded afterwards; one that is begun later is refused.
pub fn a_list_outlives_what_is_destroyed_before_it_is_recorded<E: Embed>(engine: &mut E) {
    let values = own_buffer(engine.backend());
    let mut before = PassList::new();
    before.upload(values, 0, &[1u32, 2, 3, 4]);
    add_one(engine, &mut before, values);
    let ticket = before.read_buffer(values, 0, 16);
    engine.backend().destroy(values.into());
    let mut after = PassList::new();
    after.clear(values, 0, 16);
    frame(engine, |engine, encoder| {
        let refused = engine.backend().record(encoder, &after).expect_err("it names what is no more");
        assert!(matches!(refused, Error::Rule { .. }), "{refused}");
        record(engine, encoder, &before);
    });
    assert_eq!(words(engine, ticket), [2, 3, 4, 5]);
}

/// Unknown before it is recorded and after it was given; given up, it is unknown as well.
pub fn a_read_back_is_given_once_and_can_be_given_up<E: Embed>(engine: &mut E) {
    let values = own_buffer(engine.backend());
    let mut list = adding(engine, values);
    let [kept, dropped] = [0, 8].map(|offset| list.read_buffer(values, offset, 8));
    assert_eq!(engine.backend().read(kept), ReadBack::Unknown);
    frame(engine, |engine, encoder| {
        record(engine, encoder, &list);
        engine.backend().cancel_read(dropped);
    });
    assert_eq!(words(engine, kept), [1, 1]);
    assert_eq!([kept, dropped].map(|ticket| engine.backend().read(ticket)), [ReadBack::Unknown, ReadBack::Unknown]);
}

const SCALE: ShaderSource = ShaderSource {
    label: "suite.scale",
    root: (
        "root",
        "@group(0) @binding(0) var<uniform> factor: vec4<u32>;
        @group(0) @binding(1) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(4) fn scale(@builtin(local_invocation_index) i: u32) { values[i] = factor.x * (i + 1u); }",
    ),
    library: &[],
};

/// Each frame uploads its own parameters and sees those alone, also where nobody waits for the frame before, and where frames
/// between them are thrown away.
pub fn parameters_change_with_frames_in_flight<E: Embed>(engine: &mut E) {
    let values = own_buffer(engine.backend());
    let factor = engine.backend().create_buffer(&BufferDesc::uniform("suite.factor", 16)).expect("a buffer");
    let kernel = compute(engine.backend(), &SCALE);
    let bindings = kernel.bind(&[("factor", factor.into()), ("values", values.into())]).expect("its names");
    let mut tickets = Vec::new();
    for frame in 1..=40u32 {
        let mut list = PassList::new();
        list.upload(factor, 0, &[frame, 0, 0, 0]);
        list.compute(&kernel, &bindings, Grid([1; 3]));
        let ticket = list.read_buffer(values, 0, 16);
        let mut encoder = engine.begin();
        record(engine, &mut encoder, &list);
        if frame % 7 == 0 {
            engine.discard(encoder);
            assert!(engine.backend().read(ticket).ready().is_none());
        } else {
            engine.submit(encoder);
            tickets.push((frame, ticket));
        }
    }
    engine.wait();
    for (frame, ticket) in tickets {
        assert_eq!(words(engine, ticket), [frame, 2 * frame, 3 * frame, 4 * frame]);
    }
}
