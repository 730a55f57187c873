//! What tiles keep.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;
use tressfx_core::uniform_array::UniformArray;

use super::TilesDesc;
use super::layout::{SLICES, TilesUniform};
use crate::counters::ViewCounters;
use crate::renderer::{HEADROOM, with_headroom};
use crate::resolved::{Resolved, pixels, storage, tile_count};
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

/// References that there is room for at least, unless fewer are allowed.
const LEAST_REFERENCES: u32 = 1 << 16;

/// Bytes of a grid of groups.
const GROUPS_BYTES: u64 = 12;

/// Vertices of all sections, on the screen.
#[derive(Debug)]
pub(crate) struct Vertices {
    /// `vec4<f32>` a vertex, see `segments.wgsl`.
    pub(crate) points: BufferId,
    /// `vec2<u32>` a vertex: four half floats, colour and opacity.
    pub(crate) paints: BufferId,
    /// How many there is room for.
    pub(crate) count: u64,
}

impl Vertices {
    fn new(backend: &mut dyn Backend, count: u64) -> Result<Self> {
        let points = storage(backend, "hair.render.points", 16 * count)?;
        Ok(Self { points, paints: storage(backend, "hair.render.paints", 8 * count)?, count })
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
    /// has the other half for itself.
    pub(crate) fn covered(&self) -> u32 {
        if self.rounds == 1 { self.count } else { self.rounds.saturating_mul(self.window()) }
    }

    /// The first reference of a round, and the one after the last with which a tile may begin.
    pub(crate) fn round(&self, round: u32) -> [u32; 2] {
        if self.rounds == 1 {
            [0, u32::MAX]
        } else {
            [round, round + 1].map(|round| round.saturating_mul(self.window()))
        }
    }

    fn window(&self) -> u32 {
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
    /// `f32` a tile: the nearness of the farthest that the scene shows.
    pub(crate) depths: BufferId,
    /// `f32` a tile: the nearness of its nearest vertex.
    pub(crate) nearests: BufferId,
    /// `u32` a tile: its first reference.
    pub(crate) firsts: BufferId,
    /// Tiles that have references.
    pub(crate) queue: BufferId,
    /// The colours of the pixels.
    pub(crate) resolved: Resolved,
}

impl Screen {
    fn new(backend: &mut dyn Backend, size: [u32; 2]) -> Result<Self> {
        let [bins, depths, queue] = sizes(size);
        Ok(Self {
            size,
            bins: storage(backend, "hair.render.bins", bins)?,
            depths: storage(backend, "hair.render.tile_depths", depths)?,
            nearests: storage(backend, "hair.render.nearests", depths)?,
            firsts: storage(backend, "hair.render.firsts", depths)?,
            queue: storage(backend, "hair.render.queue", queue)?,
            resolved: Resolved::new(backend, size)?,
        })
    }

    fn destroy(self, backend: &mut dyn Backend) {
        self.resolved.destroy(backend);
        [self.bins, self.depths, self.nearests, self.firsts, self.queue]
            .into_iter()
            .for_each(|buffer| backend.destroy(buffer.into()));
    }
}

/// Bytes of bins, depths, which are as many as nearests and firsts, and queue.
fn sizes(size: [u32; 2]) -> [u64; 3] {
    let tiles = u64::from(tile_count(size));
    [4 * u64::from(SLICES) * tiles, 4 * tiles, QUEUE_HEADER + 16 * CLASSES * tiles]
}

/// Bytes of the largest buffer that a screen of this size takes.
pub(crate) fn largest_binding(size: [u32; 2]) -> u64 {
    sizes(size).into_iter().max().unwrap_or(0).max(Resolved::PIXEL_BYTES * pixels(size))
}

/// The buffers of tiles.
#[derive(Debug)]
pub(crate) struct Memory {
    most_references: u32,
    pub(crate) vertices: Vertices,
    pub(crate) references: References,
    pub(crate) screen: Screen,
    /// The grid of groups that blends tiles.
    pub(crate) groups: BufferId,
    /// What is counted of each view.
    pub(crate) counters: ViewCounters,
    /// [`TilesUniform`] for counting and for storing, of each view.
    pub(crate) uniforms: UniformArray<TilesUniform>,
}

impl Memory {
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], desc: &TilesDesc) -> Result<Self> {
        let caps = backend.caps();
        let bytes = desc.max_reference_bytes.min(TilesDesc::MAX_REFERENCE_BYTES);
        let bytes = bytes.min(caps.max_storage_binding_bytes).min(caps.max_buffer_bytes);
        let most_references = (bytes / References::BYTES).max(1) as u32;
        Ok(Self {
            most_references,
            vertices: Vertices::new(backend, 0)?,
            references: References::new(backend, most_references.min(LEAST_REFERENCES))?,
            screen: Screen::new(backend, size)?,
            groups: backend.create_buffer(&BufferDesc::indirect("hair.render.tile_groups", GROUPS_BYTES))?,
            counters: ViewCounters::new(backend)?,
            uniforms: UniformArray::new(backend, "hair.render.tile_uniforms", MAX_VIEWS * UNIFORMS_OF_A_VIEW)?,
        })
    }

