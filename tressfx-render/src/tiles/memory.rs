//! What tiles keep.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, Groups, PassList};
use tressfx_core::shader::Binding;
use tressfx_core::uniform_array::UniformArray;

use super::TilesDesc;
use super::kernels::bin_grid;
use super::layout::{MAX_VERTICES, SLICES, TilesUniform, drawn_vertices};
use crate::counters::ViewCounters;
use crate::output::Output;
use crate::renderer::{HEADROOM, times, with_headroom};
use crate::resolved::{Resolved, TILE, storage, tile_count};
use crate::strands::SectionDraw;
use crate::technique::Wanted;
use crate::usage::is_surplus;
use crate::views::MAX_VIEWS;

/// Kinds of tiles by the number of their references.
const CLASSES: u64 = 8;

/// Bytes of the queue before its tiles.
const QUEUE_HEADER: u64 = 16 + 4 * CLASSES;

/// [`TilesUniform`] of a view, at most: for counting, and for each round.
pub(crate) const UNIFORMS_OF_A_VIEW: usize = 1 + MAX_ROUNDS as usize;

/// Rounds in which tiles may be blended.
pub(crate) const MAX_ROUNDS: u32 = 64;

/// References that all rounds have room for at most: `tile_alloc` counts up to one more, so that what has no room is seen.
const MOST_COVERED: u32 = (1 << 30) - 1;

/// References that there is room for at least, unless fewer are allowed.
const LEAST_REFERENCES: u32 = 1 << 16;

/// Vertices that there is room for at least.
const LEAST_VERTICES: u32 = 1 << 10;

/// Tiles whose resolved pixels have room at least.
const LEAST_SLOTS: u32 = 256;

/// What was needed at most for two seconds, times this, has room after them: what moves on as it did stays within it.
const SETTLED: f64 = 1.1;

/// More room than this, times what was needed in these two seconds, is given back.
const SURPLUS: f64 = 1.2;

/// There is too little room where what is needed, times this, has none: it grows before anything is dropped.
const TIGHT: f64 = 1.04;

/// Whether the next frame may need more than there is room for.
pub(crate) fn is_tight(room: u64, needed: u64) -> bool {
    times(needed, TIGHT) > room
}

/// With more references than this share of what may be predicted for one round, more of hidden hair is left out: a reference too many costs
/// little, another round much.
const CROWD: f64 = 0.75;

/// Bytes of a grid of groups.
const GRID_BYTES: u64 = 12;

/// The grid of `tile_blend`: its number in [`Memory::grids`].
const BLEND_GRID: u32 = 0;

/// The grid of `tile_bin` that stores in the first round; those of the other rounds follow.
const STORE_GRIDS: u32 = 1;

/// All of them.
const GRIDS_BYTES: u64 = GRID_BYTES * (STORE_GRIDS + MAX_ROUNDS) as u64;

/// Those of `tile_bin` that counts and of `tile_alloc`, for tiles that are blended again.
const AGAIN_BYTES: u64 = 2 * GRID_BYTES;

/// Bytes of what is known of a tile.
const INFO_BYTES: u64 = 24;

/// Pixels along an edge of a block of tiles, see `blocks.wgsl`.
const BLOCK_EDGE: u32 = 4 * TILE;

/// Bytes before those of the blocks: whether tiles are drawn again.
const BLOCKS_HEADER: u64 = 4;

/// Bytes of what is kept of a view from frame to frame: when a tile was drawn again.
const KEPT_OF_A_VIEW: u64 = 4;

/// Bytes of what is kept of a tile from frame to frame: what its hair has hidden, and where the units of each quarter ended.
const KEPT_BYTES: u64 = 20;

/// Vertices of all sections that may be seen.
#[derive(Debug)]
pub(crate) struct Vertices {
    /// Four words a vertex: see `segments.wgsl`.
    pub(crate) points: BufferId,
    /// Colour and opacity as four half floats a vertex.
    pub(crate) paints: BufferId,
    /// How many there is room for.
    pub(crate) count: u32,
}

impl Vertices {
    /// Bytes of a vertex in the larger one of the two buffers.
    pub(crate) const POINT_BYTES: u64 = 16;
    const PAINT_BYTES: u64 = 8;

    fn new(backend: &mut dyn Backend, count: u32) -> Result<Self> {
        let points = storage(backend, "hair.render.vertices", Self::POINT_BYTES * u64::from(count))?;
        let paints = storage(backend, "hair.render.paints", Self::PAINT_BYTES * u64::from(count))?;
        Ok(Self { points, paints, count })
    }

    fn bytes(&self) -> u64 {
        (Self::POINT_BYTES + Self::PAINT_BYTES) * u64::from(self.count)
    }

