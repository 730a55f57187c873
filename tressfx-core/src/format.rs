//! Texel formats.

/// A texel format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
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
    /// Three channels of 10 bits and alpha of 2.
    Rgb10A2,
    /// Three float channels without a sign, of 11, 11 and 10 bits.
    R11G11B10F,
    /// One 16-bit float channel.
    R16F,
    /// Two 16-bit float channels.
    Rg16F,
    /// Two 32-bit float channels.
    Rg32F,
    /// One 32-bit float channel.
    R32F,
    /// One 32-bit unsigned integer channel.
    R32Uint,
    /// 32-bit float depth.
    Depth32F,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Rgba8,
        Self::Rgba8Srgb,
        Self::Bgra8,
        Self::Bgra8Srgb,
        Self::Rgba16F,
        Self::Rgb10A2,
        Self::R11G11B10F,
        Self::R16F,
        Self::Rg16F,
        Self::Rg32F,
        Self::R32F,
        Self::R32Uint,
        Self::Depth32F,
    ];

    /// Bytes of one texel.
    pub fn bytes(self) -> u32 {
        match self {
            Self::R16F => 2,
            Self::Rgba16F | Self::Rg32F => 8,
            _ => 4,
        }
    }

    /// Whether it holds depth.
    pub fn is_depth(self) -> bool {
        self == Self::Depth32F
    }

    /// Whether its channels are unsigned integers.
    pub fn is_uint(self) -> bool {
        self == Self::R32Uint
    }

    /// Whether a sampler can read it.
    pub fn is_filterable(self) -> bool {
        !matches!(self, Self::Rg32F | Self::R32F | Self::R32Uint | Self::Depth32F)
    }

    /// Whether a colour target of it can blend.
    pub fn is_blendable(self) -> bool {
        self.is_filterable()
    }

    /// Whether compute passes can write it.
    pub fn is_storage(self) -> bool {
        matches!(self, Self::Rgba8 | Self::Rgba16F | Self::R32F | Self::R32Uint)
    }
}