    /// What may be predicted for one round, before room is added for what the next frame may need.
    pub(crate) fn largest_round(&self) -> f64 {
        f64::from(self.most_references) / HEADROOM
    }

    pub(crate) fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        let screen = Screen::new(backend, size)?;
        std::mem::replace(&mut self.screen, screen).destroy(backend);
        Ok(())
    }

    /// Makes room for `wanted` references, for more than are allowed in rounds, and for `vertices`.
    pub(crate) fn grow(&mut self, backend: &mut dyn Backend, wanted: u64, vertices: u64) -> Result<()> {
        let count = wanted.min(u64::from(self.most_references)) as u32;
        let more = |count| References::new(backend, count);
        let references = (count > self.references.count).then_some(count).map(more).transpose()?;
        if vertices > self.vertices.count {
            let vertices = Vertices::new(backend, vertices)?;
            self.replace_vertices(backend, vertices);
        }
        if let Some(grown) = references {
            let old = std::mem::replace(&mut self.references, grown);
            self.references.rounds = old.rounds;
            backend.destroy(old.buffer.into());
        }
        if wanted > u64::from(self.references.covered()) {
            let rounds = wanted.div_ceil(u64::from(self.references.window())).min(u64::from(MAX_ROUNDS)) as u32;
            self.references.rounds = self.references.rounds.max(rounds);
        }
        Ok(())
    }

    fn replace_vertices(&mut self, backend: &mut dyn Backend, vertices: Vertices) {
        let old = std::mem::replace(&mut self.vertices, vertices);
        [old.points, old.paints].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }

    /// Gives back what is much more than is needed.
    pub(crate) fn shrink(&mut self, backend: &mut dyn Backend, references: u64, vertices: u64) -> Result<()> {
        let wanted = with_headroom(references).max(LEAST_REFERENCES.into());
        let count = wanted.min(self.most_references.into()) as u32;
        let shrinks = count < self.references.count && is_surplus(self.references.count.into(), references);
        let smaller = if shrinks { Some(References::new(backend, count)?) } else { None };
        if is_surplus(self.vertices.count, vertices) {
            let smaller = Vertices::new(backend, vertices)?;
            self.replace_vertices(backend, smaller);
        }
        if let Some(smaller) = smaller {
            backend.destroy(std::mem::replace(&mut self.references, smaller).buffer.into());
        } else if self.references.rounds > 1 && wanted <= u64::from(self.references.count) {
            self.references.rounds = 1;
        }
        Ok(())
    }

    pub(crate) fn bytes(&self) -> u64 {
        let [bins, depths, queue] = sizes(self.screen.size);
        let vertices = [16, 8].map(|bytes| (bytes * self.vertices.count).max(16));
        let references = (References::BYTES * u64::from(self.references.count)).max(16);
        let tiles = [bins, depths, depths, depths, queue].map(|bytes| bytes.max(16));
        let rest = Resolved::bytes(self.screen.size) + GROUPS_BYTES + ViewCounters::BYTES + self.uniforms.bytes();
        tiles.iter().chain(&vertices).sum::<u64>() + references + rest
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.screen.destroy(backend);
        self.counters.destroy(backend);
        self.uniforms.destroy(backend);
        let Vertices { points, paints, .. } = self.vertices;
        [points, paints, self.references.buffer, self.groups]
            .into_iter()
            .for_each(|buffer| backend.destroy(buffer.into()));
    }

    /// What the kernels of a view are given: for counting, or for a round.
    pub(crate) fn uniform(&self, view: usize, round: Option<u32>) -> Binding {
        self.uniforms.binding(view * UNIFORMS_OF_A_VIEW + round.map_or(0, |round| 1 + round as usize))
    }

    /// Empties bins, nearests and the queue for a view of this size.
    pub(crate) fn clear(&self, list: &mut PassList, size: [u32; 2]) {
        self.screen.resolved.clear(list);
        list.clear(self.screen.bins, 0, sizes(size)[0]);
        list.clear(self.screen.nearests, 0, sizes(size)[1]);
        list.clear(self.screen.queue, 0, QUEUE_HEADER);
        list.clear(self.groups, 0, GROUPS_BYTES);
    }
}
