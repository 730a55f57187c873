//! A backend from outside: on the CPU, without passes. It stands where one's own would stand on its first day: what moves
//! bytes works, kernels come next.
//!
//! `cargo run -p tressfx-examples --example my_backend`

mod cpu;

use std::sync::Arc;

use anyhow::{Context, Result};
use cpu::CpuBackend;
use tressfx_core::backend::{Backend, BufferDesc, ComputeDesc, Run};
use tressfx_core::pass::PassList;
use tressfx_core::shader::{Shader, ShaderSource, Specialization};

fn main() -> Result<()> {
    let mut backend = CpuBackend::new();
    let desc = BufferDesc::storage("numbers", 16);
    let [numbers, copy] = [backend.create_buffer(&desc)?, backend.create_buffer(&desc)?];

    // EngineCommands take effect in the order of the list.
    let mut list = PassList::new();
    list.upload(numbers, 0, &[1u32, 2, 3, 4]);
    list.clear(numbers, 4, 4);
    list.copy(numbers, copy, 16);
    list.upload(numbers, 0, &[9u32; 4]);
    let ticket = list.read_buffer(copy, 0, 16);
    backend.run(&list)?;
    let bytes = backend.read(ticket).ready().context("the list has run, so the bytes are there")?;
    println!("{:?} on {}", bytemuck::pod_collect_to_vec::<u8, u32>(&bytes), backend.caps().adapter);

    // A list that breaks a rule does nothing, and the error names command and rule.
    list.clear(copy, 12, 8);
    if let Err(refused) = backend.run(&list) {
        println!("{refused}");
    }

    // What it cannot do it says, so that nobody has to find out by a wrong picture.
    let root = ("nothing", "@compute @workgroup_size(1) fn nothing() {}");
    let shader = Shader::new(&ShaderSource { label: "nothing", root, library: &[] }, &Specialization::new())?;
    if let Err(refused) = backend.create_compute(&ComputeDesc::new(Arc::new(shader))) {
        println!("{refused}");
    }
    Ok(())
}
