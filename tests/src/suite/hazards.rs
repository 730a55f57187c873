//! What has to wait for what, among compute passes, copies and the CPU. The shaders read in another order than they write, so
//! that what does not wait reads what is not there yet.

use tressfx_core::backend::BufferDesc;
use tressfx_core::id::BufferId;
use tressfx_core::shader::{Kernel, ShaderSource};

use super::kernels::{ADD_ONE, TIMES_3_PLUS_1, TURN, stepped, turned};
use super::subject::{Subject, noise, source};

/// Words of a buffer: enough groups that not all of them run at once.
const COUNT: usize = 64 * GROUPS as usize;
const GROUPS: u32 = 512;

fn turn(t: &mut Subject, kernel: &Kernel, input: BufferId, output: BufferId) {
    t.dispatch(kernel, &[("input", input.into()), ("output", output.into())], [GROUPS, 1, 1]);
}

fn step(t: &mut Subject, kernel: &Kernel, values: BufferId) {
    t.dispatch(kernel, &[("values", values.into())], [GROUPS, 1, 1]);
}

pub(super) fn compute_writes_then_compute_reads(t: &mut Subject) {
    let kernel = t.compute(&TURN);
    let words = noise(COUNT, 1);
    let [a, b, c] = [t.storage(&words), t.zeros(COUNT), t.zeros(COUNT)];
    turn(t, &kernel, a, b);
    turn(t, &kernel, b, c);
    assert_eq!(t.words(c, COUNT), turned(&turned(&words)));
}

pub(super) fn compute_reads_then_compute_writes(t: &mut Subject) {
    let (turner, stepper) = (t.compute(&TURN), t.compute(&TIMES_3_PLUS_1));
    let words = noise(COUNT, 2);
    let [a, b] = [t.storage(&words), t.zeros(COUNT)];
    turn(t, &turner, a, b);
    step(t, &stepper, a);
    assert_eq!(t.words(b, COUNT), turned(&words), "read before it was changed");
    assert_eq!(t.words(a, COUNT), stepped(&words));
}

pub(super) fn compute_writes_twice(t: &mut Subject) {
    let kernel = t.compute(&TURN);
    let [one, other] = [noise(COUNT, 3), noise(COUNT, 4)];
    let [a, b, c] = [t.storage(&one), t.storage(&other), t.zeros(COUNT)];
    turn(t, &kernel, a, c);
    turn(t, &kernel, b, c);
    assert_eq!(t.words(c, COUNT), turned(&other), "the later write stays");
}

pub(super) fn compute_changes_in_place_many_times(t: &mut Subject) {
    let [add, step_on] = [t.compute(&ADD_ONE), t.compute(&TIMES_3_PLUS_1)];
    let mut words = noise(COUNT, 5);
    let values = t.storage(&words);
    for _ in 0..8 {
        step(t, &add, values);
        step(t, &step_on, values);
        words.iter_mut().for_each(|word| *word = word.wrapping_add(1));
        words = stepped(&words);
    }
    assert_eq!(t.words(values, COUNT), words);
}

pub(super) fn two_buffers_take_turns(t: &mut Subject) {
    let kernel = t.compute(&TURN);
    let mut words = noise(COUNT, 6);
    let [a, b] = [t.storage(&words), t.zeros(COUNT)];
    for _ in 0..5 {
        turn(t, &kernel, a, b);
        turn(t, &kernel, b, a);
        words = turned(&turned(&words));
    }
    assert_eq!(t.words(a, COUNT), words);
}

pub(super) fn upload_then_compute_then_upload(t: &mut Subject) {
    let kernel = t.compute(&TURN);
    let [one, other] = [noise(COUNT, 7), noise(COUNT, 8)];
    let [a, b, c] = [t.storage(&one), t.zeros(COUNT), t.zeros(COUNT)];
    turn(t, &kernel, a, b);
    t.list.upload(a, 0, &other);
    turn(t, &kernel, a, c);
    assert_eq!(t.words(b, COUNT), turned(&one), "the first upload was there, the second was not");
    assert_eq!(t.words(c, COUNT), turned(&other));
}

