//! The contract without a GPU: lists, their checks, their hazards, and the backend that runs nothing.

use std::sync::Arc;

use tressfx_core::backend::{Backend, BufferDesc, Caps, ComputeDesc, Run};
use tressfx_core::error::{Error, Need};
use tressfx_core::hazards::{self, Access};
use tressfx_core::id::BufferId;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{Command, Grid, PassList};
use tressfx_core::shader::{Kernel, Shader, ShaderSource, Specialization};

const ADD: &str = "
    @group(0) @binding(0) var<storage, read> source: array<u32>;
    @group(0) @binding(1) var<storage, read_write> sum: array<u32>;
    @compute @workgroup_size(1) fn add() { sum[0] += source[0]; }";

fn add_shader() -> Arc<Shader> {
    let source = ShaderSource { label: "test.add", root: ("add", ADD), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).unwrap())
}

fn buffer(backend: &mut NullBackend) -> BufferId {
    backend.create_buffer(&BufferDesc::storage("test.buffer", 16)).unwrap()
}

fn setup() -> (NullBackend, Kernel, [BufferId; 2]) {
    let mut backend = NullBackend::default();
    let kernel = backend.create_compute(&ComputeDesc::new(add_shader())).unwrap();
    let buffers = [buffer(&mut backend), buffer(&mut backend)];
    (backend, kernel, buffers)
}

#[test]
fn a_list_runs_in_order_and_waits_only_where_it_must() {
    let (mut backend, kernel, [a, b]) = setup();
    let bindings = kernel.bind(&[("sum", b.into()), ("source", a.into())]).unwrap();
    assert_eq!(bindings.all(), [a.into(), b.into()], "in the order of the shader, whatever the caller's");
    let mut list = PassList::new();
    list.upload(a, 0, &[1u32, 2, 3, 4]);
    list.clear(b, 0, 16);
    list.compute(&kernel, &bindings, Grid([1, 1, 1]));
    list.compute(&kernel, &bindings, Grid([1, 1, 1]));
    list.compute(&kernel, &bindings, Grid([0, 1, 1]));
    list.read_buffer(b, 0, 16);
    assert_eq!(list.labels().collect::<Vec<_>>(), ["test.add", "test.add"], "an empty grid is left out");
    let waits: Vec<usize> = hazards::of_list(&list).iter().map(Vec::len).collect();
    assert_eq!(waits, [0, 0, 2, 1, 1], "the second pass has waited for the upload already");
    let update = Access::COMPUTE_READ | Access::COMPUTE_WRITE;
    assert_eq!(hazards::of_list(&list)[3][0].earlier, update);
    backend.run(&list).unwrap();
    assert_eq!(backend.ran, ["test.add", "test.add"]);
    assert_eq!(backend.barriers, 3);
}

