//! Inside of an engine that keeps its device, its callbacks and its nerves.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use tressfx_core::backend::{
    Backend, Blend, BufferDesc, BufferUses, ComputeDesc, Format, ReadBack, Record, Run, TextureDesc, TextureUses,
};
use tressfx_core::error::{Error, Need};
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Command, Grid, Load, PassList, RasterPass};
use tressfx_core::shader::{Kernel, Shader, ShaderSource, Specialization};

use crate::WgpuBackend;

/// An engine, and what its callbacks were told.
struct Engine {
    hair: WgpuBackend,
    device: wgpu::Device,
    queue: wgpu::Queue,
    lost: Arc<AtomicUsize>,
    complaints: Arc<Mutex<Vec<String>>>,
}

/// `None` where there is no adapter and `TRESSFX_NO_GPU` says that this is known.
fn engine() -> Option<Engine> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    if adapter.is_err() && std::env::var_os("TRESSFX_NO_GPU").is_some() {
        return None;
    }
    let adapter = adapter.unwrap();
    let required_features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
    let descriptor = wgpu::DeviceDescriptor { required_features, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    let (lost, complaints) = (Arc::new(AtomicUsize::new(0)), Arc::new(Mutex::new(Vec::new())));
    let (told, noted) = (lost.clone(), complaints.clone());
    device.set_device_lost_callback(move |_, _| told.store(1 + told.load(Ordering::SeqCst), Ordering::SeqCst));
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| noted.lock().unwrap().push(error.to_string())));
    let hair = WgpuBackend::new(device.clone(), queue.clone());
    Some(Engine { hair, device, queue, lost, complaints })
}

impl Engine {
    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Records and submits.
    fn frame(&mut self, list: &PassList) {
        let mut encoder = self.encoder();
        self.hair.record(&mut encoder, list).unwrap();
        self.queue.submit([encoder.finish()]);
    }

    fn wait(&self) {
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    }

    fn buffer(&mut self, bytes: u64) -> BufferId {
        self.hair.create_buffer(&BufferDesc::storage("test.buffer", bytes)).unwrap()
    }

    fn add_one(&mut self) -> Kernel {
        let root = "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
            @compute @workgroup_size(4) fn add_one(@builtin(local_invocation_index) i: u32) { values[i] += 1u; }";
        let source = ShaderSource { label: "test.add_one", root: ("root", root), library: &[] };
        let shader = Arc::new(Shader::new(&source, &Specialization::new()).unwrap());
        self.hair.create_compute(&ComputeDesc::new(shader)).unwrap()
    }

    /// A list that uploads, runs a pass and reads back.
    fn work(&mut self, kernel: &Kernel, values: BufferId, first: u32) -> (PassList, tressfx_core::pass::Ticket) {
        let mut list = PassList::new();
        list.upload(values, 0, &[first, 0, 0, 0]);
        list.compute(kernel, &kernel.bind(&[("values", values.into())]).unwrap(), Grid([1; 3]));
        let ticket = list.read_buffer(values, 0, 4);
        (list, ticket)
    }

    fn assert_silent(&self) {
        assert_eq!(*self.complaints.lock().unwrap(), Vec::<String>::new());
    }
}