pub(super) fn a_uniform_changes_between_passes(t: &mut Subject) {
    const SET: ShaderSource = source(
        "suite.set",
        "@group(0) @binding(0) var<uniform> value: vec4<u32>;
        @group(0) @binding(1) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(64) fn set_words(@builtin(global_invocation_id) i: vec3<u32>) {
            values[i.x] = value.x;
        }",
    );
    let kernel = t.compute(&SET);
    let value = t.uniform(&[1u32; 4]);
    let outputs = [t.zeros(COUNT), t.zeros(COUNT), t.zeros(COUNT)];
    for (i, output) in (10u32..).zip(outputs) {
        t.list.upload(value, 0, &[i; 4]);
        t.dispatch(&kernel, &[("value", value.into()), ("values", output.into())], [GROUPS, 1, 1]);
    }
    for (i, output) in (10u32..).zip(outputs) {
        assert_eq!(t.words(output, COUNT), vec![i; COUNT]);
    }
}

pub(super) fn copy_then_compute(t: &mut Subject) {
    let kernel = t.compute(&TURN);
    let words = noise(COUNT, 9);
    let [a, b, c] = [t.storage(&words), t.zeros(COUNT), t.zeros(COUNT)];
    t.list.copy(a, b, 4 * COUNT as u64);
    turn(t, &kernel, b, c);
    assert_eq!(t.words(c, COUNT), turned(&words));
}

pub(super) fn compute_then_copy_then_compute(t: &mut Subject) {
    let (turner, stepper) = (t.compute(&TURN), t.compute(&TIMES_3_PLUS_1));
    let words = noise(COUNT, 10);
    let [a, b, c] = [t.storage(&words), t.zeros(COUNT), t.zeros(COUNT)];
    turn(t, &turner, a, b);
    t.list.copy(b, c, 4 * COUNT as u64);
    step(t, &stepper, b);
    assert_eq!(t.words(c, COUNT), turned(&words), "copied before it was changed");
    assert_eq!(t.words(b, COUNT), stepped(&turned(&words)));
}

pub(super) fn clear_between_compute_passes(t: &mut Subject) {
    let kernel = t.compute(&TIMES_3_PLUS_1);
    let values = t.storage(&noise(COUNT, 11));
    step(t, &kernel, values);
    t.list.clear(values, 0, 2 * COUNT as u64);
    step(t, &kernel, values);
    let expected = stepped(&stepped(&noise(COUNT, 11)));
    let found = t.words(values, COUNT);
    assert_eq!(found[..COUNT / 2], vec![1; COUNT / 2]);
    assert_eq!(found[COUNT / 2..], expected[COUNT / 2..]);
}

pub(super) fn read_back_then_write(t: &mut Subject) {
    let kernel = t.compute(&TIMES_3_PLUS_1);
    let words = noise(COUNT, 12);
    let values = t.storage(&words);
    let first = t.list.read_buffer(values, 0, 4 * COUNT as u64);
    step(t, &kernel, values);
    let second = t.list.read_buffer(values, 0, 4 * COUNT as u64);
    t.list.clear(values, 0, 4 * COUNT as u64);
    assert_eq!(t.read_words(first), words);
    assert_eq!(t.read_words(second), stepped(&words));
}

pub(super) fn across_lists(t: &mut Subject) {
    let kernel = t.compute(&TURN);
    let words = noise(COUNT, 13);
    let [a, b, c] = [t.storage(&words), t.zeros(COUNT), t.zeros(COUNT)];
    turn(t, &kernel, a, b);
    t.run();
    turn(t, &kernel, b, c);
    t.list.upload(b, 0, &words);
    t.run();
    t.list.copy(b, a, 4 * COUNT as u64);
    assert_eq!(t.words(c, COUNT), turned(&turned(&words)));
    assert_eq!(t.words(a, COUNT), words);
}

