//! What can go wrong on a GPU, and what a caller can do wrong.

use std::fmt;

use crate::format::Format;

/// The name of a resource or a pass: the same word in the source, the profiler and the tests.
pub type Label = &'static str;

/// An error of a backend or of a shader.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller broke a rule of the contract. Nothing was recorded or made.
    #[error("{place}: {message}")]
    Rule {
        /// Which command of a list, by number and name; or the label of what was to be made.
        place: String,
        /// Which rule, with the binding or the range.
        message: String,
    },
    /// An allocation failed.
    #[error("{label}: the device has no memory left for {bytes} bytes")]
    OutOfMemory {
        /// The resource that was asked for.
        label: Label,
        /// Its size.
        bytes: u64,
    },
    /// The device is gone: everything on it must be made anew.
    #[error("the graphics device was lost: {reason}")]
    DeviceLost {
        /// What the driver said.
        reason: String,
    },
    /// The device cannot do what a technique needs.
    #[error("{label}: needs {need}, the device has {}", if *have == 0 { String::from("none") } else { have.to_string() })]
    Unsupported {
        /// The technique or resource.
        label: Label,
        /// What it needs.
        need: Need,
        /// What there is.
        have: u64,
    },
    /// A shader does not compose, parse or validate.
    #[error("{label}: {message}")]
    Shader {
        /// The kernel.
        label: Label,
        /// The compiler's message, with the place in the WGSL.
        message: String,
    },
    /// No adapter can be used.
    #[error("{message}")]
    NoAdapter {
        /// What was tried, and what to install.
        message: String,
    },
    /// The driver or the API refused something.
    #[error("{label}: {message}")]
    Backend {
        /// The resource or pass.
        label: Label,
        /// What was said.
        message: String,
    },
}

impl Error {
    /// A broken rule.
    pub fn rule(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Rule { place: place.into(), message: message.into() }
    }
}

/// A result of the contract.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Something that a technique asks of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Need {
    /// Compute passes.
    Compute,
    /// Raster passes.
    Raster,
    /// Bytes that come back.
    ReadBack,
    /// Fragment shaders that write storage buffers.
    FragmentWrites,
    /// A format that can be drawn to.
    Target(Format),
    /// So many storage buffers in one stage.
    StorageBuffers(u32),
    /// So many textures that one compute pass writes.
    StorageTextures(u32),
    /// Compute passes that read the texels of a texture that they write.
    ReadWriteTextures,
    /// One storage binding of so many bytes.
    StorageBindingBytes(u64),
    /// One uniform binding of so many bytes.
    UniformBindingBytes(u64),
    /// One buffer of so many bytes.
    BufferBytes(u64),
    /// A texture with an edge of so many texels.
    TextureEdge(u32),
    /// So many colour targets in one pass.
    ColorTargets(u32),
    /// So many threads in one compute group.
    GroupThreads(u32),
    /// So many threads of a compute group along one axis.
    GroupSize {
        /// 0 is x, 1 is y, 2 is z.
        axis: usize,
        /// Threads along it.
        threads: u32,
    },
    /// So many bytes that a compute group shares.
    GroupMemory(u32),
}

impl fmt::Display for Need {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Compute => out.write_str("compute passes"),
            Self::Raster => out.write_str("raster passes"),
            Self::ReadBack => out.write_str("reading back"),
            Self::FragmentWrites => out.write_str("fragment shaders that write storage buffers"),
            Self::Target(format) => write!(out, "targets of the format {format:?}"),
            Self::StorageBuffers(count) => write!(out, "{count} storage buffers in one stage"),
            Self::StorageTextures(count) => write!(out, "{count} storage textures in one stage"),
            Self::ReadWriteTextures => out.write_str("compute passes that read textures that they write"),
            Self::StorageBindingBytes(bytes) => write!(out, "a storage binding of {bytes} bytes"),
            Self::UniformBindingBytes(bytes) => write!(out, "a uniform binding of {bytes} bytes"),
            Self::BufferBytes(bytes) => write!(out, "a buffer of {bytes} bytes"),
            Self::TextureEdge(texels) => write!(out, "a texture edge of {texels} texels"),
            Self::ColorTargets(count) => write!(out, "{count} colour targets in one pass"),
            Self::GroupThreads(threads) => write!(out, "groups of {threads} threads"),
            Self::GroupSize { axis, threads } => {
                write!(out, "groups of {threads} threads along {}", ["x", "y", "z"].get(*axis).unwrap_or(&"?"))
            }
            Self::GroupMemory(bytes) => write!(out, "{bytes} bytes of group memory"),
        }
    }
}