#[test]
fn a_lost_device_is_an_error_and_the_engine_is_told() {
    let Some(mut engine) = engine() else { return };
    let (kernel, values) = (engine.add_one(), engine.buffer(16));
    let (list, pending) = engine.work(&kernel, values, 1);
    engine.frame(&list);
    let (unsubmitted, never) = engine.work(&kernel, values, 2);
    let mut encoder = engine.encoder();
    engine.hair.record(&mut encoder, &unsubmitted).unwrap();
    engine.device.destroy();
    let is_lost = |error: Error| assert!(matches!(error, Error::DeviceLost { .. }), "{error}");
    is_lost(engine.hair.create_buffer(&BufferDesc::storage("test.buffer", 16)).unwrap_err());
    is_lost(engine.hair.create_texture(&TextureDesc::new("test.texture", [4; 2], Format::Rgba8)).unwrap_err());
    is_lost(engine.hair.create_compute(&ComputeDesc::new(kernel.shader.clone())).unwrap_err());
    is_lost(engine.hair.run(&list).unwrap_err());
    let mut late = engine.encoder();
    is_lost(engine.hair.record(&mut late, &list).unwrap_err());
    engine.queue.submit([encoder.finish()]);
    engine.wait();
    assert_eq!(engine.lost.load(Ordering::SeqCst), 1, "the engine's callback was called");
    for ticket in [pending, never] {
        assert_eq!(engine.hair.read(ticket), ReadBack::Failed);
    }
    assert_eq!(engine.hair.timings(), []);
    engine.hair.destroy(values.into());
    engine.assert_silent();
}

#[test]
fn a_backend_on_a_device_that_is_lost_already_says_so() {
    let Some(engine) = engine() else { return };
    engine.device.destroy();
    let mut hair = WgpuBackend::new(engine.device.clone(), engine.queue.clone());
    let error = hair.create_buffer(&BufferDesc::storage("test.buffer", 16)).unwrap_err();
    assert!(matches!(error, Error::DeviceLost { .. }), "{error}");
    engine.assert_silent();
}

#[test]
fn what_was_recorded_and_thrown_away_fails_and_is_used_again() {
    let Some(mut engine) = engine() else { return };
    let (kernel, values) = (engine.add_one(), engine.buffer(16));
    for round in 0..30 {
        let (list, ticket) = engine.work(&kernel, values, round);
        let mut encoder = engine.encoder();
        engine.hair.record(&mut encoder, &list).unwrap();
        assert_eq!(engine.hair.read(ticket), ReadBack::Pending);
        drop(encoder);
        assert_eq!(engine.hair.read(ticket), ReadBack::Failed);
        assert_eq!(engine.hair.read(ticket), ReadBack::Failed, "it stays so until it is given up");
        engine.hair.cancel_read(ticket);
        assert_eq!(engine.hair.read(ticket), ReadBack::Unknown);
        let (list, ticket) = engine.work(&kernel, values, round);
        engine.frame(&list);
        engine.wait();
        assert_eq!(engine.hair.read(ticket), ReadBack::Ready((round + 1).to_le_bytes().to_vec()));
        assert_eq!(engine.hair.read(ticket), ReadBack::Unknown, "bytes are given once");
        assert_eq!(engine.hair.timings().len(), usize::from(engine.hair.caps().timestamps));
    }
    let counts = (engine.hair.uploads.count(), engine.hair.timer.count(), engine.hair.reads.count());
    assert!(counts.0 <= 2 && counts.1 <= 2 && counts.2 <= 2, "buffers of uploads, timers and read-backs: {counts:?}");
    engine.assert_silent();
}

#[test]
fn frames_in_flight_have_buffers_of_their_own() {
    let Some(mut engine) = engine() else { return };
    let (kernel, values) = (engine.add_one(), engine.buffer(16));
    let mut encoders = Vec::new();
    let mut tickets = Vec::new();
    for round in 0..5 {
        let (list, ticket) = engine.work(&kernel, values, 10 * round);
        let mut encoder = engine.encoder();
        engine.hair.record(&mut encoder, &list).unwrap();
        encoders.push(encoder);
        tickets.push((ticket, 10 * round + 1));
    }
    engine.queue.submit(encoders.into_iter().map(wgpu::CommandEncoder::finish));
    engine.wait();
    for (ticket, expected) in tickets {
        assert_eq!(engine.hair.read(ticket), ReadBack::Ready(expected.to_le_bytes().to_vec()));
    }
    engine.assert_silent();
}