    fn destroy(self, backend: &mut dyn Backend) {
        [self.points, self.paints].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

/// References to segments, of all tiles.
#[derive(Debug)]
pub(crate) struct References {
    /// `u32` a reference: the first vertex of a segment.
    pub(crate) buffer: BufferId,
    /// How many there is room for.
    pub(crate) count: u32,
    /// In how many rounds tiles are blended, where there is no room for the references of all of them at once.
    pub(crate) rounds: u32,
}

impl References {
    const BYTES: u64 = 4;

    /// How many references all rounds have room for. In a round, tiles begin in the first half of the room, so that the last one of them
    /// has the other half for itself. In the last round they begin anywhere.
    pub(crate) fn covered(&self) -> u32 {
        self.first(self.rounds - 1).saturating_add(self.count).min(MOST_COVERED)
    }

    /// The first reference of a round.
    pub(crate) fn first(&self, round: u32) -> u32 {
        round.saturating_mul(self.window())
    }

    /// The one after the last with which a tile may begin in a round. A tile that begins behind all that has room is blended in the last
    /// round too, as one without hair: the composite draws it.
    pub(crate) fn end(&self, round: u32) -> u32 {
        if round + 1 == self.rounds { u32::MAX } else { self.first(round + 1) }
    }

    /// How many references have room in a round.
    pub(crate) fn capacity(&self, round: u32) -> u32 {
        self.count.min(self.covered().saturating_sub(self.first(round)))
    }

    /// References with which tiles may begin in a round before the last one.
    pub(crate) fn window(&self) -> u32 {
        (self.count / 2).max(1)
    }

    fn new(backend: &mut dyn Backend, count: u32) -> Result<Self> {
        let buffer = storage(backend, "hair.render.references", Self::BYTES * u64::from(count))?;
        Ok(Self { buffer, count, rounds: 1 })
    }
}

/// What there is of each tile, and the result.
#[derive(Debug)]
pub(crate) struct Screen {
    size: [u32; 2],
    /// `u32` a slice of each tile.
    pub(crate) bins: BufferId,
    /// `TileInfo` a tile.
    pub(crate) infos: BufferId,
    /// `u32` a block of tiles.
    pub(crate) blocks: BufferId,
    /// Tiles that have references.
    pub(crate) queue: BufferId,
    /// The colours of the pixels.
    pub(crate) resolved: Resolved,
}

impl Screen {
    fn new(backend: &mut dyn Backend, size: [u32; 2], slots: u32, output: Output) -> Result<Self> {
        let [bins, infos, blocks, queue] = sizes(size);
        Ok(Self {
            size,
            bins: storage(backend, "hair.render.bins", bins)?,
            infos: storage(backend, "hair.render.tile_infos", infos)?,
            blocks: storage(backend, "hair.render.tile_blocks", blocks)?,
            queue: storage(backend, "hair.render.queue", queue)?,
            resolved: Resolved::with_slots(backend, size, slots.min(tile_count(size)), output)?,
        })
    }

    fn replace_colors(&mut self, backend: &mut dyn Backend, colors: BufferId, slots: u32) {
        backend.destroy(std::mem::replace(&mut self.resolved.colors, colors).into());
        self.resolved.slots = slots;
    }

    fn destroy(self, backend: &mut dyn Backend) {
        self.resolved.destroy(backend);
        [self.bins, self.infos, self.blocks, self.queue].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

/// Bytes of bins, infos, blocks and queue.
fn sizes(size: [u32; 2]) -> [u64; 4] {
    let tiles = u64::from(tile_count(size));
    let blocks: u64 = size.map(|edge| u64::from(edge.div_ceil(BLOCK_EDGE))).iter().product();
    [4 * u64::from(SLICES) * tiles, INFO_BYTES * tiles, BLOCKS_HEADER + 4 * blocks, QUEUE_HEADER + 4 * CLASSES * tiles]
}

/// Bytes of what is kept of a view from frame to frame.
fn kept(size: [u32; 2]) -> u64 {
    KEPT_OF_A_VIEW + KEPT_BYTES * u64::from(tile_count(size))
}

/// Bytes of the largest buffer that a screen of this size takes.
pub(crate) fn largest_binding(size: [u32; 2], output: Output) -> u64 {
    sizes(size).into_iter().max().unwrap_or(0).max(output.slot_bytes() * u64::from(tile_count(size)))
}

/// The buffers of tiles.
#[derive(Debug)]
pub(crate) struct Memory {
    most_references: u32,
    most_vertices: u32,
    pub(crate) vertices: Vertices,
    pub(crate) references: References,
    pub(crate) screen: Screen,
    /// Grids of groups that `tile_alloc` counts, one after the other.
    pub(crate) grids: BufferId,
    /// Grids for tiles that are blended again.
    pub(crate) grids_again: BufferId,
    /// What is counted of each view, and what its hair has hidden.
    pub(crate) counters: ViewCounters,
    /// Whether nothing is known yet of what was hidden.
    is_new: bool,
    /// [`TilesUniform`] for counting and for storing, of each view.
    pub(crate) uniforms: UniformArray<TilesUniform>,
}

impl Memory {
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], desc: &TilesDesc, output: Output) -> Result<Self> {
        let caps = backend.caps();
        let bytes = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes);
        let reference_bytes = desc.max_reference_bytes.min(TilesDesc::MAX_REFERENCE_BYTES).min(bytes);
        let most_references = (reference_bytes / References::BYTES).max(1) as u32;
        Ok(Self {
            most_references,
            most_vertices: (bytes / Vertices::POINT_BYTES).min(MAX_VERTICES) as u32,
            vertices: Vertices::new(backend, LEAST_VERTICES)?,
            references: References::new(backend, most_references.min(LEAST_REFERENCES))?,
            screen: Screen::new(backend, size, LEAST_SLOTS, output)?,
            grids: backend.create_buffer(&BufferDesc::indirect("hair.render.tile_grids", GRIDS_BYTES))?,
            grids_again: backend.create_buffer(&BufferDesc::indirect("hair.render.grids_again", AGAIN_BYTES))?,
            counters: ViewCounters::new(backend, output.views, kept(size))?,
            is_new: true,
            uniforms: UniformArray::new(backend, "hair.render.tile_uniforms", MAX_VIEWS * UNIFORMS_OF_A_VIEW)?,
        })
    }

    /// Tiles that there can be.
    pub(crate) fn most_slots(&self) -> u64 {
        tile_count(self.screen.size).into()
    }

    /// What may be predicted for one round, before room is added for what the next frame may need.
    pub(crate) fn largest_round(&self) -> f64 {
        f64::from(self.most_references) / HEADROOM
    }

    /// So many references are nearly too many for one round.
    pub(crate) fn crowd(&self) -> u32 {
        (CROWD * self.largest_round()) as u32
    }

    pub(crate) fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        let output = self.screen.resolved.output;
        let screen = Screen::new(backend, size, LEAST_SLOTS, output)?;
        let counters = ViewCounters::new(backend, output.views, kept(size))?;
        std::mem::replace(&mut self.screen, screen).destroy(backend);
        std::mem::replace(&mut self.counters, counters).destroy(backend);
        self.is_new = true;
        Ok(())
    }

