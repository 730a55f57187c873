//! What a technique leaves for `hair.render.composite`: one colour a pixel, and a depth where it is asked for.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::output::Output;

/// Pixels along the edge of a tile: what `hair.render.composite` draws or leaves out.
pub const TILE: u32 = 8;

/// Bytes of the arguments of a draw.
const DRAW_BYTES: u64 = 16;

/// Hair without what is behind it.
#[derive(Debug)]
pub(crate) struct Resolved {
    /// `vec2<u32>` a pixel: four half floats, premultiplied colour and alpha, [`TILE`] x [`TILE`] pixels a slot. A third word, the key of
    /// the depth, where depth is written too. Only pixels of tiles with hair are written.
    pub(crate) colors: BufferId,
    /// `vec2<u32>` each: the tiles that have hair, and their slots.
    pub(crate) tiles: BufferId,
    /// Arguments of a draw of six vertices for each of `tiles`.
    pub(crate) draw: BufferId,
    /// How many there are: one for each tile, if each has its own.
    pub(crate) slots: u32,
    pub(crate) output: Output,
}

impl Resolved {
    /// Bytes of all of it for a screen of this size.
    pub(crate) fn bytes(&self, size: [u32; 2]) -> u64 {
        let colors = self.output.slot_bytes() * u64::from(self.slots);
        colors.max(16) + (8 * u64::from(tile_count(size))).max(16) + DRAW_BYTES
    }

    /// With a slot for each tile.
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], output: Output) -> Result<Self> {
        Self::with_slots(backend, size, tile_count(size), output)
    }

    /// With room for so many tiles.
    pub(crate) fn with_slots(backend: &mut dyn Backend, size: [u32; 2], slots: u32, output: Output) -> Result<Self> {
        let colors = new_colors(backend, slots, output)?;
        let tiles = storage(backend, "hair.render.tiles", 8 * u64::from(tile_count(size)))?;
        let draw = backend.create_buffer(&BufferDesc::indirect("hair.render.tile_vertices", DRAW_BYTES))?;
        Ok(Self { colors, tiles, draw, slots, output })
    }

    /// [`Resolved::colors`] with so many slots.
    pub(crate) fn more_colors(&self, backend: &mut dyn Backend, slots: u32) -> Result<BufferId> {
        new_colors(backend, slots, self.output)
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

fn new_colors(backend: &mut dyn Backend, slots: u32, output: Output) -> Result<BufferId> {
    storage(backend, "hair.render.resolved", output.slot_bytes() * u64::from(slots))
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
