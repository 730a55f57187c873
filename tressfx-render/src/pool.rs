//! Memory of the A-buffer: lists of fragments, and what becomes of them.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::resolve::TILE;

/// Bytes of a fragment: depth key, colour and alpha, next.
pub(crate) const NODE_BYTES: u64 = 16;

gpu_struct! {
    /// What the last frame drew.
    pub struct Counters {
        /// Fragments that passed the depth test.
        pub fragments: u32,
        /// Of those, the ones that found no room in the pool and are missing in the picture.
        pub dropped: u32,
        /// Pixels with at least one fragment.
        pub pixels_with_hair: u32,
    }
}

impl Default for Counters {
    /// Nothing.
    fn default() -> Self {
        bytemuck::Zeroable::zeroed()
    }
}

impl Counters {
    /// Size of the counters on the GPU.
    pub(crate) const BYTES: u64 = size_of::<Self>() as u64;

    /// From the bytes of a read-back.
    ///
    /// # Panics
    /// If there are not 12 bytes.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        bytemuck::pod_read_unaligned(bytes)
    }
}

fn storage(backend: &mut dyn Backend, label: Label, bytes: u64) -> Result<BufferId> {
    backend.create_buffer(&BufferDesc::storage(label, bytes))
}

/// Lists of fragments, one a pixel.
#[derive(Debug)]
pub(crate) struct NodePool {
    /// `u32` a pixel: the number of the first node, from 1; 0 for none.
    pub(crate) heads: BufferId,
    /// `vec4<u32>` a fragment.
    pub(crate) nodes: BufferId,
    /// [`Counters`].
    pub(crate) counters: BufferId,
    /// How many fragments there is room for.
    pub(crate) capacity: u32,
    limit: u32,
    pixels: u64,
}

impl NodePool {
    /// A pool for `size` pixels, one fragment for each, that never grows beyond `max_bytes`.
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], max_bytes: u64) -> Result<Self> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let caps = backend.caps();
        let bytes = max_bytes.min(caps.max_storage_binding_bytes).min(caps.max_buffer_bytes);
        let limit = u32::try_from(bytes / NODE_BYTES).unwrap_or(u32::MAX - 1).max(1);
        let capacity = limit.min(u32::try_from(pixels).unwrap_or(u32::MAX));
        let heads = storage(backend, "hair.render.heads", 4 * pixels)?;
        let counters = storage(backend, "hair.render.counters", Counters::BYTES)?;
        let nodes = storage(backend, "hair.render.nodes", u64::from(capacity) * NODE_BYTES)?;
        Ok(Self { heads, nodes, counters, capacity, limit, pixels })
    }

    /// Makes room for `wanted` fragments, or for as many as are allowed. What the pool held is lost.
    pub(crate) fn grow(&mut self, backend: &mut dyn Backend, wanted: u64) -> Result<()> {
        let capacity = wanted.min(u64::from(self.limit)) as u32;
        if capacity <= self.capacity {
            return Ok(());
        }
        // The old nodes go first: both together may be more than the caller allows.
        backend.destroy(self.nodes.into());
        let made = storage(backend, "hair.render.nodes", u64::from(capacity) * NODE_BYTES);
        match made {
            Ok(nodes) => (self.nodes, self.capacity) = (nodes, capacity),
            Err(_) => self.nodes = storage(backend, "hair.render.nodes", u64::from(self.capacity) * NODE_BYTES)?,
        }
        made.map(drop)
    }

    /// Empties the lists.
    pub(crate) fn clear(&self, list: &mut PassList) {
        list.clear(self.heads, 0, 4 * self.pixels);
    }

    /// Sets the counters to zero.
    pub(crate) fn clear_counters(&self, list: &mut PassList) {
        list.clear(self.counters, 0, Counters::BYTES);
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        [self.heads, self.nodes, self.counters].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

/// Hair without what is behind it.
#[derive(Debug)]
pub(crate) struct Resolved {
    /// `vec2<u32>` a pixel: four half floats, premultiplied colour and alpha. Only pixels of tiles with hair are written.
    pub(crate) colors: BufferId,
    /// `u32` a tile: how many of its pixels have hair.
    pub(crate) tiles: BufferId,
    /// In pixels.
    pub(crate) size: [u32; 2],
}

impl Resolved {
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2]) -> Result<Self> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let tiles = u64::from(tile_count(size));
        let colors = storage(backend, "hair.render.resolved", 8 * pixels)?;
        Ok(Self { colors, tiles: storage(backend, "hair.render.tiles", 4 * tiles)?, size })
    }

    pub(crate) fn tile_count(&self) -> u32 {
        tile_count(self.size)
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        [self.colors, self.tiles].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

fn tile_count(size: [u32; 2]) -> u32 {
    size[0].div_ceil(TILE) * size[1].div_ceil(TILE)
}
