//! What a technique leaves for `hair.render.composite`: one colour a pixel.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

/// Pixels along the edge of a tile: what `hair.render.composite` draws or leaves out.
pub const TILE: u32 = 8;

/// Bytes of the arguments of a draw.
const DRAW_BYTES: u64 = 16;

/// Hair without what is behind it.
#[derive(Debug)]
pub(crate) struct Resolved {
    /// `vec2<u32>` a pixel: four half floats, premultiplied colour and alpha. Only pixels of tiles with hair are written.
    pub(crate) colors: BufferId,
    /// `u32` each: the tiles that have hair.
    pub(crate) tiles: BufferId,
    /// Arguments of a draw of six vertices for each of `tiles`.
    pub(crate) draw: BufferId,
}

impl Resolved {
    /// Bytes of a pixel in `colors`.
    pub(crate) const PIXEL_BYTES: u64 = 8;

    /// Bytes of both for `size` pixels.
    pub(crate) fn bytes(size: [u32; 2]) -> u64 {
        (Self::PIXEL_BYTES * pixels(size)).max(16) + (4 * u64::from(tile_count(size))).max(16) + DRAW_BYTES
    }

    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2]) -> Result<Self> {
        let colors = storage(backend, "hair.render.resolved", Self::PIXEL_BYTES * pixels(size))?;
        let tiles = storage(backend, "hair.render.tiles", 4 * u64::from(tile_count(size)))?;
        let draw = backend.create_buffer(&BufferDesc::indirect("hair.render.tile_vertices", DRAW_BYTES))?;
        Ok(Self { colors, tiles, draw })
    }

    /// Forgets the tiles of the view before.
    pub(crate) fn clear(&self, list: &mut PassList) {
        // No vertices, one instance.
        list.upload(self.draw, 0, &[0u32, 1, 0, 0]);
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        [self.colors, self.tiles, self.draw].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

/// A storage buffer that exists even if there is nothing to store.
pub(crate) fn storage(backend: &mut dyn Backend, label: Label, bytes: u64) -> Result<BufferId> {
    backend.create_buffer(&BufferDesc::storage(label, bytes.max(16)))
}

/// Pixels that a view can have: a group of 64 segments, of which each may cover all of them, counts in 31 bits.
pub(crate) const MAX_PIXELS: u64 = 1 << 25;

/// Whether a picture of this size can be drawn.
pub(crate) fn check_pixels(size: [u32; 2]) -> Result<()> {
    if pixels(size) > MAX_PIXELS {
        let message = format!("a picture of {} x {} pixels, it may have {MAX_PIXELS}", size[0], size[1]);
        return Err(Error::Backend { label: "hair.render", message });
    }
    Ok(())
}

/// Pixels of a picture of this size.
pub(crate) fn pixels(size: [u32; 2]) -> u64 {
    u64::from(size[0]) * u64::from(size[1])
}

/// Tiles that a picture of this size has.
pub(crate) fn tile_count(size: [u32; 2]) -> u32 {
    size[0].div_ceil(TILE) * size[1].div_ceil(TILE)
}
