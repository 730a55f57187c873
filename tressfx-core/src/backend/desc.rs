//! What is made on a device: buffers, textures, pipelines.

use std::ops::BitOr;
use std::sync::Arc;

use crate::error::Label;
use crate::format::Format;
use crate::shader::Shader;

macro_rules! uses {
    ($(#[$doc:meta])* $name:ident { $($(#[$use_doc:meta])* $constant:ident = $bit:expr,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub struct $name(u8);

        impl $name {
            $($(#[$use_doc])* pub const $constant: Self = Self($bit);)*

            /// Whether all of `other` is in the set.
            pub fn contains(self, other: Self) -> bool {
                self.0 & other.0 == other.0
            }
        }

        impl BitOr for $name {
            type Output = Self;
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }
    };
}

uses! {
    /// What a buffer can be used for, as a set.
    BufferUses {
        /// `var<storage>`.
        STORAGE = 1,
        /// `var<uniform>`.
        UNIFORM = 1 << 1,
        /// The number of groups of compute passes, and of vertices and instances of draws.
        INDIRECT = 1 << 2,
        /// Copied and read back from.
        COPY_SOURCE = 1 << 3,
        /// Uploaded, cleared and copied to.
        COPY_DESTINATION = 1 << 4,
    }
}

impl BufferUses {
    /// Both directions.
    pub const COPIES: Self = Self(1 << 3 | 1 << 4);
}

uses! {
    /// What a texture can be used for, as a set.
    TextureUses {
        /// Drawn to.
        TARGET = 1,
        /// Read by shaders.
        SAMPLED = 1 << 1,
        /// Written by compute passes.
        STORAGE = 1 << 2,
        /// Copied and read back from.
        COPY_SOURCE = 1 << 3,
        /// Copied to.
        COPY_DESTINATION = 1 << 4,
    }
}

/// A buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BufferDesc {
    /// Its name in every tool.
    pub label: Label,
    /// Its size; a multiple of 4, at least 4.
    pub bytes: u64,
    /// What it is for.
    pub uses: BufferUses,
}

impl BufferDesc {
    /// A buffer for these uses. It is meant for imported buffers; the library uses the other constructors for its own.
    pub fn new(label: Label, bytes: u64, uses: BufferUses) -> Self {
        Self { label, bytes, uses }
    }

    /// `var<storage>`; copied from and to.
    pub fn storage(label: Label, bytes: u64) -> Self {
        Self::new(label, bytes, BufferUses::STORAGE | BufferUses::COPIES)
    }

    /// `var<uniform>`; copied from and to.
    pub fn uniform(label: Label, bytes: u64) -> Self {
        Self::new(label, bytes, BufferUses::UNIFORM | BufferUses::COPIES)
    }

    /// `var<storage>`, and arguments of passes and draws; copied from and to.
    pub fn indirect(label: Label, bytes: u64) -> Self {
        Self::new(label, bytes, BufferUses::STORAGE | BufferUses::INDIRECT | BufferUses::COPIES)
    }
}

/// A texture with one mip level, one layer and one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct TextureDesc {
    /// Its name in every tool.
    pub label: Label,
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Its texels.
    pub format: Format,
    /// What it is for.
    pub uses: TextureUses,
}

impl TextureDesc {
    /// Read by shaders, copied from, and copied and drawn to where its format can be.
    pub fn new(label: Label, size: [u32; 2], format: Format) -> Self {
        let mut uses = TextureUses::SAMPLED | TextureUses::COPY_SOURCE;
        if format != Format::R11G11B10F {
            uses = uses | TextureUses::TARGET;
        }
        if !format.is_depth() {
            uses = uses | TextureUses::COPY_DESTINATION;
        }
        Self { label, size, format, uses }
    }

    /// The same with other uses.
    #[must_use]
    pub fn with_uses(self, uses: TextureUses) -> Self {
        Self { uses, ..self }
    }

    /// The same, and compute passes write it.
    #[must_use]
    pub fn storage(self) -> Self {
        Self { uses: self.uses | TextureUses::STORAGE, ..self }
    }

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
#[non_exhaustive]
pub enum Blend {
    /// The fragment replaces what was there.
    Replace,
    /// The fragment is premultiplied and lies over what was there: `source + target * (1 - source alpha)`.
    Over,
    /// `source + target`.
    Add,
    /// `source * target`.
    Multiply,
    /// The smaller one, channel by channel.
    Min,
    /// The larger one, channel by channel.
    Max,
}

/// What a raster pipeline does with depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Depth {
    /// The pass has no depth target.
    Off,
    /// Nearer or equal fragments pass.
    Test(DepthOrder),
    /// Nearer or equal fragments pass and are written.
    TestWrite(DepthOrder),
}

/// A compute pipeline to be made.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ComputeDesc {
    /// The kernel: its only compute entry point is used.
    pub shader: Arc<Shader>,
}

impl ComputeDesc {
    /// A pipeline of a shader.
    pub fn new(shader: Arc<Shader>) -> Self {
        Self { shader }
    }
}

/// A raster pipeline to be made: triangles, no culling, no vertex buffers (shaders pull).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RasterDesc {
    /// The shader: its only vertex entry point is used, and its only fragment entry point, if it has one.
    pub shader: Arc<Shader>,
    /// The colour targets, in order.
    pub targets: Vec<(Format, Blend)>,
    /// Depth, always [`Format::Depth32F`].
    pub depth: Depth,
}

impl RasterDesc {
    /// A pipeline of a shader, without targets.
    pub fn new(shader: Arc<Shader>) -> Self {
        Self { shader, targets: Vec::new(), depth: Depth::Off }
    }

    /// With one more colour target.
    #[must_use]
    pub fn target(mut self, format: Format, blend: Blend) -> Self {
        self.targets.push((format, blend));
        self
    }

    /// With depth.
    #[must_use]
    pub fn depth(self, depth: Depth) -> Self {
        Self { depth, ..self }
    }
}