pub(super) fn across_runs_of_one_list(t: &mut Subject) {
    let kernel = t.compute(&TURN);
    let mut words = noise(COUNT, 14);
    let [a, b] = [t.storage(&words), t.zeros(COUNT)];
    t.run();
    turn(t, &kernel, a, b);
    t.list.copy(b, a, 4 * COUNT as u64);
    let list = t.list.clone();
    for _ in 0..5 {
        t.list = list.clone();
        t.run();
        words = turned(&words);
    }
    assert_eq!(t.words(a, COUNT), words);
}

/// Writes how many groups are to run: so many along x, y and z as the words say.
const COUNT_GROUPS: ShaderSource = source(
    "suite.count_groups",
    "@group(0) @binding(0) var<uniform> wanted: vec4<u32>;
    @group(0) @binding(1) var<storage, read_write> counts: array<u32>;
    @compute @workgroup_size(1) fn count_groups() {
        counts[1] = wanted.x;
        counts[2] = wanted.y;
        counts[3] = wanted.z;
    }",
);

/// Counts the groups that run.
const TALLY: ShaderSource = source(
    "suite.tally",
    "@group(0) @binding(0) var<storage, read_write> tally: atomic<u32>;
    @compute @workgroup_size(1) fn count() { atomicAdd(&tally, 1u); }",
);

pub(super) fn compute_writes_the_number_of_groups(t: &mut Subject) {
    let (count, tally) = (t.compute(&COUNT_GROUPS), t.compute(&TALLY));
    let counts = t.buffer(4, BufferDesc::indirect);
    let wanted = t.uniform(&[5u32, 3, 2, 0]);
    let total = t.zeros(1);
    t.dispatch(&count, &[("wanted", wanted.into()), ("counts", counts.into())], [1; 3]);
    t.indirect(&tally, &[("tally", total.into())], counts, 4);
    assert_eq!(t.words(total, 1), [30]);
}

pub(super) fn the_number_of_groups_is_read_before_it_changes(t: &mut Subject) {
    let (count, tally) = (t.compute(&COUNT_GROUPS), t.compute(&TALLY));
    let counts = t.filled(&[0u32, 7, 1, 1], BufferDesc::indirect);
    let wanted = t.uniform(&[11u32, 1, 1, 0]);
    let totals = [t.zeros(1), t.zeros(1), t.zeros(1)];
    let run = |t: &mut Subject, total: BufferId| {
        t.indirect(&tally, &[("tally", total.into())], counts, 4);
    };
    run(t, totals[0]);
    t.dispatch(&count, &[("wanted", wanted.into()), ("counts", counts.into())], [1; 3]);
    run(t, totals[1]);
    t.list.upload(counts, 4, &[13u32]);
    run(t, totals[2]);
    assert_eq!(totals.map(|total| t.words(total, 1)[0]), [7, 11, 13]);
}

pub(super) fn no_groups_run_nothing(t: &mut Subject) {
    let tally = t.compute(&TALLY);
    let counts = t.filled(&[0u32, 4, 4], BufferDesc::indirect);
    let total = t.storage(&[9u32]);
    t.indirect(&tally, &[("tally", total.into())], counts, 0);
    t.dispatch(&tally, &[("tally", total.into())], [0, 1, 1]);
    assert_eq!(t.words(total, 1), [9]);
}

pub(super) fn counts_are_storage_as_well(t: &mut Subject) {
    let kernel = t.compute(&TURN);
    let words = noise(64, 15);
    let counts = t.filled(&words, BufferDesc::indirect);
    let output = t.buffer(64, BufferDesc::indirect);
    t.dispatch(&kernel, &[("input", counts.into()), ("output", output.into())], [1; 3]);
    assert_eq!(t.words(output, 64), turned(&words));
}