    /// Makes room for so many references, for more than are allowed in rounds, for tiles, and for vertices.
    pub(crate) fn grow(
        &mut self,
        backend: &mut dyn Backend,
        Wanted { kept: wanted, tiles, vertices }: Wanted,
    ) -> Result<()> {
        let slots = tiles.min(self.most_slots()) as u32;
        let more = |slots| self.screen.resolved.more_colors(backend, slots);
        let colors = (slots > self.screen.resolved.slots).then_some(slots).map(more).transpose()?;
        let count = wanted.min(u64::from(self.most_references)) as u32;
        let more = |count| References::new(backend, count);
        let references = (count > self.references.count).then_some(count).map(more).transpose()?;
        let vertices = vertices.min(self.most_vertices.into()) as u32;
        if vertices > self.vertices.count {
            let vertices = Vertices::new(backend, vertices)?;
            self.replace_vertices(backend, vertices);
        }
        if let Some(grown) = references {
            let old = std::mem::replace(&mut self.references, grown);
            self.references.rounds = old.rounds;
            backend.destroy(old.buffer.into());
        }
        if let Some(colors) = colors {
            self.screen.replace_colors(backend, colors, slots);
        }
        if wanted > u64::from(self.references.covered()) {
            self.references.rounds = self.references.rounds.max(self.rounds_for(wanted));
        }
        Ok(())
    }

    fn replace_vertices(&mut self, backend: &mut dyn Backend, vertices: Vertices) {
        std::mem::replace(&mut self.vertices, vertices).destroy(backend);
    }

    /// Gives back what is much more than is needed.
    pub(crate) fn shrink(
        &mut self,
        backend: &mut dyn Backend,
        Wanted { kept: references, tiles, vertices }: Wanted,
    ) -> Result<()> {
        let fewer = |room: u32, needed: u64, least: u32, most: u64| {
            let is_surplus = is_surplus(room.into(), needed.max(least.into()), SURPLUS);
            let count = times(needed, SETTLED).max(least.into()).min(most) as u32;
            (is_surplus && count < room).then_some(count)
        };
        let slots = fewer(self.screen.resolved.slots, tiles, LEAST_SLOTS, self.most_slots());
        let references = fewer(self.references.count, references, LEAST_REFERENCES, self.most_references.into());
        let vertices = fewer(self.vertices.count, vertices, LEAST_VERTICES, self.most_vertices.into());
        // All are made before one is replaced: what cannot be made leaves all as it was.
        let colors = slots.map(|slots| self.screen.resolved.more_colors(backend, slots)).transpose()?;
        let references = references.map(|count| References::new(backend, count)).transpose()?;
        let vertices = vertices.map(|count| Vertices::new(backend, count)).transpose()?;
        if let (Some(colors), Some(slots)) = (colors, slots) {
            self.screen.replace_colors(backend, colors, slots);
        }
        if let Some(smaller) = references {
            backend.destroy(std::mem::replace(&mut self.references, smaller).buffer.into());
        }
        if let Some(smaller) = vertices {
            self.replace_vertices(backend, smaller);
        }
        Ok(())
    }

