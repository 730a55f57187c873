//! Memory of the lists of fragments, and what becomes of them.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use super::PpllDesc;
use super::resolve::TILE;
use crate::views::MAX_VIEWS;

/// Bytes of a fragment: depth key, colour and alpha, next.
pub(crate) const NODE_BYTES: u64 = 16;

gpu_struct! {
    /// What was drawn of a view.
    pub struct Counters {
        /// Fragments that passed the depth test. Where it is saturated, there were at least so many.
        pub fragments: u32,
        /// Of those, the ones that found no room in the pool and are missing in the picture.
        pub dropped: u32,
        /// Pixels with at least one fragment.
        pub pixels_with_hair: u32,
        /// 1 where there were more fragments than can be counted, else 0.
        pub saturated: u32,
    }
}

gpu_struct! {
    /// Limits of the pool.
    pub(crate) struct PoolUniform {
        /// Fragments that there is room for.
        pub capacity: u32,
        /// Where counting ends.
        pub limit: u32,
        /// Requests up to this one are added without a look at the limit.
        pub small_request: u32,
        /// Nothing.
        pub unused: u32,
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
    /// If there are not 16 bytes.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        bytemuck::pod_read_unaligned(bytes)
    }
}

fn storage(backend: &mut dyn Backend, label: Label, bytes: u64) -> Result<BufferId> {
    backend.create_buffer(&BufferDesc::storage(label, bytes.max(16)))
}

/// Lists of fragments, one a pixel.
#[derive(Debug)]
pub(crate) struct NodePool {
    /// `u32` a pixel: the number of the first node, from 1; 0 for none.
    pub(crate) heads: BufferId,
    /// `vec4<u32>` a fragment.
    pub(crate) nodes: BufferId,
    /// [`Counters`] of each view.
    pub(crate) counters: [BufferId; MAX_VIEWS],
    /// [`PoolUniform`].
    pub(crate) uniform: BufferId,
    /// How many fragments there is room for.
    pub(crate) capacity: u32,
    /// How many there may be room for.
    largest: u32,
    count_limit: u32,
}

impl NodePool {
    /// A pool for `size` pixels, one fragment for each.
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], desc: &PpllDesc) -> Result<Self> {
        let pixels = pixels(size);
        let caps = backend.caps();
        let bytes = desc.max_node_bytes.min(caps.max_storage_binding_bytes).min(caps.max_buffer_bytes);
        let count_limit = desc.count_limit.clamp(1, PpllDesc::COUNT_LIMIT);
        let largest = (bytes / NODE_BYTES).clamp(1, u64::from(count_limit)) as u32;
        let capacity = pixels.clamp(1, u64::from(largest)) as u32;
        let heads = storage(backend, "hair.render.heads", 4 * pixels)?;
        let mut counters = Vec::new();
        for _ in 0..MAX_VIEWS {
            counters.push(storage(backend, "hair.render.counters", Counters::BYTES)?);
        }
        let counters = counters.try_into().expect("as many as there are views");
        let nodes = storage(backend, "hair.render.nodes", u64::from(capacity) * NODE_BYTES)?;
        let uniform =
            backend.create_buffer(&BufferDesc::uniform("hair.render.pool", size_of::<PoolUniform>() as u64))?;
        Ok(Self { heads, nodes, counters, uniform, capacity, largest, count_limit })
    }

    /// Makes room for `wanted` fragments, or for as many as are allowed. What the pool held is lost.
    pub(crate) fn grow(&mut self, backend: &mut dyn Backend, wanted: u64) -> Result<()> {
        let capacity = wanted.min(u64::from(self.largest)) as u32;
        if capacity <= self.capacity {
            return Ok(());
        }
        // The new nodes come first: if they cannot be made, the pool is as it was. To destroy the old ones before would free
        // nothing yet, since older lists may still name them.
        let nodes = storage(backend, "hair.render.nodes", u64::from(capacity) * NODE_BYTES)?;
        backend.destroy(std::mem::replace(&mut self.nodes, nodes).into());
        self.capacity = capacity;
        Ok(())
    }

    /// Sets the counters of views to zero, and says what the limits are when so many groups ask for room.
    pub(crate) fn begin(&self, list: &mut PassList, views: usize, groups: u64) {
        let uniform = PoolUniform {
            capacity: self.capacity,
            limit: self.count_limit,
            small_request: (u64::from(self.count_limit) / groups.max(1)) as u32,
            unused: 0,
        };
        list.upload(self.uniform, 0, &[uniform]);
        self.counters[..views].iter().for_each(|&counters| list.clear(counters, 0, Counters::BYTES));
    }

    /// Empties the lists of a view.
    pub(crate) fn clear_heads(&self, list: &mut PassList, size: [u32; 2]) {
        list.clear(self.heads, 0, 4 * pixels(size));
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        let rest = [self.heads, self.nodes, self.uniform];
        self.counters.into_iter().chain(rest).for_each(|buffer| backend.destroy(buffer.into()));
    }
}

/// Hair without what is behind it.
#[derive(Debug)]
pub(crate) struct Resolved {
    /// `vec2<u32>` a pixel: four half floats, premultiplied colour and alpha. Only pixels of tiles with hair are written.
    pub(crate) colors: BufferId,
    /// `u32` a tile: how many of its pixels have hair.
    pub(crate) tiles: BufferId,
}

impl Resolved {
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2]) -> Result<Self> {
        let colors = storage(backend, "hair.render.resolved", 8 * pixels(size))?;
        Ok(Self { colors, tiles: storage(backend, "hair.render.tiles", 4 * u64::from(tile_count(size)))? })
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        [self.colors, self.tiles].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

fn pixels(size: [u32; 2]) -> u64 {
    u64::from(size[0]) * u64::from(size[1])
}

/// Tiles that a picture of this size has.
pub(crate) fn tile_count(size: [u32; 2]) -> u32 {
    size[0].div_ceil(TILE) * size[1].div_ceil(TILE)
}
