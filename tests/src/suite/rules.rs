//! Every rule of the contract, broken: see [`crate::rules`].

use tressfx_core::backend::ReadBack;
use tressfx_core::error::Error;

use super::subject::Subject;
use crate::rules::{World, broken_descriptions, broken_lists, mistakes, random_list};

/// What is wrong with so many answers, shortened.
#[track_caller]
fn assert_none(complaints: &[String], of: usize) {
    let first: Vec<_> = complaints.iter().take(8).collect();
    assert!(complaints.is_empty(), "{} of {of} answers are wrong: {first:#?}", complaints.len());
}

/// Runs every broken list; each is refused, and does nothing.
#[track_caller]
fn refuse(t: &mut Subject, passes: bool) {
    let mut another = t.another();
    let world = World::new(&mut *t.backend, &mut *another);
    let broken = broken_lists(&world, mistakes(&world, passes));
    let count = broken.len();
    let complaints: Vec<_> =
        broken.into_iter().filter_map(|broken| broken.complaint(&t.backend.run(&broken.list))).collect();
    assert_none(&complaints, count);
    assert!(count >= if passes { 600 } else { 200 }, "{count} lists");
    let (marker, bytes) = world.marker();
    let found = t.words(marker, bytes as usize / 4);
    assert!(found.iter().all(|&word| word == 0), "the sound commands of a broken list were done");
}

pub(super) fn every_mistake_of_a_copy_is_answered(t: &mut Subject) {
    refuse(t, false);
}

pub(super) fn every_mistake_of_a_pass_is_answered(t: &mut Subject) {
    refuse(t, true);
}

pub(super) fn every_mistake_of_a_description_is_answered(t: &mut Subject) {
    let (complaints, count) = broken_descriptions(&mut *t.backend);
    assert_none(&complaints, count);
    assert!(count >= 20, "{count} descriptions");
}

/// How many random lists are run.
const RANDOM: u64 = 400;

pub(super) fn what_is_not_refused_runs(t: &mut Subject) {
    let mut another = t.another();
    let world = World::new(&mut *t.backend, &mut *another);
    let mut ran = 0u64;
    for seed in 0..RANDOM {
        let list = random_list(&world, seed);
        match t.backend.run(&list) {
            Ok(()) => ran += 1,
            Err(Error::Rule { .. }) => {}
            Err(error) => panic!("seed {seed}: {error}: {list:?}"),
        }
    }
    assert!((RANDOM / 4..RANDOM * 19 / 20).contains(&ran), "{ran} of {RANDOM} lists are sound");
    let ticket = t.list.read_buffer(world.marker().0, 0, 4);
    t.run();
    assert_eq!(t.backend.read(ticket), ReadBack::Ready(vec![0; 4]));
}
