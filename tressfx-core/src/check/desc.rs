//! What is to be made, against what a device can do.

use crate::backend::{
    Blend, BufferDesc, BufferUses, Caps, ComputeDesc, Depth, Format, RasterDesc, TextureDesc, TextureUses,
};
use crate::error::{Error, Need, Result};
use crate::shader::{Shader, SlotKind};

impl BufferDesc {
    /// Checks it before a buffer is made.
    ///
    /// # Errors
    /// [`Error::Rule`] for a size that is none, [`Error::Unsupported`] for one that the device does not have.
    pub fn check(&self, caps: &Caps) -> Result<()> {
        if self.bytes == 0 || !self.bytes.is_multiple_of(4) {
            return Err(Error::rule(self.label, format!("{} bytes: a multiple of 4, at least 4, is", self.bytes)));
        }
        if self.uses == BufferUses::default() {
            return Err(Error::rule(self.label, "it has no use"));
        }
        caps.check(self.label, &[Need::BufferBytes(self.bytes)])?;
        if self.uses.contains(BufferUses::STORAGE) {
            caps.check(self.label, &[Need::StorageBindingBytes(self.bytes)])?;
        }
        Ok(())
    }
}

impl TextureDesc {
    /// Checks it before a texture is made.
    ///
    /// # Errors
    /// [`Error::Rule`] for a size or uses that are none, [`Error::Unsupported`] for what the device does not have.
    pub fn check(&self, caps: &Caps) -> Result<()> {
        if self.size.contains(&0) {
            return Err(Error::rule(self.label, format!("a size of {:?}", self.size)));
        }
        if self.uses == TextureUses::default() {
            return Err(Error::rule(self.label, "it has no use"));
        }
        caps.check(self.label, &[Need::TextureEdge(self.size[0].max(self.size[1]))])?;
        if self.uses.contains(TextureUses::STORAGE) && !self.format.is_storage() {
            return Err(Error::rule(self.label, format!("no compute pass writes {:?}", self.format)));
        }
        if self.uses.contains(TextureUses::COPY_DESTINATION) && self.format.is_depth() {
            return Err(Error::rule(self.label, "depth is not copied to"));
        }
        if self.uses.contains(TextureUses::TARGET) {
            caps.check(self.label, &[Need::Target(self.format)])?;
        }
        Ok(())
    }
}

impl ComputeDesc {
    /// Checks it before a pipeline is made.
    ///
    /// # Errors
    /// [`Error::Shader`] if the shader has not one compute entry point, [`Error::Unsupported`] for what the device does not
    /// have.
    pub fn check(&self, caps: &Caps) -> Result<()> {
        let shader = &self.shader;
        let (size, memory) = shader.group()?;
        let threads = size.iter().try_fold(1u32, |all, &edge| all.checked_mul(edge)).unwrap_or(u32::MAX);
        caps.check(
            shader.label,
            &[
                Need::Compute,
                Need::GroupThreads(threads),
                Need::GroupSize { axis: 0, threads: size[0] },
                Need::GroupSize { axis: 1, threads: size[1] },
                Need::GroupSize { axis: 2, threads: size[2] },
                Need::GroupMemory(memory),
            ],
        )?;
        slots(shader, caps)
    }
}

impl RasterDesc {
    /// Checks it before a pipeline is made.
    ///
    /// # Errors
    /// [`Error::Shader`] if stages are missing or do not fit each other, [`Error::Rule`] for targets that the shader or the
    /// blend does not fit, [`Error::Unsupported`] for what the device does not have.
    pub fn check(&self, caps: &Caps) -> Result<()> {
        let shader = &self.shader;
        let colors = shader.colors()?;
        caps.check(shader.label, &[Need::Raster, Need::ColorTargets(self.targets.len() as u32)])?;
        if shader.writes_in_fragments() {
            caps.check(shader.label, &[Need::FragmentWrites])?;
        }
        if let Some(slot) = shader.slots.iter().find(|slot| slot.kind.is_written() && !slot.is_storage()) {
            return Err(Error::rule(shader.label, format!("`{}`: only compute passes write textures", slot.name)));
        }
        if self.targets.is_empty() && self.depth == Depth::Off {
            return Err(Error::rule(shader.label, "it has no target"));
        }
        for (index, &(format, blend)) in self.targets.iter().enumerate() {
            caps.check(shader.label, &[Need::Target(format)])?;
            let color = colors.iter().find(|(location, _)| *location == index as u32).map(|(_, ty)| ty.as_str());
            target(format, blend, color)
                .map_err(|message| Error::rule(shader.label, format!("target {index}: {message}")))?;
        }
        slots(shader, caps)
    }
}

/// A colour target, and the type that the shader gives it.
fn target(format: Format, blend: Blend, color: Option<&str>) -> Result<(), String> {
    if format.is_depth() {
        return Err(String::from("depth is no colour"));
    }
    if blend != Blend::Replace && !format.is_blendable() {
        return Err(format!("{format:?} does not blend"));
    }
    let fits = match color {
        None => false,
        Some(ty) if format.is_uint() => ty == "vec4<u32>" || ty == "u32",
        // What blends needs its alpha; else one channel is enough for a format of one.
        Some("vec4<f32>") => true,
        Some(ty) => blend == Blend::Replace && channels(format) == 1 && ty == "f32",
    };
    if fits {
        Ok(())
    } else {
        Err(format!("it has the format {format:?}, the shader gives {}", color.unwrap_or("nothing")))
    }
}

fn channels(format: Format) -> u32 {
    match format {
        Format::R16F | Format::R32F | Format::R32Uint => 1,
        Format::Rg16F | Format::Rg32F => 2,
        Format::R11G11B10F => 3,
        _ => 4,
    }
}

/// What the shader binds.
fn slots(shader: &Shader, caps: &Caps) -> Result<()> {
    let needs = [Need::StorageBuffers(shader.storage_buffers()), Need::StorageTextures(shader.storage_textures())];
    caps.check(shader.label, &needs)?;
    for slot in &shader.slots {
        let need = match slot.kind {
            SlotKind::Uniform => Need::UniformBindingBytes(slot.min_bytes),
            SlotKind::Read | SlotKind::ReadWrite => Need::StorageBindingBytes(slot.min_bytes),
            SlotKind::ReadWriteTexture(_) => Need::ReadWriteTextures,
            _ => continue,
        };
        caps.check(shader.label, &[need])?;
    }
    Ok(())
}
