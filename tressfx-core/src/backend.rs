//! The contract: what an engine implements so that hair runs on its GPU API.

use std::fmt;
use std::sync::Arc;

use crate::error::{Label, Result};
use crate::id::{BufferId, PipelineId, Resource, TextureId};
use crate::pass::{PassList, Ticket};
use crate::shader::{Bindings, Shader};

/// A GPU. Object safe: the library only ever sees `&mut dyn Backend`, and only while it creates things.
pub trait Backend {
    /// What the device can do.
    fn caps(&self) -> &Caps;

    /// Makes a buffer, filled with zeros.
    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId>;

    /// Makes a texture with one mip level and one layer, filled with zeros.
    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId>;

    /// Compiles a compute pipeline.
    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel>;

    /// Compiles a raster pipeline.
    fn create_raster(&mut self, desc: &RasterDesc) -> Result<Kernel>;

    /// Frees a resource once no recorded frame can use it any more. An imported one is only forgotten.
    fn destroy(&mut self, resource: Resource);

    /// Frees a pipeline once no recorded frame can use it any more.
    fn destroy_pipeline(&mut self, pipeline: PipelineId);

    /// Records, submits and waits. Tests and tools use it; engines use [`Record`].
    fn run(&mut self, list: &PassList) -> Result<()>;

    /// The bytes of a finished read-back, rows tightly packed. They are given once; `None` before they are there.
    fn read(&mut self, ticket: Ticket) -> Option<Vec<u8>>;

    /// Cost of each compute and raster pass of the newest finished list that has any, in its order. They are given once; empty
    /// where there are none yet, or the device cannot time.
    fn timings(&mut self) -> Vec<Timing>;

    /// Bytes of buffers and textures that this backend made, as their descriptions say: now, and at most so far. What is
    /// destroyed no longer counts, even if it is freed later.
    fn memory(&self) -> Memory;
}

/// How an application puts a list into the encoder that it already has.
pub trait Record: Backend {
    /// The engine's own encoder: `wgpu::CommandEncoder`, `vk::CommandBuffer`...
    type Encoder: ?Sized;

    /// Writes the commands of `list` into `encoder`. Never submits, never waits, never keeps the encoder.
    fn record(&mut self, encoder: &mut Self::Encoder, list: &PassList) -> Result<()>;
}

/// What a buffer is for, beside being copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BufferUse {
    /// `var<storage>`.
    Storage,
    /// `var<uniform>`.
    Uniform,
    /// `var<storage>`, and the number of groups of compute passes.
    Indirect,
}

/// A buffer to be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferDesc {
    /// Its name in every tool.
    pub label: Label,
    /// Its size; a multiple of 4, at least 4.
    pub bytes: u64,
    /// What it is for.
    pub usage: BufferUse,
}

/// A texel format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Four 8-bit channels.
    Rgba8,
    /// Four 8-bit channels, colours encoded as sRGB.
    Rgba8Srgb,
    /// Four 8-bit channels, blue first.
    Bgra8,
    /// Four 8-bit channels, blue first, colours encoded as sRGB.
    Bgra8Srgb,
    /// Four 16-bit float channels: linear light.
    Rgba16F,
    /// 32-bit float depth.
    Depth32F,
}

impl Format {
    /// Bytes of one texel.
    pub fn bytes(self) -> u32 {
        match self {
            Self::Rgba8 | Self::Rgba8Srgb | Self::Bgra8 | Self::Bgra8Srgb | Self::Depth32F => 4,
            Self::Rgba16F => 8,
        }
    }

    /// Whether it holds depth.
    pub fn is_depth(self) -> bool {
        self == Self::Depth32F
    }
}

/// A texture to be made: it can be drawn to, sampled and copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureDesc {
    /// Its name in every tool.
    pub label: Label,
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Its texels.
    pub format: Format,
}

impl TextureDesc {
    /// Its size in memory.
    pub fn bytes(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1]) * u64::from(self.format.bytes())
    }
}

/// Which end of the depth range is near.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DepthOrder {
    /// 0 is near, 1 is far.
    #[default]
    Standard,
    /// 1 is near, 0 is far: precision where it is needed.
    Reverse,
}

impl DepthOrder {
    /// The depth that a frame is cleared to.
    pub fn far(self) -> f32 {
        match self {
            Self::Standard => 1.0,
            Self::Reverse => 0.0,
        }
    }
}

/// How a colour target takes a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Blend {
    /// The fragment replaces what was there.
    Replace,
    /// The fragment is premultiplied and lies over what was there: `source + target * (1 - source alpha)`.
    Over,
}

/// What a raster pipeline does with depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Depth {
    /// The pass has no depth target.
    Off,
    /// Nearer or equal fragments pass and are written.
    TestWrite(DepthOrder),
}

/// A compute pipeline to be made.
#[derive(Clone, Debug)]
pub struct ComputeDesc {
    /// The kernel: its only compute entry point is used.
    pub shader: Arc<Shader>,
}

/// A raster pipeline to be made: triangles, no culling, no vertex buffers (shaders pull).
#[derive(Clone, Debug)]
pub struct RasterDesc {
    /// The shader: its only vertex and its only fragment entry point are used.
    pub shader: Arc<Shader>,
    /// The colour targets, in order.
    pub targets: Vec<(Format, Blend)>,
    /// Depth, always [`Format::Depth32F`].
    pub depth: Depth,
}

