//! Ids that outlived what they named: lists that are begun later are refused, and those that were begun before still run.

use tressfx_core::backend::{Blend, BufferDesc, Depth, Format};
use tressfx_core::pass::{Load, PassList};

use super::kernels::{ADD_ONE, COVER};
use super::subject::{Subject, draw};

/// What is said of an id that names nothing.
const NO_BUFFER: &str = "no buffer of this backend";
const NO_TEXTURE: &str = "no texture of this backend";

pub(super) fn a_destroyed_buffer_is_noticed(t: &mut Subject) {
    let [gone, there] = [t.zeros(4), t.zeros(4)];
    t.backend.destroy(gone.into());
    t.list.upload(gone, 0, &[1u32]);
    t.assert_refused(NO_BUFFER);
    t.list.clear(gone, 0, 4);
    t.assert_refused(NO_BUFFER);
    t.list.copy(gone, there, 4);
    t.assert_refused(NO_BUFFER);
    t.list.copy(there, gone, 4);
    t.assert_refused(NO_BUFFER);
}

pub(super) fn a_destroyed_buffer_is_not_read_back(t: &mut Subject) {
    let gone = t.zeros(4);
    t.backend.destroy(gone.into());
    t.list.read_buffer(gone, 0, 4);
    t.assert_refused(NO_BUFFER);
}

pub(super) fn a_destroyed_buffer_is_noticed_in_a_pass(t: &mut Subject) {
    let kernel = t.compute(&ADD_ONE);
    let [gone, there] = [t.zeros(64), t.zeros(64)];
    let counts = t.buffer(3, BufferDesc::indirect);
    t.dispatch(&kernel, &[("values", gone.into())], [1; 3]);
    t.run();
    t.backend.destroy(gone.into());
    t.backend.destroy(counts.into());
    t.dispatch(&kernel, &[("values", gone.into())], [1; 3]);
    t.assert_refused(NO_BUFFER);
    t.indirect(&kernel, &[("values", there.into())], counts, 0);
    t.assert_refused(NO_BUFFER);
}

pub(super) fn a_destroyed_texture_is_noticed(t: &mut Subject) {
    let gone = t.texture([4, 4], Format::Rgba8);
    t.backend.destroy(gone.into());
    t.draw(gone, Load::Clear([0.0; 4]), Vec::new());
    t.assert_refused(NO_TEXTURE);
}

pub(super) fn a_destroyed_compute_pipeline_is_noticed(t: &mut Subject) {
    let kernel = t.compute(&ADD_ONE);
    let values = t.zeros(64);
    t.dispatch(&kernel, &[("values", values.into())], [1; 3]);
    t.run();
    t.backend.destroy_pipeline(kernel.pipeline);
    t.dispatch(&kernel, &[("values", values.into())], [1; 3]);
    t.assert_refused("no compute pipeline of this backend");
}

pub(super) fn a_destroyed_raster_pipeline_is_noticed(t: &mut Subject) {
    let pipeline = t.raster(&COVER, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([4, 4], Format::Rgba8);
    t.backend.destroy_pipeline(pipeline.pipeline);
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&pipeline, &[], 3)]);
    t.assert_refused("no raster pipeline of this backend");
}

pub(super) fn an_id_is_not_confused_with_its_successor(t: &mut Subject) {
    let first = t.zeros(4);
    t.backend.destroy(first.into());
    let second = t.zeros(4);
    assert_ne!(first, second);
    t.backend.destroy(first.into());
    t.list.upload(second, 0, &[1u32; 4]);
    t.run();
    t.list.upload(first, 0, &[2u32; 4]);
    t.assert_refused(NO_BUFFER);
}

pub(super) fn a_pipeline_is_not_confused_with_its_successor(t: &mut Subject) {
    let first = t.compute(&ADD_ONE);
    t.backend.destroy_pipeline(first.pipeline);
    let second = t.compute(&ADD_ONE);
    assert_ne!(first.pipeline, second.pipeline);
    let values = t.zeros(64);
    t.dispatch(&first, &[("values", values.into())], [1; 3]);
    t.assert_refused("no compute pipeline of this backend");
}

pub(super) fn a_successor_in_the_same_place_is_bound(t: &mut Subject) {
    let kernel = t.compute(&ADD_ONE);
    for round in 0..3u32 {
        let values = t.storage(&[10 * round; 64]);
        t.dispatch(&kernel, &[("values", values.into())], [1; 3]);
        assert_eq!(t.words(values, 64), [10 * round + 1; 64]);
        t.backend.destroy(values.into());
    }
}

pub(super) fn ids_of_another_backend_are_refused(t: &mut Subject) {
    // As many resources on both: their ids differ in nothing but whose they are.
    let mine = t.zeros(4);
    let theirs = t.another().create_buffer(&BufferDesc::storage("suite.buffer", 16)).expect("a buffer");
    assert_ne!(mine, theirs);
    t.list.clear(theirs, 0, 4);
    t.assert_refused(NO_BUFFER);
    let before = t.backend.memory();
    t.backend.destroy(theirs.into());
    assert_eq!(t.backend.memory(), before);
    t.list.clear(mine, 0, 4);
    t.run();
}

pub(super) fn what_is_destroyed_lives_on_for_older_lists(t: &mut Subject) {
    let values = t.storage(&[1u32, 2, 3, 4]);
    let copy = t.zeros(4);
    t.run();
    t.list.copy(values, copy, 16);
    let older = std::mem::take(&mut t.list);
    t.backend.destroy(values.into());
    t.list.clear(values, 0, 16);
    t.assert_refused(NO_BUFFER);
    // What is made meanwhile must not get its memory.
    let other = t.storage(&[9u32; 4]);
    t.run();
    for _ in 0..2 {
        t.backend.run(&older).expect("it was begun before");
        assert_eq!(t.words(copy, 4), [1, 2, 3, 4]);
        t.list.clear(copy, 0, 16);
        t.run();
    }
    drop(older);
    assert_eq!(t.words(other, 4), [9; 4]);
    t.list.clear(values, 0, 16);
    t.assert_refused(NO_BUFFER);
}

pub(super) fn a_destroyed_pipeline_lives_on_for_older_lists(t: &mut Subject) {
    let kernel = t.compute(&ADD_ONE);
    let values = t.storage(&[7u32; 64]);
    t.dispatch(&kernel, &[("values", values.into())], [1; 3]);
    t.backend.destroy_pipeline(kernel.pipeline);
    let other = t.compute(&ADD_ONE);
    assert_ne!(other.pipeline, kernel.pipeline);
    t.run();
    assert_eq!(t.words(values, 64), [8; 64]);
    t.dispatch(&kernel, &[("values", values.into())], [1; 3]);
    t.assert_refused("no compute pipeline of this backend");
}

pub(super) fn an_appended_list_keeps_what_it_named_alive(t: &mut Subject) {
    let values = t.storage(&[3u32; 4]);
    let copy = t.zeros(4);
    t.run();
    t.list.copy(values, copy, 16);
    let older = std::mem::take(&mut t.list);
    t.backend.destroy(values.into());
    t.list.upload(copy, 0, &[8u32; 4]);
    t.list.append(&older);
    drop(older);
    assert_eq!(t.words(copy, 4), [3; 4]);
}

pub(super) fn a_list_that_was_cleared_is_as_new(t: &mut Subject) {
    let mut list = PassList::new();
    let gone = t.zeros(4);
    list.clear(gone, 0, 4);
    t.backend.destroy(gone.into());
    list.clear_commands();
    list.clear(gone, 0, 4);
    t.list = list;
    t.assert_refused(NO_BUFFER);
}
