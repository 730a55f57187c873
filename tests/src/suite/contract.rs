//! Buffers: what goes in, what is moved, what comes back, and in which order.

use tressfx_core::backend::{BufferDesc, Format, Memory, Owner, ReadBack, TextureDesc};
use tressfx_core::error::Error;
use tressfx_core::pass::{Command, PassList};

use super::subject::{Describe, Subject, noise};

/// Buffers of every kind.
const KINDS: [Describe; 3] = [BufferDesc::storage, BufferDesc::uniform, BufferDesc::indirect];

pub(super) fn uploads_take_effect_in_the_order_of_the_list(t: &mut Subject) {
    let values = t.zeros(4);
    let [early, late] = [t.zeros(4), t.zeros(4)];
    t.list.upload(values, 0, &[1u32, 2, 3, 4]);
    t.list.copy(values, early, 16);
    t.list.upload(values, 4, &[7u32, 8]);
    t.list.copy(values, late, 16);
    t.list.upload(values, 0, &[9u32; 4]);
    assert_eq!(t.words(early, 4), [1, 2, 3, 4], "before the second upload");
    assert_eq!(t.words(late, 4), [1, 7, 8, 4], "after it, before the third");
    assert_eq!(t.words(values, 4), [9; 4]);
}

pub(super) fn an_upload_goes_where_its_offset_says(t: &mut Subject) {
    let values = t.storage(&[1u32, 2, 3, 4, 5]);
    t.list.upload(values, 12, &[40u32]);
    t.list.upload(values, 4, &[20u32, 30]);
    t.list.upload::<u32>(values, 0, &[]);
    assert_eq!(t.words(values, 5), [1, 20, 30, 40, 5]);
}

pub(super) fn uploads_take_any_bytes(t: &mut Subject) {
    let words = noise(50_000, 1);
    let (one, other) = (t.storage(&words[..30_001]), t.storage(&words[30_001..]));
    assert_eq!(t.words(other, 19_999), words[30_001..]);
    assert_eq!(t.words(one, 30_001), words[..30_001]);
}

pub(super) fn a_whole_buffer_is_cleared(t: &mut Subject) {
    let values = t.storage(&noise(1000, 2));
    t.list.clear(values, 0, 4000);
    assert_eq!(t.words(values, 1000), [0; 1000]);
}

pub(super) fn a_part_of_a_buffer_is_cleared_and_the_rest_stays(t: &mut Subject) {
    let values = t.storage(&[1u32, 2, 3, 4, 5, 6]);
    t.list.clear(values, 4, 8);
    t.list.clear(values, 20, 4);
    assert_eq!(t.words(values, 6), [1, 0, 0, 4, 5, 0]);
}

pub(super) fn clears_and_uploads_take_turns(t: &mut Subject) {
    let values = t.storage(&[1u32, 2, 3, 4]);
    t.list.clear(values, 0, 8);
    t.list.upload(values, 4, &[5u32, 6]);
    t.list.clear(values, 8, 4);
    assert_eq!(t.words(values, 4), [0, 5, 0, 4]);
}

pub(super) fn copies_begin_and_end_at_their_offsets(t: &mut Subject) {
    let src = t.storage(&[1u32, 2, 3, 4, 5]);
    let dst = t.storage(&[10u32, 20, 30, 40, 50]);
    t.list.push(Command::Copy { src, src_offset: 8, dst, dst_offset: 4, bytes: 12 });
    assert_eq!(t.words(dst, 5), [10, 3, 4, 5, 50]);
    assert_eq!(t.words(src, 5), [1, 2, 3, 4, 5], "a copy leaves its source");
}

pub(super) fn copies_chain(t: &mut Subject) {
    let first = t.storage(&noise(300, 3));
    let [second, third] = [t.zeros(300), t.zeros(300)];
    t.list.copy(first, second, 1200);
    t.list.copy(second, third, 1200);
    t.list.clear(second, 0, 1200);
    t.list.copy(second, first, 1200);
    assert_eq!(t.words(third, 300), noise(300, 3));
    assert_eq!(t.words(first, 300), [0; 300]);
}

pub(super) fn a_part_of_a_buffer_comes_back(t: &mut Subject) {
    let values = t.storage(&[1u32, 2, 3, 4, 5]);
    let middle = t.list.read_buffer(values, 4, 12);
    let end = t.list.read_buffer(values, 16, 4);
    assert_eq!(t.read_words(middle), [2, 3, 4]);
    assert_eq!(t.read_words(end), [5]);
}

pub(super) fn a_read_back_has_its_place_in_the_list(t: &mut Subject) {
    let values = t.storage(&[1u32]);
    let before = t.list.read_buffer(values, 0, 4);
    t.list.upload(values, 0, &[2u32]);
    let after = t.list.read_buffer(values, 0, 4);
    t.list.clear(values, 0, 4);
    assert_eq!((t.read_words(before), t.read_words(after)), (vec![1], vec![2]));
}

pub(super) fn appended_commands_follow_with_their_bytes(t: &mut Subject) {
    let [values, copy] = [t.zeros(4), t.zeros(4)];
    t.list.upload(values, 0, &[1u32, 2, 3, 4]);
    let mut other = PassList::new();
    other.copy(values, copy, 16);
    other.upload(values, 4, &[20u32, 30]);
    let inner = other.read_buffer(values, 0, 16);
    t.list.append(&other);
    t.list.upload(values, 0, &[9u32]);
    assert_eq!(t.read_words(inner), [1, 20, 30, 4]);
    assert_eq!(t.words(copy, 4), [1, 2, 3, 4]);
    assert_eq!(t.words(values, 4), [9, 20, 30, 4]);
}

