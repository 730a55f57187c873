//! Buffers and textures: made here, or imported from an engine.

use tressfx_core::backend::{BufferDesc, Need, TextureDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::id::{BufferId, Resource, TextureId};

use crate::WgpuBackend;
use crate::tables::{buffer_usages, texture_format};

/// A buffer and how many of its bytes count as ours.
#[derive(Debug)]
pub(crate) struct Buffer {
    pub(crate) buffer: wgpu::Buffer,
    owned_bytes: u64,
}

/// A texture, its view, and how many of its bytes count as ours.
#[derive(Debug)]
pub(crate) struct Texture {
    pub(crate) texture: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
    pub(crate) label: Label,
    owned_bytes: u64,
}

impl WgpuBackend {
    /// Makes an engine's buffer known. It needs the usages that its passes ask for; it stays the engine's.
    pub fn import_buffer(&mut self, buffer: wgpu::Buffer) -> BufferId {
        self.buffers.insert(Buffer { buffer, owned_bytes: 0 }).into()
    }

    /// Makes an engine's texture known: 2D, one layer, one sample; its first mip level is used. It stays the engine's.
    pub fn import_texture(&mut self, label: Label, texture: wgpu::Texture) -> TextureId {
        let view = texture.create_view(&wgpu::TextureViewDescriptor { mip_level_count: Some(1), ..Default::default() });
        self.textures.insert(Texture { texture, view, label, owned_bytes: 0 }).into()
    }

    pub(crate) fn make_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        self.caps.check(desc.label, &[Need::StorageBindingBytes(desc.bytes)])?;
        let buffer = self.guarded(desc.label, desc.bytes, |backend| {
            backend.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(desc.label),
                size: desc.bytes,
                usage: buffer_usages(desc.usage),
                mapped_at_creation: false,
            })
        })?;
        self.memory.add(desc.bytes);
        Ok(self.buffers.insert(Buffer { buffer, owned_bytes: desc.bytes }).into())
    }

    pub(crate) fn make_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        self.caps.check(desc.label, &[Need::TextureEdge(desc.size[0].max(desc.size[1]))])?;
        let texture = self.guarded(desc.label, desc.bytes(), |backend| {
            backend.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(desc.label),
                size: wgpu::Extent3d { width: desc.size[0], height: desc.size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: texture_format(desc.format),
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        })?;
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        self.memory.add(desc.bytes());
        let texture = Texture { texture, view, label: desc.label, owned_bytes: desc.bytes() };
        Ok(self.textures.insert(texture).into())
    }

    /// Drops our reference: wgpu frees what it refers to once the GPU has finished with it.
    pub(crate) fn forget(&mut self, resource: Resource) {
        let bytes = match resource {
            Resource::Buffer(id) => self.buffers.remove(id.0).map(|buffer| buffer.owned_bytes),
            Resource::Texture(id) => self.textures.remove(id.0).map(|texture| texture.owned_bytes),
        };
        self.memory.remove(bytes.unwrap_or(0));
        self.bind_groups.retain(|(_, bindings), _| !bindings.resources().contains(&resource));
    }

    pub(crate) fn buffer(&self, id: BufferId, what: &str) -> &wgpu::Buffer {
        &self.buffers.expect(id.0, what).buffer
    }

    /// What a resource takes in memory, whoever owns it.
    pub(crate) fn bytes(&self, resource: Resource) -> u64 {
        match resource {
            Resource::Buffer(id) => self.buffer(id, "record").size(),
            Resource::Texture(id) => {
                let texture = &self.texture(id, "record").texture;
                let texel = texture.format().block_copy_size(None).unwrap_or(0);
                u64::from(texture.width()) * u64::from(texture.height()) * u64::from(texel)
            }
        }
    }

    pub(crate) fn texture(&self, id: TextureId, what: &str) -> &Texture {
        self.textures.expect(id.0, what)
    }
}
