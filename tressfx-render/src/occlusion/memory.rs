//! What is kept while hidden hair is found.

use tressfx_core::backend::{Backend, BufferDesc, Format, TextureDesc};
use tressfx_core::error::{Need, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;
use tressfx_core::uniform_array::UniformArray;

use super::OcclusionUniform;
use crate::resolved::{pixels, storage, tile_count};
use crate::strands::SectionDraw;
use crate::views::BoundView;

/// Bytes of what is known of a tile.
const TILE_BYTES: u64 = 16;

/// Bytes of the masses of a tile: a word for each slice of depth.
const MASS_BYTES: u64 = 4 * 64;

/// Bytes of the optical depths of a pixel: a word for each part.
const OPTICAL_BYTES: u64 = 4 * 4;

/// Bytes of the grid of a list: groups of threads, nothing, and the arguments of a draw.
const GRID_BYTES: u64 = 32;

/// Where in it the arguments of a draw are.
const DRAW_OFFSET: u64 = 16;

/// Bytes of a list before its segments: how many there are.
const HEADER_BYTES: u64 = 4;

/// The segments of a section that may be seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Listed {
    /// How many there are, and their numbers.
    pub(crate) segments: Binding,
    /// How they are walked.
    pub(super) grid: Binding,
    /// The buffer of that, and where in it groups of threads are.
    pub(crate) groups: (BufferId, u64),
    /// The same of the arguments of a draw.
    pub(crate) draw: (BufferId, u64),
    /// Where the list begins in the buffer of all of them. What is bound of it depends on that and on the place of its grid.
    pub(super) first: u64,
}

/// What the lists of sections take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Room {
    sections: u64,
    /// Of all lists.
    bytes: u64,
    /// Of the longest one.
    largest: u64,
}

impl Room {
    pub(super) fn of(alignment: u64, draws: &[SectionDraw]) -> Self {
        let of = |draw: &SectionDraw| bytes_of(alignment, draw);
        let [bytes, largest] = [draws.iter().map(of).sum(), draws.iter().map(of).max().unwrap_or(0)];
        Self { sections: draws.len() as u64, bytes, largest }
    }

    /// The larger of both.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            sections: self.sections.max(other.sections),
            bytes: self.bytes.max(other.bytes),
            largest: self.largest.max(other.largest),
        }
    }

    pub(super) fn holds(self, other: Self) -> bool {
        self.sections >= other.sections && self.bytes >= other.bytes
    }
}

/// Bytes from the grid of a section to that of the next one.
fn grid_stride(alignment: u64) -> u64 {
    GRID_BYTES.next_multiple_of(alignment)
}

/// Bytes that the list of a section takes.
fn bytes_of(alignment: u64, draw: &SectionDraw) -> u64 {
    (HEADER_BYTES + 4 * u64::from(draw.segments())).next_multiple_of(alignment)
}

/// Of masses, tiles and optical depths.
fn sizes(size: [u32; 2]) -> [u64; 3] {
    let tiles = u64::from(tile_count(size));
    [MASS_BYTES * tiles, TILE_BYTES * tiles, OPTICAL_BYTES * pixels(size)].map(|bytes| bytes.max(16))
}

/// Whether a device can have it.
pub(super) fn check(backend: &dyn Backend, size: [u32; 2], room: Room) -> Result<()> {
    let largest = sizes(size).into_iter().max().unwrap_or(0).max(room.largest);
    backend.caps().check("hair.render.occlusion", &[Need::StorageBuffers(8), Need::StorageBindingBytes(largest)])
}

#[derive(Debug)]
pub(super) struct Memory {
    alignment: u64,
    pub(super) uniforms: UniformArray<OcclusionUniform>,
    /// `u32` a slice of each tile.
    pub(super) masses: BufferId,
    /// `OccludedTile` a tile.
    pub(super) tiles: BufferId,
    /// `u32` a part of each pixel.
    pub(super) opticals: BufferId,
    /// `f32` a pixel: what is seen farthest.
    pub(super) depth: TextureId,
    /// What there is room for.
    pub(super) room: Room,
    lists: BufferId,
    grids: BufferId,
    bytes: u64,
}

impl Memory {
    pub(super) fn new(
        backend: &mut dyn Backend,
        size: [u32; 2],
        views: usize,
        alignment: u64,
        room: Room,
    ) -> Result<Self> {
        let [masses, tiles, opticals] = sizes(size);
        let grid_bytes = (grid_stride(alignment) * room.sections).max(GRID_BYTES);
        let texture = TextureDesc::new("hair.render.occluded", size, Format::R32F).storage();
        let uniforms = UniformArray::new(backend, "hair.render.occlusion", views)?;
        let bytes = masses + tiles + opticals + texture.bytes() + room.bytes + grid_bytes + uniforms.bytes();
        Ok(Self {
            alignment,
            uniforms,
            masses: storage(backend, "hair.render.masses", masses)?,
            tiles: storage(backend, "hair.render.occluded_tiles", tiles)?,
            opticals: storage(backend, "hair.render.opticals", opticals)?,
            depth: backend.create_texture(&texture)?,
            room,
            lists: storage(backend, "hair.render.lists", room.bytes)?,
            grids: backend.create_buffer(&BufferDesc::indirect("hair.render.list_grids", grid_bytes))?,
            bytes,
        })
    }

    pub(super) fn destroy(self, backend: &mut dyn Backend) {
        self.uniforms.destroy(backend);
        let Self { masses, tiles, opticals, depth, lists, grids, .. } = self;
        [masses, tiles, opticals, lists, grids].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
        backend.destroy(depth.into());
    }

    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Empties the memory for a view.
    pub(super) fn begin(&self, list: &mut PassList, view: &BoundView, uniform: OcclusionUniform) {
        self.uniforms.upload(list, view.index, &[uniform]);
        view.region.clear_tiles(list, self.masses, MASS_BYTES);
        view.region.clear(list, self.opticals, OPTICAL_BYTES);
    }

    /// A list for each section.
    pub(super) fn lists(&self, draws: &[SectionDraw]) -> Vec<Listed> {
        let mut first = 0;
        let place = |(index, draw): (usize, &SectionDraw)| {
            let (begin, bytes) = (first, HEADER_BYTES + 4 * u64::from(draw.segments()));
            first += bytes_of(self.alignment, draw);
            let grid = grid_stride(self.alignment) * index as u64;
            Listed {
                segments: self.lists.range(begin, bytes),
                grid: self.grids.range(grid, GRID_BYTES),
                groups: (self.grids, grid),
                draw: (self.grids, grid + DRAW_OFFSET),
                first: begin,
            }
        };
        draws.iter().enumerate().map(place).collect()
    }

    /// Empties a list: no groups, and no vertices of one instance.
    pub(super) fn empty(&self, list: &mut PassList, listed: &Listed) {
        list.clear(self.lists, listed.first, HEADER_BYTES);
        list.upload(self.grids, listed.groups.1, &[0u32, 1, 1, 0, 0, 1, 0, 0]);
    }
}
