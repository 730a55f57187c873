//! Mistakes of the program that a backend must notice: ids that outlived what they named, and lists that break rules.

use tressfx_core::backend::{Blend, BufferUse, Depth, Format};
use tressfx_core::pass::Load;

use super::kernels::{ADD_ONE, COVER};
use super::subject::{Subject, draw};

pub(super) fn a_destroyed_buffer_is_noticed(t: &mut Subject) {
    let [gone, there] = [t.zeros(4), t.zeros(4)];
    t.backend.destroy(gone.into());
    t.assert_noticed("upload", |t| {
        t.list.upload(gone, 0, &[1u32]);
        t.run();
    });
    t.assert_noticed("clear", |t| {
        t.list.clear(gone, 0, 4);
        t.run();
    });
    t.assert_noticed("copy from", |t| {
        t.list.copy(gone, there, 4);
        t.run();
    });
    t.assert_noticed("copy to", |t| {
        t.list.copy(there, gone, 4);
        t.run();
    });
    t.assert_noticed("read", |t| {
        t.list.read_buffer(gone, 0, 4);
        t.run();
    });
}

pub(super) fn a_destroyed_buffer_is_noticed_in_a_pass(t: &mut Subject) {
    let kernel = t.compute(&ADD_ONE);
    let [gone, there] = [t.zeros(64), t.zeros(64)];
    let counts = t.buffer(3, BufferUse::Indirect);
    t.dispatch(&kernel, &[("values", gone.into())], [1; 3]);
    t.run();
    t.backend.destroy(gone.into());
    t.backend.destroy(counts.into());
    t.assert_noticed("binding", |t| {
        t.dispatch(&kernel, &[("values", gone.into())], [1; 3]);
        t.run();
    });
    t.assert_noticed("counts", |t| {
        t.list.compute_indirect(&kernel, &kernel.bind(&[("values", there.into())]), counts, 0);
        t.run();
    });
}

pub(super) fn a_destroyed_texture_is_noticed(t: &mut Subject) {
    let gone = t.texture([4, 4], Format::Rgba8);
    t.backend.destroy(gone.into());
    t.assert_noticed("target", |t| {
        t.draw(gone, Load::Clear([0.0; 4]), Vec::new());
        t.run();
    });
    t.assert_noticed("read", |t| {
        t.list.read_texture(gone);
        t.run();
    });
}

pub(super) fn a_destroyed_compute_pipeline_is_noticed(t: &mut Subject) {
    let kernel = t.compute(&ADD_ONE);
    let values = t.zeros(64);
    t.dispatch(&kernel, &[("values", values.into())], [1; 3]);
    t.run();
    t.backend.destroy_pipeline(kernel.pipeline);
    t.assert_noticed("a pass of it", |t| {
        t.dispatch(&kernel, &[("values", values.into())], [1; 3]);
        t.run();
    });
}

pub(super) fn a_destroyed_raster_pipeline_is_noticed(t: &mut Subject) {
    let kernel = t.raster(&COVER, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let target = t.texture([4, 4], Format::Rgba8);
    t.backend.destroy_pipeline(kernel.pipeline);
    t.assert_noticed("a draw of it", |t| {
        t.draw(target, Load::Clear([0.0; 4]), vec![draw(&kernel, &[], 3)]);
        t.run();
    });
}

pub(super) fn an_id_is_not_confused_with_its_successor(t: &mut Subject) {
    let first = t.zeros(4);
    t.backend.destroy(first.into());
    let second = t.zeros(4);
    assert_ne!(first, second);
    t.backend.destroy(first.into());
    t.list.upload(second, 0, &[1u32; 4]);
    t.run();
    t.assert_noticed("the first", |t| {
        t.list.upload(first, 0, &[2u32; 4]);
        t.run();
    });
}

pub(super) fn a_pipeline_is_not_confused_with_its_successor(t: &mut Subject) {
    let first = t.compute(&ADD_ONE);
    t.backend.destroy_pipeline(first.pipeline);
    let second = t.compute(&ADD_ONE);
    assert_ne!(first.pipeline, second.pipeline);
    let values = t.zeros(64);
    t.assert_noticed("the first", |t| {
        t.dispatch(&first, &[("values", values.into())], [1; 3]);
        t.run();
    });
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

/// Debug builds only: the rules cost time.
pub(super) fn a_list_that_breaks_a_rule_is_refused(t: &mut Subject) {
    let values = t.zeros(8);
    if cfg!(debug_assertions) {
        t.assert_noticed("a copy onto itself", |t| {
            t.list.copy(values, values, 4);
            t.run();
        });
        t.assert_noticed("an odd size", |t| {
            t.list.clear(values, 0, 6);
            t.run();
        });
    }
}