    /// Rounds in which so many references have room.
    fn rounds_for(&self, wanted: u64) -> u32 {
        let References { count, .. } = self.references;
        let before_last = wanted.saturating_sub(count.into()).div_ceil(self.references.window().into());
        (1 + before_last).min(MAX_ROUNDS.into()) as u32
    }

    /// Whether so many references take fewer rounds than there are.
    pub(crate) fn has_rounds_to_spare(&self, references: u64) -> bool {
        self.rounds_for(with_headroom(references)) < self.references.rounds
    }

    /// As few rounds as so many references take.
    pub(crate) fn spare_rounds(&mut self, references: u64) {
        self.references.rounds = self.rounds_for(with_headroom(references));
    }

    pub(crate) fn bytes(&self) -> u64 {
        let tiles = sizes(self.screen.size).map(|bytes| bytes.max(16)).iter().sum::<u64>();
        let references = (References::BYTES * u64::from(self.references.count)).max(16);
        let views = self.counters.bytes() + self.uniforms.bytes();
        tiles
            + self.vertices.bytes()
            + references
            + self.screen.resolved.bytes(self.screen.size)
            + GRIDS_BYTES
            + AGAIN_BYTES
            + views
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.screen.destroy(backend);
        self.counters.destroy(backend);
        self.uniforms.destroy(backend);
        self.vertices.destroy(backend);
        [self.references.buffer, self.grids, self.grids_again]
            .into_iter()
            .for_each(|buffer| backend.destroy(buffer.into()));
    }

    /// What the kernels of a view are given: for counting, or for a round.
    pub(crate) fn uniform(&self, view: usize, round: Option<u32>) -> Binding {
        self.uniforms.binding(view * UNIFORMS_OF_A_VIEW + round.map_or(0, |round| 1 + round as usize))
    }

    /// The groups of `tile_bin`.
    pub(crate) fn bin_grid(&self, draws: &[SectionDraw]) -> Grid {
        bin_grid(drawn_vertices(draws).min(self.vertices.count.into()) as u32)
    }

    /// The groups of `tile_blend`.
    pub(crate) fn blend_groups(&self) -> Groups {
        grid(self.grids, BLEND_GRID)
    }

    /// The groups of `tile_bin` that stores in a round.
    pub(crate) fn store_groups(&self, round: u32) -> Groups {
        grid(self.grids, STORE_GRIDS + round)
    }

    /// The groups of `tile_bin` that counts and of `tile_alloc`, for tiles that are blended again.
    pub(crate) fn groups_again(&self) -> [Groups; 2] {
        [0, 1].map(|number| grid(self.grids_again, number))
    }

    /// Begins a frame with so many views.
    pub(crate) fn begin(&mut self, list: &mut PassList, views: usize) {
        if std::mem::take(&mut self.is_new) {
            self.counters.forget(list);
        }
        self.counters.clear(list, views);
    }

    /// Empties bins and the queue for a view of this size; no tile is drawn again.
    pub(crate) fn clear(&self, list: &mut PassList, size: [u32; 2]) {
        self.screen.resolved.clear(list);
        list.clear(self.screen.bins, 0, sizes(size)[0]);
        list.clear(self.screen.blocks, 0, BLOCKS_HEADER);
        self.clear_queue(list);
    }

    /// Empties blocks and the queue, for tiles that are drawn again.
    pub(crate) fn clear_again(&self, list: &mut PassList, size: [u32; 2]) {
        list.clear(self.screen.blocks, 0, sizes(size)[2]);
        self.clear_queue(list);
    }

    /// No tile waits.
    fn clear_queue(&self, list: &mut PassList) {
        list.clear(self.screen.queue, 0, QUEUE_HEADER);
        list.clear(self.grids, 0, GRIDS_BYTES);
        list.clear(self.grids_again, 0, AGAIN_BYTES);
    }
}

/// As many groups as a grid of a buffer has.
fn grid(buffer: BufferId, number: u32) -> Groups {
    Groups::Indirect { buffer, offset: GRID_BYTES * u64::from(number) }
}
