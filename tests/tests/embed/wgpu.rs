//! Inside of an engine on wgpu.

use std::collections::HashMap;

use tressfx_backend_wgpu::{WgpuBackend, wgpu};
use tressfx_conformance::embed::{Embed, TEXTURE_SIZE};
use tressfx_core::error::Error;
use tressfx_core::id::{BufferId, TextureId};

tressfx_conformance::embed_suite!(|| Engine::new());

struct Engine {
    device: wgpu::Device,
    queue: wgpu::Queue,
    hair: WgpuBackend,
    buffers: HashMap<BufferId, wgpu::Buffer>,
    textures: HashMap<TextureId, wgpu::Texture>,
}

impl Engine {
    fn new() -> Result<Self, Error> {
        let opened = WgpuBackend::headless()?;
        let (device, queue) = (opened.device().clone(), opened.queue().clone());
        let hair = WgpuBackend::new(device.clone(), queue.clone());
        Ok(Self { device, queue, hair, buffers: HashMap::new(), textures: HashMap::new() })
    }
}

impl Embed for Engine {
    type Backend = WgpuBackend;

    fn backend(&mut self) -> &mut WgpuBackend {
        &mut self.hair
    }

    fn buffer(&mut self, words: [u32; 4]) -> BufferId {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let (label, mapped_at_creation) = (Some("engine"), false);
        let desc = wgpu::BufferDescriptor { label, size: 16, usage, mapped_at_creation };
        let buffer = self.device.create_buffer(&desc);
        self.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(&words));
        let id = self.hair.import_buffer("engine", buffer.clone()).expect("an import");
        self.buffers.insert(id, buffer);
        id
    }

    fn texture(&mut self) -> TextureId {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("engine"),
            size: wgpu::Extent3d { width: TEXTURE_SIZE[0], height: TEXTURE_SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let id = self.hair.import_texture("engine", texture.clone()).expect("an import");
        self.textures.insert(id, texture);
        id
    }

    fn import_again(&mut self, texture: TextureId) -> TextureId {
        self.hair.import_texture("engine", self.textures[&texture].clone()).expect("an import")
    }

    fn begin(&mut self) -> Box<wgpu::CommandEncoder> {
        Box::new(self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default()))
    }

    fn clear_word(&mut self, encoder: &mut wgpu::CommandEncoder, buffer: BufferId, word: u64) {
        encoder.clear_buffer(&self.buffers[&buffer], 4 * word, Some(4));
    }

    fn copy_texel(&mut self, encoder: &mut wgpu::CommandEncoder, texture: TextureId, buffer: BufferId) {
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: None, rows_per_image: None };
        encoder.copy_texture_to_buffer(
            self.textures[&texture].as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &self.buffers[&buffer], layout },
            wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        );
    }

    fn submit(&mut self, encoder: Box<wgpu::CommandEncoder>) {
        self.queue.submit([encoder.finish()]);
    }

    fn wait(&mut self) {
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
    }

    fn discard(&mut self, encoder: Box<wgpu::CommandEncoder>) {
        drop(encoder);
    }
}
