//! What a device can do.

use crate::error::{Error, Label, Need, Result};
use crate::format::Format;

/// What a device can do: numbers and yes or no, never the name of a vendor.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Caps {
    /// The adapter, for people to read.
    pub adapter: String,
    /// Whether it computes on the CPU: a software renderer.
    pub is_cpu: bool,
    /// Whether it runs compute passes.
    pub compute: bool,
    /// Whether it runs raster passes.
    pub raster: bool,
    /// Whether bytes can be read back.
    pub read_back: bool,
    /// Whether fragment shaders can write storage buffers.
    pub fragment_writes: bool,
    /// Whether [`Format::R11G11B10F`] can be drawn to.
    pub r11g11b10_targets: bool,
    /// Storage buffers that one stage can be given.
    pub max_storage_buffers_per_stage: u32,
    /// Textures that one compute pass can write.
    pub max_storage_textures_per_stage: u32,
    /// Whether a compute pass can read the texels of a texture that it writes, of every [storage format](Format::is_storage).
    pub read_write_textures: bool,
    /// Bytes of one storage binding.
    pub max_storage_binding_bytes: u64,
    /// Bytes of one uniform binding.
    pub max_uniform_binding_bytes: u64,
    /// What the offset of a binding must be a multiple of: a power of two.
    pub binding_alignment: u64,
    /// Bytes of one buffer.
    pub max_buffer_bytes: u64,
    /// Texels along an edge of a texture.
    pub max_texture_size: u32,
    /// Colour targets of a raster pass, of whatever formats.
    pub max_color_targets: u32,
    /// Threads of a compute group.
    pub max_group_threads: u32,
    /// Threads of a compute group along x, y and z.
    pub max_group_size: [u32; 3],
    /// Bytes that a compute group shares.
    pub max_group_memory_bytes: u32,
    /// Whether passes can be timed.
    pub timestamps: bool,
}

impl Caps {
    /// The limits that every WebGPU device has; the library fits into them.
    pub fn webgpu_default() -> Self {
        Self {
            adapter: String::from("WebGPU default limits"),
            is_cpu: false,
            compute: true,
            raster: true,
            read_back: true,
            fragment_writes: true,
            r11g11b10_targets: false,
            max_storage_buffers_per_stage: 8,
            max_storage_textures_per_stage: 4,
            read_write_textures: false,
            max_storage_binding_bytes: 128 << 20,
            max_uniform_binding_bytes: 64 << 10,
            binding_alignment: 256,
            max_buffer_bytes: 256 << 20,
            max_texture_size: 8192,
            // Eight, but of 32 bytes for a pixel, and there are formats that take 8.
            max_color_targets: 4,
            max_group_threads: 256,
            max_group_size: [256, 256, 64],
            max_group_memory_bytes: 16 << 10,
            timestamps: false,
        }
    }

    /// How much a need asks for, and how much of it the device has; 1 and 0 for yes and no.
    fn wanted_and_available(&self, need: Need) -> (u64, u64) {
        let have = |yes: bool| (1, u64::from(yes));
        match need {
            Need::Compute => have(self.compute),
            Need::Raster => have(self.raster),
            Need::ReadBack => have(self.read_back),
            Need::FragmentWrites => have(self.fragment_writes),
            Need::Target(Format::R11G11B10F) => have(self.r11g11b10_targets),
            Need::Target(_) => have(true),
            Need::StorageBuffers(count) => (count.into(), self.max_storage_buffers_per_stage.into()),
            Need::StorageTextures(count) => (count.into(), self.max_storage_textures_per_stage.into()),
            Need::ReadWriteTextures => have(self.read_write_textures),
            Need::StorageBindingBytes(bytes) => (bytes, self.max_storage_binding_bytes.min(self.max_buffer_bytes)),
            Need::UniformBindingBytes(bytes) => (bytes, self.max_uniform_binding_bytes.min(self.max_buffer_bytes)),
            Need::BufferBytes(bytes) => (bytes, self.max_buffer_bytes),
            Need::TextureEdge(texels) => (texels.into(), self.max_texture_size.into()),
            Need::ColorTargets(count) => (count.into(), self.max_color_targets.into()),
            Need::GroupThreads(threads) => (threads.into(), self.max_group_threads.into()),
            Need::GroupSize { axis, threads } => {
                (threads.into(), self.max_group_size.get(axis).copied().unwrap_or(0).into())
            }
            Need::GroupMemory(bytes) => (bytes.into(), self.max_group_memory_bytes.into()),
        }
    }

    /// Checks needs one by one.
    ///
    /// # Errors
    /// [`Error::Unsupported`] with the first need that is not met.
    pub fn check(&self, label: Label, needs: &[Need]) -> Result<()> {
        for &need in needs {
            let (want, have) = self.wanted_and_available(need);
            if have < want {
                return Err(Error::Unsupported { label, need, have });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_need_that_is_not_met_is_named() {
        let caps = Caps::webgpu_default();
        caps.check("hair", &[Need::StorageBuffers(8), Need::StorageBindingBytes(128 << 20)]).unwrap();
        let error = caps.check("hair", &[Need::StorageBuffers(8), Need::StorageBindingBytes(1 << 30)]).unwrap_err();
        assert_eq!(
            error,
            Error::Unsupported { label: "hair", need: Need::StorageBindingBytes(1 << 30), have: 128 << 20 }
        );
        assert_eq!(error.to_string(), "hair: needs a storage binding of 1073741824 bytes, the device has 134217728");
    }
}