#[test]
fn what_is_destroyed_is_forgotten_with_its_bind_groups() {
    let Some(mut engine) = engine() else { return };
    let kernel = engine.add_one();
    for round in 0..4 {
        let values = engine.buffer(16);
        let (list, _) = engine.work(&kernel, values, round);
        engine.frame(&list);
        engine.hair.destroy(values.into());
        engine.frame(&list);
        drop(list);
        assert_eq!(engine.hair.memory().bytes, 0);
    }
    // Lists of other tests may be of an older epoch, and keep what they could name.
    while engine.hair.bind_groups.count() > 0 {
        engine.hair.record(&mut engine.device.create_command_encoder(&Default::default()), &PassList::new()).unwrap();
    }
    engine.assert_silent();
}

#[test]
fn imports_are_what_they_are() {
    let Some(mut engine) = engine() else { return };
    let buffer = |size, usage| {
        engine.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let [copied, vertices] = [wgpu::BufferUsages::COPY_SRC, wgpu::BufferUsages::VERTEX].map(|usage| buffer(16, usage));
    let [empty, odd] = [0, 6].map(|size| buffer(size, wgpu::BufferUsages::VERTEX));
    for wrong in [empty, odd] {
        assert!(matches!(engine.hair.import_buffer("engine", wrong), Err(Error::Rule { .. })));
    }
    let copied = engine.hair.import_buffer("engine", copied).unwrap();
    let vertices = engine.hair.import_buffer("engine", vertices).unwrap();
    let desc = engine.hair.catalog.buffer_desc(copied).unwrap();
    assert_eq!((desc.bytes, desc.uses), (16, BufferUses::COPY_SOURCE));
    let mut list = PassList::new();
    list.copy(copied, vertices, 16);
    let error = engine.hair.record(&mut engine.device.create_command_encoder(&Default::default()), &list).unwrap_err();
    assert!(matches!(error, Error::Rule { .. }), "{error}");
    assert_eq!(engine.hair.memory().bytes, 0, "imports are the engine's");
    engine.assert_silent();
}

/// A texture of an engine's.
fn texture(engine: &Engine, change: impl FnOnce(&mut wgpu::TextureDescriptor)) -> wgpu::Texture {
    let mut descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 8, height: 4, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    change(&mut descriptor);
    engine.device.create_texture(&descriptor)
}

#[test]
fn textures_that_the_contract_does_not_have_are_refused() {
    let Some(mut engine) = engine() else { return };
    let bound = wgpu::TextureUsages::TEXTURE_BINDING;
    let wrong = [
        texture(&engine, |desc| desc.sample_count = 4),
        texture(&engine, |desc| desc.size.depth_or_array_layers = 2),
        texture(&engine, |desc| (desc.dimension, desc.usage) = (wgpu::TextureDimension::D3, bound)),
        texture(&engine, |desc| {
            (desc.dimension, desc.size.height, desc.usage) = (wgpu::TextureDimension::D1, 1, bound)
        }),
        texture(&engine, |desc| desc.format = wgpu::TextureFormat::Rgba32Float),
        texture(&engine, |desc| desc.format = wgpu::TextureFormat::Depth24PlusStencil8),
    ];
    for wrong in wrong {
        let error = engine.hair.import_texture("engine", wrong).unwrap_err();
        assert!(matches!(error, Error::Rule { .. }), "{error}");
    }
    let mipped = texture(&engine, |desc| desc.mip_level_count = 3);
    let id = engine.hair.import_texture("engine", mipped).unwrap();
    let desc = engine.hair.catalog.texture_desc(id).unwrap();
    let uses = TextureUses::TARGET | TextureUses::SAMPLED;
    assert_eq!((desc.size, desc.format, desc.uses), ([8, 4], Format::Rgba8, uses));
    engine.frame(&clear(id));
    engine.wait();
    engine.assert_silent();
}

fn clear(target: tressfx_core::id::TextureId) -> PassList {
    let mut list = PassList::new();
    list.raster(RasterPass::new("test.clear").color(target, Load::Clear([1.0; 4])));
    list
}

#[test]
fn limits_of_wgpu_are_errors_before_it_sees_them() {
    let Some(mut engine) = engine() else { return };
    let mut target = || engine.hair.create_texture(&TextureDesc::new("test.target", [4; 2], Format::Rgba16F)).unwrap();
    let targets = [target(), target(), target(), target(), target()];
    let pass = |count| {
        let pass = RasterPass::new("test.clear");
        targets[..count].iter().fold(pass, |pass, &target| pass.color(target, Load::Clear([0.5; 4])))
    };
    let mut list = PassList::new();
    list.raster(pass(4));
    engine.frame(&list);
    list.raster(pass(5));
    let mut encoder = engine.encoder();
    let error = engine.hair.record(&mut encoder, &list).unwrap_err();
    assert!(error.to_string().contains("5 colour targets"), "{error}");
    // 8 bytes a texel: more than the 256 MiB of a buffer.
    let large = TextureDesc::new("test.large", [8192, 4200], Format::Rgba16F);
    if let Ok(large) = engine.hair.create_texture(&large) {
        let mut list = PassList::new();
        list.read_texture(large);
        let error = engine.hair.record(&mut encoder, &list).unwrap_err();
        assert!(error.to_string().contains("bytes come back"), "{error}");
    }
    engine.queue.submit([encoder.finish()]);
    engine.wait();
    engine.assert_silent();
}

#[test]
fn uploads_begin_at_multiples_of_four_and_may_be_of_any_size() {
    let Some(mut engine) = engine() else { return };
    let values = engine.buffer(16);
    let mut list = PassList::new();
    list.upload(values, 0, &[1u32, 2, 3, 4]);
    list.push(Command::Upload { dst: values, offset: 0, data: 2..6 });
    let mut encoder = engine.encoder();
    assert!(matches!(engine.hair.record(&mut encoder, &list), Err(Error::Rule { .. })));
    // More than one block of the belt.
    let words: Vec<u32> = (0..20_000_000).collect();
    let large = engine.buffer(4 * words.len() as u64);
    let mut list = PassList::new();
    list.upload(values, 0, &[7u32]);
    list.upload(large, 0, &words);
    let edge = 4 * ((64 << 20) / 4 - 3);
    let ticket = list.read_buffer(large, edge, 24);
    engine.frame(&list);
    engine.wait();
    let first = edge as u32 / 4;
    let expected: Vec<u8> = (first..first + 6).flat_map(u32::to_le_bytes).collect();
    assert_eq!(engine.hair.read(ticket), ReadBack::Ready(expected));
    engine.assert_silent();
}

#[test]
fn caps_are_those_of_the_device() {
    let Some(mut engine) = engine() else { return };
    let (caps, limits) = (engine.hair.caps().clone(), engine.device.limits());
    assert_eq!(caps.max_group_threads, limits.max_compute_invocations_per_workgroup);
    assert_eq!(caps.max_group_memory_bytes, limits.max_compute_workgroup_storage_size);
    assert_eq!(caps.binding_alignment, 256, "the device was made with default limits");
    assert!(!caps.r11g11b10_targets, "the engine did not ask for them");
    let texture = TextureDesc::new("test.target", [4; 2], Format::R11G11B10F);
    engine.hair.create_texture(&texture).unwrap();
    let error = engine.hair.create_texture(&texture.with_uses(TextureUses::TARGET)).unwrap_err();
    assert!(matches!(error, Error::Unsupported { need: Need::Target(_), .. }), "{error}");
    engine.assert_silent();
}

#[test]
fn every_blend_has_a_word() {
    for blend in [Blend::Replace, Blend::Over, Blend::Add, Blend::Multiply, Blend::Min, Blend::Max] {
        assert_eq!(crate::tables::blend_state(blend).unwrap().is_none(), blend == Blend::Replace);
    }
}

#[test]
fn a_backend_goes_to_other_threads() {
    fn goes<T: Send + Sync>() {}
    goes::<WgpuBackend>();
}
