//! The contract on a GPU: order, data, depth, blending, read-back.

mod support;

use std::sync::Arc;

use tressfx_conformance::run_and_read;
use tressfx_core::backend::{
    Backend, Blend, BufferDesc, BufferUse, ComputeDesc, Depth, DepthOrder, Format, Kernel, RasterDesc, TextureDesc,
};
use tressfx_core::error::Error;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Draw, Grid, Load, PassList, RasterPass};
use tressfx_core::shader::{Shader, ShaderSource, Specialization};

use support::gpu;

const DOUBLE: &str = "
    import package::grid::{thread_index, GROUP};
    @group(0) @binding(0) var<uniform> count: vec4<u32>;
    @group(0) @binding(2) var<storage, read_write> values: array<u32>;
    @compute @workgroup_size(GROUP)
    fn double(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
        let i = thread_index(group, groups, lane);
        if (i < count.x) { values[i] *= 2u; }
    }";

/// Covers the upper half of the target at a depth and in a colour that the caller gives.
const UPPER_HALF: &str = "
    struct Paint { color: vec4<f32>, depth: vec4<f32> }
    @group(0) @binding(0) var<uniform> paint: Paint;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
        let corner = vec2<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0);
        return vec4<f32>(corner, paint.depth.x, 1.0);
    }
    @fragment fn fragment() -> @location(0) vec4<f32> { return paint.color; }";

fn shader(text: &'static str) -> Arc<Shader> {
    let source = ShaderSource { label: "test.kernel", root: ("kernel", text), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).unwrap())
}

fn buffer(backend: &mut dyn Backend, bytes: u64, usage: BufferUse) -> BufferId {
    backend.create_buffer(&BufferDesc { label: "test.buffer", bytes, usage }).unwrap()
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytemuck::pod_collect_to_vec(bytes)
}

#[test]
fn commands_take_effect_in_the_order_of_the_list() {
    let Some(mut backend) = gpu() else { return };
    let kernel = backend.create_compute(&ComputeDesc { shader: shader(DOUBLE) }).unwrap();
    let count = buffer(&mut *backend, 16, BufferUse::Uniform);
    let values = buffer(&mut *backend, 4 * 200, BufferUse::Storage);
    let other = buffer(&mut *backend, 4 * 200, BufferUse::Storage);
    let bindings = kernel.bind(&[("count", count.into()), ("values", values.into())]);
    let mut list = PassList::new();
    list.upload(count, 0, &[150u32, 0, 0, 0]);
    list.upload(values, 0, &(0..200u32).collect::<Vec<_>>());
    list.compute(&kernel, &bindings, Grid::for_threads(150, 64));
    list.upload(count, 0, &[100u32, 0, 0, 0]);
    list.compute(&kernel, &bindings, Grid::for_threads(100, 64));
    list.copy(values, other, 4 * 200);
    list.clear(values, 4, 8);
    list.upload(values, 0, &[7u32]);
    let [first, second] = [other, values].map(|buffer| list.read_buffer(buffer, 0, 4 * 200));
    let copied = words(&run_and_read(&mut *backend, &list, first));
    let expected = |i: u32| {
        if i < 100 {
            4 * i
        } else if i < 150 {
            2 * i
        } else {
            i
        }
    };
    assert_eq!(copied, (0..200).map(expected).collect::<Vec<_>>());
    let cleared = words(&backend.read(second).unwrap());
    assert_eq!(cleared[..4], [7, 0, 0, 12]);
    assert_eq!(backend.read(second), None, "read-backs are given once");
    if backend.caps().timestamps {
        let timings = backend.timings();
        assert_eq!(timings.iter().map(|timing| timing.label).collect::<Vec<_>>(), ["test.kernel"; 2]);
        assert!(timings.iter().all(|timing| timing.nanoseconds > 0.0 && timing.nanoseconds < 1e9), "{timings:?}");
    }
}

#[test]
fn buffers_begin_as_zeros() {
    let Some(mut backend) = gpu() else { return };
    let fresh = buffer(&mut *backend, 1 << 16, BufferUse::Storage);
    let mut list = PassList::new();
    let ticket = list.read_buffer(fresh, 0, 1 << 16);
    assert!(run_and_read(&mut *backend, &list, ticket).iter().all(|&byte| byte == 0));
}

struct Canvas {
    color: TextureId,
    depth: TextureId,
    order: DepthOrder,
}

impl Canvas {
    const SIZE: [u32; 2] = [5, 4];

    fn new(backend: &mut dyn Backend, order: DepthOrder) -> Self {
        let mut texture =
            |format| backend.create_texture(&TextureDesc { label: "test.texture", size: Self::SIZE, format }).unwrap();
        Self { color: texture(Format::Rgba8), depth: texture(Format::Depth32F), order }
    }