pub(super) fn what_was_given_up_is_unknown(t: &mut Subject) {
    let values = t.storage(&[5u32, 6]);
    let tickets = [0, 4].map(|offset| t.list.read_buffer(values, offset, 4));
    t.run();
    t.backend.cancel_read(tickets[0]);
    assert_eq!(t.backend.read(tickets[0]), ReadBack::Unknown);
    assert_eq!(t.read_words(tickets[1]), [6]);
    t.backend.cancel_read(tickets[1]);
    assert_eq!(t.backend.read(tickets[1]), ReadBack::Unknown, "given up too late");
}

pub(super) fn what_fails_half_way_is_freed(t: &mut Subject) {
    let before = t.zeros(8);
    let bytes = t.backend.memory().bytes;
    let made = Owner::build(&mut *t.backend, |backend| {
        backend.create_buffer(&BufferDesc::storage("suite.first", 1024))?;
        backend.create_texture(&TextureDesc::new("suite.second", [8, 8], Format::Rgba8))?;
        backend.create_buffer(&BufferDesc::storage("suite.odd", 3))
    });
    assert!(matches!(made, Err(Error::Rule { .. })), "three bytes are no buffer");
    assert_eq!(t.backend.memory().bytes, bytes);
    t.list.clear(before, 0, 32);
    t.run();
}

pub(super) fn a_list_that_breaks_a_rule_does_nothing(t: &mut Subject) {
    let values = t.storage(&[1u32, 2, 3, 4]);
    t.run();
    t.list.upload(values, 0, &[9u32; 4]);
    let ticket = t.list.read_buffer(values, 0, 16);
    t.list.clear(values, 0, 20);
    t.assert_refused("20 bytes from byte 0 on, it has 16");
    assert_eq!(t.backend.read(ticket), ReadBack::Unknown);
    assert_eq!(t.words(values, 4), [1, 2, 3, 4], "what came before the mistake was not done either");
}

pub(super) fn a_read_back_is_given_once(t: &mut Subject) {
    let values = t.storage(&[5u32]);
    let ticket = t.list.read_buffer(values, 0, 4);
    assert_eq!(t.read_words(ticket), [5]);
    assert_eq!(t.backend.read(ticket), ReadBack::Unknown);
}

pub(super) fn a_ticket_that_nobody_ran_gives_nothing(t: &mut Subject) {
    let values = t.zeros(1);
    let ticket = t.list.read_buffer(values, 0, 4);
    assert_eq!(t.backend.read(ticket), ReadBack::Unknown);
}

pub(super) fn new_buffers_are_zero(t: &mut Subject) {
    for desc in KINDS {
        let fresh = t.buffer(16_000, desc);
        assert_eq!(t.words(fresh, 16_000), [0; 16_000]);
    }
}

pub(super) fn an_empty_read_back_is_empty(t: &mut Subject) {
    let values = t.storage(&[7; 4]);
    let ticket = t.list.read_buffer(values, 8, 0);
    assert_eq!(t.read(ticket), [0u8; 0]);
}

pub(super) fn what_follows_a_destroyed_buffer_is_zero(t: &mut Subject) {
    for _ in 0..4 {
        let values = t.storage(&[u32::MAX; 10_000]);
        t.run();
        t.backend.destroy(values.into());
        let next = t.zeros(10_000);
        assert_eq!(t.words(next, 10_000), [0; 10_000]);
        t.backend.destroy(next.into());
    }
}

pub(super) fn an_empty_list_runs(t: &mut Subject) {
    t.run();
    t.run();
}

pub(super) fn a_list_run_again_does_the_same(t: &mut Subject) {
    let values = t.storage(&[1u32, 2, 3]);
    let copy = t.zeros(3);
    t.list.clear(values, 4, 4);
    t.list.copy(values, copy, 12);
    t.list.upload(values, 0, &[9u32; 3]);
    let list = t.list.clone();
    t.run();
    t.list.clear(copy, 0, 12);
    t.run();
    t.list = list;
    assert_eq!(t.words(copy, 3), [1, 0, 3]);
}

pub(super) fn memory_counts_what_is_made_and_destroyed(t: &mut Subject) {
    let before = t.backend.memory();
    let values = t.zeros(1 << 16);
    let Memory { bytes, peak } = t.backend.memory();
    assert_eq!(bytes, before.bytes + (4 << 16));
    assert!(peak >= bytes);
    let texture = t.texture([31, 7], Format::Rgba16F);
    assert_eq!(t.backend.memory().bytes, bytes + 31 * 7 * 8);
    t.backend.destroy(values.into());
    t.backend.destroy(texture.into());
    assert_eq!(t.backend.memory().bytes, before.bytes);
}

pub(super) fn memory_remembers_its_peak(t: &mut Subject) {
    let made = [t.zeros(1 << 14), t.zeros(1 << 14)];
    let peak = t.backend.memory().peak;
    made.into_iter().for_each(|buffer| t.backend.destroy(buffer.into()));
    let small = t.zeros(1);
    assert_eq!(t.backend.memory().peak, peak);
    t.backend.destroy(small.into());
    assert_eq!(t.backend.memory(), Memory { bytes: 0, peak });
}

pub(super) fn the_smallest_buffers_can_be_made(t: &mut Subject) {
    for desc in KINDS.map(|desc| desc("suite.smallest", 4)) {
        t.backend.create_buffer(&desc).unwrap_or_else(|error| panic!("{desc:?}: {error}"));
    }
}
