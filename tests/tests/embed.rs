//! Inside an engine: its device, its queue, its encoder, its buffers and textures.

mod support;

use std::sync::Arc;

use tressfx_backend_wgpu::{WgpuBackend, wgpu};
use tressfx_core::backend::{Backend, BufferDesc, BufferUse, ComputeDesc, Record};
use tressfx_core::pass::{Grid, Load, PassList, RasterPass};
use tressfx_core::shader::{Shader, ShaderSource, Specialization};

use support::gpu;

const INCREMENT: &str = "
    @group(0) @binding(0) var<storage, read_write> values: array<u32>;
    @compute @workgroup_size(4) fn increment(@builtin(global_invocation_id) i: vec3<u32>) { values[i.x] += 1u; }";

fn shader() -> Arc<Shader> {
    let source = ShaderSource { label: "test.increment", root: ("increment", INCREMENT), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).unwrap())
}

/// An engine that owns everything, and the library inside it.
fn engine() -> Option<(wgpu::Device, wgpu::Queue, WgpuBackend)> {
    let engine = gpu()?;
    let (device, queue) = (engine.device().clone(), engine.queue().clone());
    let inside = WgpuBackend::new(device.clone(), queue.clone());
    Some((device, queue, inside))
}

fn engine_buffer(device: &wgpu::Device, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let usage = usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor { label: Some("engine"), size: 16, usage, mapped_at_creation: false })
}

#[test]
fn a_list_goes_between_the_engines_own_commands() {
    let Some((device, queue, mut hair)) = engine() else { return };
    let engines = engine_buffer(&device, wgpu::BufferUsages::STORAGE);
    let imported = hair.import_buffer(engines.clone());
    let kernel = hair.create_compute(&ComputeDesc { shader: shader() }).unwrap();
    let bindings = kernel.bind(&[("values", imported.into())]);
    let mut list = PassList::new();
    list.compute(&kernel, &bindings, Grid([1, 1, 1]));
    let ticket = list.read_buffer(imported, 0, 16);

    queue.write_buffer(&engines, 0, bytemuck::bytes_of(&[10u32, 20, 30, 40]));
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.clear_buffer(&engines, 0, Some(4));
    hair.record(&mut encoder, &list).unwrap();
    encoder.clear_buffer(&engines, 12, Some(4));
    hair.record(&mut encoder, &list.clone()).unwrap();
    queue.submit([encoder.finish()]);
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();

    let bytes = hair.read(ticket).expect("submitted and waited for");
    assert_eq!(bytemuck::pod_collect_to_vec::<u8, u32>(&bytes), [2, 22, 32, 1]);
}

#[test]
fn an_imported_texture_is_drawn_to_and_survives_its_id() {
    let Some((device, queue, mut hair)) = engine() else { return };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("engine"),
        size: wgpu::Extent3d { width: 3, height: 2, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Bgra8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let imported = hair.import_texture("engine", texture.clone());
    assert_eq!(hair.memory().bytes, 0, "what the engine made is the engine's");
    let mut list = PassList::new();
    list.raster(RasterPass {
        label: "test.clear",
        colors: vec![(imported, Load::Clear([1.0, 0.0, 0.0, 1.0]))],
        depth: None,
        draws: Vec::new(),
    });
    let ticket = list.read_texture(imported);
    hair.run(&list).unwrap();
    assert_eq!(hair.read(ticket).unwrap(), [0, 0, 255, 255].repeat(6));

    hair.destroy(imported.into());
    let again = hair.import_texture("engine", texture);
    let mut list = PassList::new();
    let ticket = list.read_texture(again);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    hair.record(&mut encoder, &list).unwrap();
    queue.submit([encoder.finish()]);
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    assert_eq!(hair.read(ticket).unwrap(), [0, 0, 255, 255].repeat(6), "the texture outlived its first id");
}

#[test]
fn recording_alone_runs_nothing() {
    let Some((device, queue, mut hair)) = engine() else { return };
    let buffer =
        hair.create_buffer(&BufferDesc { label: "test.buffer", bytes: 16, usage: BufferUse::Storage }).unwrap();
    let kernel = hair.create_compute(&ComputeDesc { shader: shader() }).unwrap();
    let bindings = kernel.bind(&[("values", buffer.into())]);
    let mut list = PassList::new();
    list.compute(&kernel, &bindings, Grid([1, 1, 1]));
    let mut thrown_away = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    hair.record(&mut thrown_away, &list).unwrap();
    drop(thrown_away);
    queue.submit([]);
    let mut list = PassList::new();
    let ticket = list.read_buffer(buffer, 0, 16);
    hair.run(&list).unwrap();
    assert_eq!(hair.read(ticket).unwrap(), [0; 16]);
}
