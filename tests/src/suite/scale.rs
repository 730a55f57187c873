//! Many of everything, and more than one backend.

use std::thread;

use tressfx_core::backend::{BufferDesc, Run};
use tressfx_core::pass::PassList;

use super::kernels::{ADD_ONE, TIMES_3_PLUS_1};
use super::subject::Subject;

pub(super) fn a_thousand_tiny_lists(t: &mut Subject) {
    let values = t.zeros(1000);
    for i in 0..1000u32 {
        t.list.upload(values, u64::from(4 * i), &[i * i]);
        t.run();
    }
    assert_eq!(t.words(values, 1000), (0..1000).map(|i| i * i).collect::<Vec<u32>>());
}

pub(super) fn a_list_of_a_thousand_tiny_passes(t: &mut Subject) {
    let kernels = [t.compute(&ADD_ONE), t.compute(&TIMES_3_PLUS_1)];
    let values = t.storage(&[1u32; 64]);
    let mut expected = 1u32;
    for i in 0..1000 {
        t.dispatch(&kernels[i % 2], &[("values", values.into())], [1; 3]);
        expected = if i % 2 == 0 { expected.wrapping_add(1) } else { expected.wrapping_mul(3).wrapping_add(1) };
    }
    assert_eq!(t.words(values, 64), [expected; 64]);
}

pub(super) fn a_thousand_buffers_live_at_once(t: &mut Subject) {
    let buffers: Vec<_> = (0..1000u32).map(|i| t.storage(&[i])).collect();
    let tickets: Vec<_> = buffers.iter().rev().map(|&buffer| t.list.read_buffer(buffer, 0, 4)).collect();
    for (ticket, expected) in tickets.into_iter().zip((0..1000).rev()) {
        assert_eq!(t.read_words(ticket), [expected]);
    }
    buffers.into_iter().for_each(|buffer| t.backend.destroy(buffer.into()));
    assert_eq!(t.backend.memory().bytes, 0);
}

pub(super) fn two_backends_do_not_know_of_each_other(t: &mut Subject) {
    let mut other = t.another();
    let [one, two] = [&mut t.backend, &mut other].map(|backend| made(&mut **backend));
    write(&mut *t.backend, one, 5);
    write(&mut *other, two, 6);
    assert_eq!((read(&mut *t.backend, one), read(&mut *other, two)), (5, 6));
}

pub(super) fn backends_run_on_two_threads_at_once(t: &mut Subject) {
    let make = t.make;
    thread::scope(|scope| {
        for seed in 0..2u32 {
            scope.spawn(move || {
                let mut backend = make().expect("a backend on each thread");
                let values = made(&mut *backend);
                for i in 0..50 {
                    write(&mut *backend, values, seed + 2 * i);
                    assert_eq!(read(&mut *backend, values), seed + 2 * i);
                }
            });
        }
    });
}

fn made(backend: &mut dyn Run) -> tressfx_core::id::BufferId {
    backend.create_buffer(&BufferDesc::storage("suite.word", 4)).expect("a buffer")
}

fn write(backend: &mut dyn Run, values: tressfx_core::id::BufferId, word: u32) {
    let mut list = PassList::new();
    list.upload(values, 0, &[word]);
    backend.run(&list).expect("the list runs");
}

fn read(backend: &mut dyn Run, values: tressfx_core::id::BufferId) -> u32 {
    let mut list = PassList::new();
    let ticket = list.read_buffer(values, 0, 4);
    bytemuck::pod_read_unaligned(&crate::run_and_read(backend, &list, ticket))
}