#[test]
fn broken_rules_are_named_with_their_command() {
    let (mut backend, kernel, [a, b]) = setup();
    let mut said = |build: &dyn Fn(&mut PassList)| {
        let mut list = PassList::new();
        list.clear(b, 0, 4);
        build(&mut list);
        backend.run(&list).err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert_eq!(said(&|list| list.clear(a, 0, 16)), "");
    assert_eq!(said(&|list| list.clear(a, 2, 8)), "command 1, clear: `test.buffer`: 2 is not a multiple of 4");
    assert_eq!(
        said(&|list| list.clear(a, 12, 8)),
        "command 1, clear: `test.buffer`: 8 bytes from byte 12 on, it has 16"
    );
    assert!(said(&|list| list.clear(a, u64::MAX - 3, 8)).contains("it has 16"));
    assert!(said(&|list| list.upload(a, 0, &[1u8, 2, 3])).contains("3 is not a multiple of 4"));
    assert!(said(&|list| list.copy(a, a, 4)).contains("to itself"));
    let out = |list: &mut PassList| list.push(Command::Upload { dst: a, offset: 0, data: 0..8 });
    assert!(said(&out).contains("bytes 0..8 of a list that holds 0"));
    let same = kernel.bind(&[("source", b.into()), ("sum", b.into())]).unwrap();
    assert_eq!(
        said(&|list| list.compute(&kernel, &same, Grid([1; 3]))),
        "command 1, test.add: `source` and `sum` are the same resource, and it is written"
    );
    let fine = kernel.bind(&[("source", a.into()), ("sum", b.into())]).unwrap();
    assert!(said(&|list| list.compute(&kernel, &fine, Grid([70_000, 1, 1]))).contains("exceeds 65535"));
    let range = kernel.bind(&[("source", a.range(4, 4)), ("sum", b.into())]).unwrap();
    assert_eq!(
        said(&|list| list.compute(&kernel, &range, Grid([1; 3]))),
        "command 1, test.add: binding `source`: offset 4 is not a multiple of 256"
    );
}

#[test]
fn names_of_bindings_are_held_against_the_shader() {
    let (_, kernel, [a, b]) = setup();
    let missing = kernel.bind(&[("source", a.into())]).unwrap_err();
    assert_eq!(missing.to_string(), "test.add: nothing is bound to `sum`");
    let unknown = kernel.bind(&[("source", a.into()), ("sum", b.into()), ("total", b.into())]).unwrap_err();
    assert!(unknown.to_string().starts_with("test.add: the shader has no binding `total`"), "{unknown}");
    let twice = kernel.bind(&[("source", a.into()), ("source", b.into())]).unwrap_err();
    assert_eq!(twice.to_string(), "test.add: `source` is bound twice");
}

#[test]
fn what_was_destroyed_can_be_named_by_older_lists_alone() {
    let (mut backend, _, [a, _]) = setup();
    let (mut old, mut new) = (PassList::new(), PassList::new());
    old.clear(a, 0, 16);
    backend.destroy(a.into());
    old.clear(a, 0, 8);
    new.clear(a, 0, 16);
    assert_eq!(backend.run(&old), Ok(()));
    let refused = backend.run(&new).unwrap_err().to_string();
    assert!(refused.starts_with("command 0, clear: BufferId"), "{refused}");
    let mut both = PassList::new();
    both.append(&old);
    assert_eq!(backend.run(&both), Ok(()), "a copy of an old list is as old");
    drop((old, both));
    assert!(backend.run(&new).is_err());
}

#[test]
fn an_id_of_another_backend_is_refused() {
    let (mut backend, ..) = setup();
    let (_other, kernel, [a, b]) = setup();
    let mut list = PassList::new();
    list.clear(a, 0, 16);
    assert!(matches!(backend.run(&list), Err(Error::Rule { .. })));
    list.clear_commands();
    list.compute(&kernel, &kernel.bind(&[("source", a.into()), ("sum", b.into())]).unwrap(), Grid([1; 3]));
    assert!(matches!(backend.run(&list), Err(Error::Rule { .. })));
}

#[test]
fn a_list_prints_a_frame() {
    let (_, kernel, [a, b]) = setup();
    let mut list = PassList::new();
    list.upload(a, 4, &[1u32]);
    list.scope(Some("mohawk".into()));
    list.compute(&kernel, &kernel.bind(&[("source", a.into()), ("sum", b.into())]).unwrap(), Grid([1; 3]));
    let text = format!("{list:?}");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "2 commands, 4 bytes of uploads");
    assert!(lines[1].contains("upload 4 bytes to BufferId"), "{text}");
    assert!(lines[2].contains("test.add of mohawk over"), "{text}");
    assert_eq!(lines.len(), 3);
}

#[test]
fn memory_and_limits_are_kept() {
    let mut caps = Caps::webgpu_default();
    caps.max_storage_buffers_per_stage = 1;
    let mut backend = NullBackend::new(caps);
    let a = buffer(&mut backend);
    buffer(&mut backend);
    backend.destroy(a.into());
    assert_eq!((backend.memory().bytes, backend.memory().peak), (16, 32));
    let error = backend.create_compute(&ComputeDesc::new(add_shader())).unwrap_err();
    assert_eq!(error, Error::Unsupported { label: "test.add", need: Need::StorageBuffers(2), have: 1 });
}
