//! Buffers and textures: made here, or imported from an engine.

use tressfx_core::backend::{BufferDesc, Format, TextureDesc, TextureUses};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::{BufferId, TextureId};

use crate::WgpuBackend;
use crate::tables::{buffer_usages, buffer_uses, format, texture_format, texture_usages, texture_uses};

/// A texture and its view.
#[derive(Debug)]
pub(crate) struct Texture {
    pub(crate) texture: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
}

impl WgpuBackend {
    /// Makes an engine's buffer known, with the size and the usages that it has. It stays the engine's: of this device, and
    /// neither mapped nor destroyed while an encoder that names it is submitted.
    ///
    /// # Errors
    /// [`Error::Rule`] if its size is not a multiple of 4, or 0.
    pub fn import_buffer(&mut self, label: Label, buffer: wgpu::Buffer) -> Result<BufferId> {
        let bytes = buffer.size();
        if bytes == 0 || !bytes.is_multiple_of(4) {
            return Err(Error::rule(label, format!("{bytes} bytes: a multiple of 4, at least 4, is")));
        }
        let desc = BufferDesc::new(label, bytes, buffer_uses(buffer.usage()));
        Ok(self.catalog.import_buffer(&desc, buffer))
    }

    /// Makes an engine's texture known, with the size, the format and the usages that it has; its first mip level is used. It
    /// stays the engine's: of this device, and not destroyed while an encoder that names it is submitted.
    ///
    /// # Errors
    /// [`Error::Rule`] for what the contract does not have: other formats, more than one layer or sample, 3D.
    pub fn import_texture(&mut self, label: Label, texture: wgpu::Texture) -> Result<TextureId> {
        let desc = self.describe(label, &texture).map_err(|message| Error::rule(label, message))?;
        let view = self.guarded(label, 0, |_| Ok(view(&texture)))?;
        Ok(self.catalog.import_texture(&desc, Texture { texture, view }))
    }

    /// An engine's texture in words of the contract.
    fn describe(&self, label: Label, texture: &wgpu::Texture) -> Result<TextureDesc, String> {
        if texture.dimension() != wgpu::TextureDimension::D2 || texture.depth_or_array_layers() != 1 {
            let layers = texture.depth_or_array_layers();
            return Err(format!("{:?} of {layers} layers: one 2D layer is", texture.dimension()));
        }
        if texture.sample_count() != 1 {
            return Err(format!("{} samples: one is", texture.sample_count()));
        }
        if texture.usage().contains(wgpu::TextureUsages::TRANSIENT_ATTACHMENT) {
            return Err(String::from("it does not outlive a pass"));
        }
        let format = format(texture.format()).ok_or_else(|| format!("the contract has no {:?}", texture.format()))?;
        let size = [texture.width(), texture.height()];
        Ok(TextureDesc::new(label, size, format).with_uses(self.uses(texture.usage(), format)))
    }

    /// What an engine's texture is for: the contract allows less than WebGPU.
    fn uses(&self, usages: wgpu::TextureUsages, format: Format) -> TextureUses {
        let mut theirs = texture_usages(texture_uses(usages));
        if !format.is_storage() {
            theirs.remove(wgpu::TextureUsages::STORAGE_BINDING);
        }
        if format.is_depth() {
            theirs.remove(wgpu::TextureUsages::COPY_DST);
        }
        if format == Format::R11G11B10F && !self.catalog.caps().r11g11b10_targets {
            theirs.remove(wgpu::TextureUsages::RENDER_ATTACHMENT);
        }
        texture_uses(theirs)
    }

    pub(crate) fn make_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        desc.check(self.catalog.caps())?;
        self.sweep();
        let buffer = self.guarded(desc.label, desc.bytes, |backend| {
            Ok(backend.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(desc.label),
                size: desc.bytes,
                usage: buffer_usages(desc.uses),
                mapped_at_creation: false,
            }))
        })?;
        Ok(self.catalog.add_buffer(desc, buffer))
    }

    pub(crate) fn make_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        desc.check(self.catalog.caps())?;
        self.sweep();
        let [width, height] = desc.size;
        let format = texture_format(desc.format)?;
        let texture = self.guarded(desc.label, desc.bytes(), |backend| {
            let texture = backend.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(desc.label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: texture_usages(desc.uses),
                view_formats: &[],
            });
            let view = view(&texture);
            Ok(Texture { texture, view })
        })?;
        Ok(self.catalog.add_texture(desc, texture))
    }

    /// Drops what no list can name any more; wgpu frees it once the GPU has finished with it.
    pub(crate) fn sweep(&mut self) {
        let swept = self.catalog.sweep();
        if !swept.is_empty() {
            self.bind_groups.forget(&swept);
        }
    }
}

/// The whole of a texture, or its first mip level.
fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor { mip_level_count: Some(1), ..Default::default() })
}