/// A compiled pipeline together with the shader that it was made from.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// The backend's pipeline.
    pub pipeline: PipelineId,
    /// What it was compiled from: label, features and bindings.
    pub shader: Arc<Shader>,
}

impl Kernel {
    /// Its label.
    pub fn label(&self) -> Label {
        self.shader.label
    }

    /// Puts resources in the order of the shader's bindings.
    ///
    /// # Panics
    /// If a name of the shader is missing, named twice or unknown: a mistake of the program.
    pub fn bind(&self, resources: &[(&str, Resource)]) -> Bindings {
        Bindings::new(&self.shader, resources)
    }
}

impl PartialEq for Kernel {
    fn eq(&self, other: &Self) -> bool {
        self.pipeline == other.pipeline
    }
}

/// What one pass cost the GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// The pass.
    pub label: Label,
    /// When it began, in nanoseconds after the first pass of its list.
    pub begin: f64,
    /// Its time.
    pub nanoseconds: f64,
    /// Bytes of all that is bound or drawn to, each resource once: the most that one reading of everything can cost.
    pub bytes: u64,
    /// Shader invocations, where the device counts them and was asked to.
    pub invocations: Option<u64>,
}

/// Bytes of buffers and textures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// In use now.
    pub bytes: u64,
    /// In use at most so far.
    pub peak: u64,
}

impl Memory {
    /// Counts an allocation.
    pub fn add(&mut self, bytes: u64) {
        self.bytes += bytes;
        self.peak = self.peak.max(self.bytes);
    }

    /// Counts a release.
    pub fn remove(&mut self, bytes: u64) {
        self.bytes = self.bytes.saturating_sub(bytes);
    }
}

/// What a device can do: numbers and yes or no, never the name of a vendor.
#[derive(Clone, Debug, PartialEq)]
pub struct Caps {
    /// The adapter, for people to read.
    pub adapter: String,
    /// Whether it runs compute passes.
    pub compute: bool,
    /// Whether it runs raster passes.
    pub raster: bool,
    /// Whether bytes can be read back.
    pub read_back: bool,
    /// Whether fragment shaders can write storage buffers.
    pub fragment_writes: bool,
    /// Storage buffers that one stage can be given.
    pub max_storage_buffers_per_stage: u32,
    /// Bytes of one storage binding.
    pub max_storage_binding_bytes: u64,
    /// Bytes of one buffer.
    pub max_buffer_bytes: u64,
    /// Texels along an edge of a texture.
    pub max_texture_edge: u32,
    /// Whether passes can be timed.
    pub timestamps: bool,
}

impl Caps {
    /// The limits that every WebGPU device has; the library fits into them.
    pub fn webgpu_default() -> Self {
        Self {
            adapter: String::from("WebGPU default limits"),
            compute: true,
            raster: true,
            read_back: true,
            fragment_writes: true,
            max_storage_buffers_per_stage: 8,
            max_storage_binding_bytes: 128 << 20,
            max_buffer_bytes: 256 << 20,
            max_texture_edge: 8192,
            timestamps: false,
        }
    }

    /// Checks needs one by one.
    ///
    /// # Errors
    /// [`Unsupported`](crate::error::Error::Unsupported) with the first need that is not met.
    pub fn check(&self, label: Label, needs: &[Need]) -> Result<()> {
        for &need in needs {
            let (want, have) = match need {
                Need::Compute => (1, u64::from(self.compute)),
                Need::Raster => (1, u64::from(self.raster)),
                Need::ReadBack => (1, u64::from(self.read_back)),
                Need::FragmentWrites => (1, u64::from(self.fragment_writes)),
                Need::StorageBuffers(count) => (u64::from(count), u64::from(self.max_storage_buffers_per_stage)),
                Need::StorageBindingBytes(bytes) => (bytes, self.max_storage_binding_bytes.min(self.max_buffer_bytes)),
                Need::TextureEdge(texels) => (u64::from(texels), u64::from(self.max_texture_edge)),
            };
            if have < want {
                return Err(crate::error::Error::Unsupported { label, need, have });
            }
        }
        Ok(())
    }
}

/// Something that a technique asks of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Compute passes.
    Compute,
    /// Raster passes.
    Raster,
    /// Bytes that come back.
    ReadBack,
    /// Fragment shaders that write storage buffers.
    FragmentWrites,
    /// So many storage buffers in one stage.
    StorageBuffers(u32),
    /// One storage binding of so many bytes.
    StorageBindingBytes(u64),
    /// A texture with an edge of so many texels.
    TextureEdge(u32),
}

impl fmt::Display for Need {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Compute => out.write_str("compute passes"),
            Self::Raster => out.write_str("raster passes"),
            Self::ReadBack => out.write_str("reading back"),
            Self::FragmentWrites => out.write_str("fragment shaders that write storage buffers"),
            Self::StorageBuffers(count) => write!(out, "{count} storage buffers in one stage"),
            Self::StorageBindingBytes(bytes) => write!(out, "a storage binding of {bytes} bytes"),
            Self::TextureEdge(texels) => write!(out, "a texture edge of {texels} texels"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

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

    #[test]
    fn memory_remembers_its_peak() {
        let mut memory = Memory::default();
        memory.add(10);
        memory.remove(4);
        memory.add(3);
        assert_eq!(memory, Memory { bytes: 9, peak: 10 });
    }
}
