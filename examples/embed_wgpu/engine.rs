//! A small engine on wgpu: an opaque pass into light and depth, and a last pass that develops the light.

use std::borrow::Cow;

use anyhow::{Context, Result};
use tressfx_backend_wgpu::wgpu::{self, util::DeviceExt};
use tressfx_core::shader::{Shader, ShaderSource, Specialization};
use tressfx_examples::{Shade, Stage, Vertex};

const LIGHT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Everything that the engine has; it does not know of hair.
pub(crate) struct Engine {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// Linear light: drawn to by the engine and by the hair, then sampled.
    pub(crate) light: wgpu::Texture,
    /// Drawn to by the engine, sampled by the hair.
    pub(crate) depth: wgpu::Texture,
    picture: wgpu::Texture,
    stage: Pass,
    develop: Pass,
    shade: wgpu::Buffer,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
}

/// A pipeline and what it binds.
struct Pass {
    pipeline: wgpu::RenderPipeline,
    bound: wgpu::BindGroup,
}

impl Engine {
    pub(crate) fn new(stage: &Stage) -> Result<Self> {
        let (device, queue) = open()?;
        use wgpu::TextureUsages as Usage;
        // What the hair asks for: it draws to the light and samples the depth.
        let light =
            texture(&device, "light", stage.view.size(), LIGHT, Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING);
        let depth =
            texture(&device, "depth", stage.view.size(), DEPTH, Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING);
        let picture =
            texture(&device, "picture", stage.view.size(), PICTURE, Usage::RENDER_ATTACHMENT | Usage::COPY_SRC);
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("stage"), contents, usage })
        };
        let shade = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shade"),
            size: size_of::<Shade>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view = light.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self {
            stage: stage_pass(&device, &shade)?,
            develop: develop_pass(&device, &view)?,
            vertices: buffer(bytemuck::cast_slice(&stage.vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(bytemuck::cast_slice(&stage.indices), wgpu::BufferUsages::INDEX),
            index_count: stage.indices.len() as u32,
            light,
            depth,
            picture,
            shade,
            device,
            queue,
        })
    }

    /// Begins a frame.
    pub(crate) fn begin(&self, shade: &Shade) -> wgpu::CommandEncoder {
        self.queue.write_buffer(&self.shade, 0, bytemuck::bytes_of(shade));
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") })
    }

    /// Clears the targets and draws what is not hair.
    pub(crate) fn draw_stage(&self, encoder: &mut wgpu::CommandEncoder) {
        let dusk = wgpu::Color { r: 0.10, g: 0.115, b: 0.14, a: 1.0 };
        let (light, depth) = (view(&self.light), view(&self.depth));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("stage"),
            color_attachments: &[Some(target(&light, dusk))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                // The view has its far plane at 0, and the hair reads this depth after the pass.
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.stage.pipeline);
        pass.set_bind_group(0, &self.stage.bound, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.index_count, 0, 0..1);
    }

    /// From light to a picture.
    pub(crate) fn develop(&self, encoder: &mut wgpu::CommandEncoder) {
        let picture = view(&self.picture);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("develop"),
            color_attachments: &[Some(target(&picture, wgpu::Color::BLACK))],
            ..Default::default()
        });
        pass.set_pipeline(&self.develop.pipeline);
        pass.set_bind_group(0, &self.develop.bound, &[]);
        pass.draw(0..3, 0..1);
    }

    /// The picture of the newest frame, rows tightly packed.
    pub(crate) fn read_picture(&self) -> Result<Vec<u8>> {
        let size = self.picture.size();
        let row = 4 * size.width;
        let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(padded) * u64::from(size.height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: &copy, layout };
        encoder.copy_texture_to_buffer(self.picture.as_image_copy(), to, size);
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("the device is alive"));
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        let bytes = copy.get_mapped_range(..)?;
        Ok(bytes.chunks(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
    }
}

/// The first adapter that wgpu offers, with the limits that every WebGPU device has: the hair fits into them.
fn open() -> Result<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.context("no adapter: install the driver of the graphics card, or a software Vulkan")?;
    let descriptor = wgpu::DeviceDescriptor { label: Some("engine"), ..Default::default() };
    Ok(pollster::block_on(adapter.request_device(&descriptor))?)
}

fn texture(
    device: &wgpu::Device,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn target(view: &wgpu::TextureView, clear: wgpu::Color) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

fn stage_pass(device: &wgpu::Device, shade: &wgpu::Buffer) -> Result<Pass> {
    let attributes = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4];
    let corners = wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    let nearer = wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    };
    let source = include_str!("../shaders/stage.wgsl");
    let pipeline = pipeline(device, "stage", source, ["corner", "paint"], &[Some(corners)], Some(nearer), LIGHT)?;
    let bound = bind(device, &pipeline, shade.as_entire_binding());
    Ok(Pass { pipeline, bound })
}

fn develop_pass(device: &wgpu::Device, light: &wgpu::TextureView) -> Result<Pass> {
    let source = include_str!("../shaders/develop.wgsl");
    let pipeline = pipeline(device, "develop", source, ["corner", "develop"], &[], None, PICTURE)?;
    let bound = bind(device, &pipeline, wgpu::BindingResource::TextureView(light));
    Ok(Pass { pipeline, bound })
}

fn bind(device: &wgpu::Device, pipeline: &wgpu::RenderPipeline, resource: wgpu::BindingResource) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource }],
    })
}

fn pipeline(
    device: &wgpu::Device,
    label: &'static str,
    source: &'static str,
    [vertex, fragment]: [&str; 2],
    buffers: &[Option<wgpu::VertexBufferLayout>],
    depth_stencil: Option<wgpu::DepthStencilState>,
    target: wgpu::TextureFormat,
) -> Result<wgpu::RenderPipeline> {
    // An engine has its own way to shaders; here it is the library's.
    let source = ShaderSource { label, root: (label, source), library: &[] };
    let shader = Shader::new(&source, &Specialization::new())?;
    let source = wgpu::ShaderSource::Naga(Cow::Owned(shader.module().clone()));
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source });
    Ok(device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers,
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: &[Some(target.into())],
        }),
        multiview_mask: None,
        cache: None,
    }))
}
