//! The contract without a GPU: lists, their checks, their hazards, and the backend that runs nothing.

use std::sync::Arc;

use tressfx_core::backend::{Backend, BufferDesc, BufferUse, Caps, ComputeDesc, Kernel, Need};
use tressfx_core::check::problem;
use tressfx_core::error::Error;
use tressfx_core::hazards::{self, Access};
use tressfx_core::id::BufferId;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{Command, Grid, PassList};
use tressfx_core::shader::{Shader, ShaderSource, Specialization};

const ADD: &str = "
    @group(0) @binding(0) var<storage, read> source: array<u32>;
    @group(0) @binding(1) var<storage, read_write> sum: array<u32>;
    @compute @workgroup_size(1) fn add() { sum[0] += source[0]; }";

fn add_shader() -> Arc<Shader> {
    let source = ShaderSource { label: "test.add", root: ("add", ADD), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).unwrap())
}

fn buffer(backend: &mut NullBackend) -> BufferId {
    backend.create_buffer(&BufferDesc { label: "test.buffer", bytes: 16, usage: BufferUse::Storage }).unwrap()
}

fn setup() -> (NullBackend, Kernel, [BufferId; 2]) {
    let mut backend = NullBackend::default();
    let kernel = backend.create_compute(&ComputeDesc { shader: add_shader() }).unwrap();
    let buffers = [buffer(&mut backend), buffer(&mut backend)];
    (backend, kernel, buffers)
}

#[test]
fn a_list_runs_in_order_and_waits_only_where_it_must() {
    let (mut backend, kernel, [a, b]) = setup();
    let bindings = kernel.bind(&[("sum", b.into()), ("source", a.into())]);
    assert_eq!(bindings.resources(), [a.into(), b.into()], "in the order of the shader, whatever the caller's");
    let mut list = PassList::new();
    list.upload(a, 0, &[1u32, 2, 3, 4]);
    list.clear(b, 0, 16);
    list.compute(&kernel, &bindings, Grid([1, 1, 1]));
    list.compute(&kernel, &bindings, Grid([1, 1, 1]));
    list.compute(&kernel, &bindings, Grid([0, 1, 1]));
    list.read_buffer(b, 0, 16);
    assert_eq!(list.labels().collect::<Vec<_>>(), ["test.add", "test.add"], "an empty grid is left out");
    let waits: Vec<usize> = hazards::of_list(&list).iter().map(Vec::len).collect();
    assert_eq!(waits, [0, 0, 2, 1, 1], "the second pass has seen the upload already");
    let update = Access::COMPUTE_READ | Access::COMPUTE_WRITE;
    assert_eq!(hazards::of_list(&list)[3][0].before, update);
    backend.run(&list).unwrap();
    assert_eq!(backend.ran, ["test.add", "test.add"]);
    assert_eq!(backend.barriers, 3);
}

#[test]
fn broken_rules_are_named() {
    let (_, kernel, [a, b]) = setup();
    let problem_of = |build: &dyn Fn(&mut PassList)| {
        let mut list = PassList::new();
        build(&mut list);
        problem(&list).unwrap_or_default()
    };
    assert_eq!(problem_of(&|list| list.clear(a, 0, 16)), "");
    assert!(problem_of(&|list| list.clear(a, 2, 16)).contains("clear: 2 is not a multiple of 4"));
    assert!(problem_of(&|list| list.upload(a, 0, &[1u8, 2, 3])).contains("3 is not a multiple of 4"));
    assert!(problem_of(&|list| list.copy(a, a, 4)).contains("to itself"));
    let out = |list: &mut PassList| list.commands.push(Command::Upload { dst: a, offset: 0, data: 0..8 });
    assert!(problem_of(&out).contains("bytes 0..8 of a list that holds 0"));
    let same = kernel.bind(&[("source", b.into()), ("sum", b.into())]);
    assert!(problem_of(&|list| list.compute(&kernel, &same, Grid([1, 1, 1]))).contains("same buffer"));
    let fine = kernel.bind(&[("source", a.into()), ("sum", b.into())]);
    assert!(problem_of(&|list| list.compute(&kernel, &fine, Grid([70_000, 1, 1]))).contains("exceeds 65535"));
}

#[test]
#[should_panic(expected = "test.add: nothing is bound to `sum`")]
fn a_missing_binding_panics_with_label_and_name() {
    let (_, kernel, [a, _]) = setup();
    kernel.bind(&[("source", a.into())]);
}

#[test]
#[should_panic(expected = "test.add: the shader has no binding `total`")]
fn an_unknown_binding_panics_with_label_and_name() {
    let (_, kernel, [a, b]) = setup();
    kernel.bind(&[("source", a.into()), ("sum", b.into()), ("total", b.into())]);
}

#[test]
#[should_panic(expected = "is stale")]
fn a_destroyed_buffer_is_noticed() {
    let (mut backend, _, [a, _]) = setup();
    backend.destroy(a.into());
    let mut list = PassList::new();
    list.clear(a, 0, 16);
    let _ = backend.run(&list);
}

#[test]
fn memory_and_limits_are_kept() {
    let mut backend = NullBackend::new(Caps { max_storage_buffers_per_stage: 1, ..Caps::webgpu_default() });
    let a = buffer(&mut backend);
    buffer(&mut backend);
    backend.destroy(a.into());
    assert_eq!((backend.memory().bytes, backend.memory().peak), (16, 32));
    let error = backend.create_compute(&ComputeDesc { shader: add_shader() }).unwrap_err();
    assert_eq!(error, Error::Unsupported { label: "test.add", need: Need::StorageBuffers(2), have: 1 });
}