    fn draw(&self, backend: &mut dyn Backend, list: &mut PassList, blend: Blend, layers: &[([f32; 4], f32)]) {
        let desc = RasterDesc {
            shader: shader(UPPER_HALF),
            targets: vec![(Format::Rgba8, blend)],
            depth: Depth::TestWrite(self.order),
        };
        let kernel = backend.create_raster(&desc).unwrap();
        let draws = layers.iter().map(|&(color, depth)| paint(backend, list, &kernel, color, depth)).collect();
        list.raster(RasterPass {
            label: "test.pass",
            colors: vec![(self.color, Load::Clear([0.0, 0.0, 1.0, 1.0]))],
            depth: Some((self.depth, Load::Clear(self.order.far()))),
            draws,
        });
    }
}

fn paint(backend: &mut dyn Backend, list: &mut PassList, kernel: &Kernel, color: [f32; 4], depth: f32) -> Draw {
    let uniform = buffer(backend, 32, BufferUse::Uniform);
    list.upload(uniform, 0, &color);
    list.upload(uniform, 16, &[depth, 0.0, 0.0, 0.0]);
    let bindings = kernel.bind(&[("paint", uniform.into())]);
    Draw { kernel: kernel.clone(), bindings, vertices: 3, instances: 1 }
}

fn picture(blend: Blend, order: DepthOrder, layers: &[([f32; 4], f32)]) -> Option<Vec<[u8; 4]>> {
    let mut backend = gpu()?;
    let canvas = Canvas::new(&mut *backend, order);
    let mut list = PassList::new();
    canvas.draw(&mut *backend, &mut list, blend, layers);
    let ticket = list.read_texture(canvas.color);
    let bytes = run_and_read(&mut *backend, &list, ticket);
    assert_eq!(bytes.len() as u32, 4 * Canvas::SIZE[0] * Canvas::SIZE[1], "rows come tightly packed");
    Some(bytes.chunks_exact(4).map(|texel| texel.try_into().unwrap()).collect())
}

const RED: [f32; 4] = [1.0, 0.0, 0.0, 1.0];
const GREEN: [f32; 4] = [0.0, 1.0, 0.0, 1.0];

#[test]
fn up_is_up_and_the_rest_stays_clear() {
    let Some(picture) = picture(Blend::Replace, DepthOrder::Standard, &[(RED, 0.5)]) else { return };
    assert_eq!(picture[0], [255, 0, 0, 255], "the upper left corner is covered");
    assert_eq!(picture[5 * 3], [0, 0, 255, 255], "the lower left corner is not");
}

#[test]
fn nearer_wins_in_both_depth_orders_whatever_comes_first() {
    for (order, near, far) in [(DepthOrder::Standard, 0.2, 0.8), (DepthOrder::Reverse, 0.8, 0.2)] {
        for layers in [[(RED, near), (GREEN, far)], [(GREEN, far), (RED, near)]] {
            let Some(picture) = picture(Blend::Replace, order, &layers) else { return };
            assert_eq!(picture[0], [255, 0, 0, 255], "{order:?}");
        }
    }
}

#[test]
fn over_lays_premultiplied_colour_over_what_was_there() {
    let layer = [0.5, 0.25, 0.0, 0.5];
    let Some(picture) = picture(Blend::Over, DepthOrder::Standard, &[(layer, 0.5)]) else { return };
    let expected = [127.5, 63.75, 127.5, 255.0];
    for (channel, expected) in picture[0].into_iter().zip(expected) {
        assert!((f32::from(channel) - expected).abs() <= 1.0, "{:?} is not {expected:?}", picture[0]);
    }
}

#[test]
fn what_a_device_cannot_do_is_an_error_and_not_a_crash() {
    let Some(mut backend) = gpu() else { return };
    let bytes = (backend.caps().max_buffer_bytes + 1).next_multiple_of(4);
    let error =
        backend.create_buffer(&BufferDesc { label: "test.huge", bytes, usage: BufferUse::Storage }).unwrap_err();
    assert!(matches!(error, Error::Unsupported { label: "test.huge", .. }), "{error}");
    let missing = tressfx_backend_wgpu::WgpuBackend::headless_on(Some("no such adapter")).unwrap_err();
    assert!(missing.to_string().contains("no adapter is named `no such adapter`; there are: "), "{missing}");
}

#[test]
fn memory_counts_what_is_made_and_destroyed() {
    let Some(mut backend) = gpu() else { return };
    let before = backend.memory();
    let made = buffer(&mut *backend, 1 << 20, BufferUse::Storage);
    assert_eq!(backend.memory().bytes, before.bytes + (1 << 20));
    backend.destroy(made.into());
    assert_eq!(backend.memory().bytes, before.bytes);
    assert!(backend.memory().peak >= before.bytes + (1 << 20));
}
