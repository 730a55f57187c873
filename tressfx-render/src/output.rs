//! What a renderer draws to.

use tressfx_core::backend::Format;
use tressfx_core::shader::Specialization;

use crate::resolved::TILE;
use crate::views::MAX_VIEWS;

/// Format of the depth and coverage of hair, where a renderer writes them: see [`Targets::hair`](crate::Targets::hair).
pub const HAIR_FORMAT: Format = Format::Rg32F;

/// The targets that a technique is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Output {
    /// Format of the picture.
    pub(crate) color: Format,
    /// Whether depth and coverage of the hair are written too.
    pub(crate) hair: bool,
    /// Whether strands may have copies.
    pub(crate) copies: bool,
    /// Whether compute passes may write the picture.
    pub(crate) storage: bool,
    /// The most views of a frame.
    pub(crate) views: usize,
}

impl Output {
    /// Bytes that a technique leaves for each pixel: colour and alpha, and a key of the depth.
    fn pixel_bytes(self) -> u64 {
        if self.hair { 12 } else { 8 }
    }

    /// Bytes that it leaves for each tile.
    pub(crate) fn slot_bytes(self) -> u64 {
        self.pixel_bytes() * u64::from(TILE * TILE)
    }

    /// What the kernels that write or read such a pixel are compiled for.
    pub(crate) fn specialization(self) -> Specialization {
        self.walk().feature("hair_output", self.hair)
    }

    /// What the kernels that walk over strands are compiled for.
    pub(crate) fn walk(self) -> Specialization {
        walk(self.copies)
    }
}

/// What kernels that walk over strands are compiled for: whether these may have copies.
pub(crate) fn walk(copies: bool) -> Specialization {
    Specialization::new().feature("copies", copies)
}

impl From<Format> for Output {
    /// The picture alone, and as many views as there can be.
    fn from(color: Format) -> Self {
        Self { color, hair: false, copies: false, storage: false, views: MAX_VIEWS }
    }
}
