//! Memory of the lists of fragments, and what becomes of them.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::Result;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;

use super::PpllDesc;
use crate::counters::ViewCounters;
use crate::resolved::{pixels, storage};
use crate::views::BoundView;

/// Bytes of a fragment: depth key, colour and alpha, next.
pub(crate) const NODE_BYTES: u64 = 16;

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
        /// The colour of a tail that is not shaded.
        pub unlit: [f32; 4],
    }
}

/// Lists of fragments, one a pixel.
#[derive(Debug)]
pub(crate) struct NodePool {
    /// `u32` a pixel: the number of the first node, from 1; 0 for none.
    pub(crate) heads: BufferId,
    /// `vec4<u32>` a fragment.
    pub(crate) nodes: BufferId,
    /// What is counted of each view.
    pub(crate) counters: ViewCounters,
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
        let counters = ViewCounters::new(backend)?;
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

    /// Sets the counters of views to zero, and says what the limits are when so many groups ask for room, and what colour a tail
    /// has that is not shaded.
    pub(crate) fn begin(&self, list: &mut PassList, views: usize, groups: u64, unlit: [f32; 4]) {
        let uniform = PoolUniform {
            capacity: self.capacity,
            limit: self.count_limit,
            small_request: (u64::from(self.count_limit) / groups.max(1)) as u32,
            unused: 0,
            unlit,
        };
        list.upload(self.uniform, 0, &[uniform]);
        self.counters.clear(list, views);
    }

    /// What the shaders that fill it bind of it.
    pub(crate) fn bindings(&self, view: &BoundView) -> [(&'static str, Binding); 4] {
        [
            ("pool", self.uniform.into()),
            ("heads", self.heads.into()),
            ("nodes", self.nodes.into()),
            ("counters", self.counters.of(view.index).into()),
        ]
    }

    /// Empties the lists of a view.
    pub(crate) fn clear_heads(&self, list: &mut PassList, size: [u32; 2]) {
        list.clear(self.heads, 0, 4 * pixels(size));
    }

    /// What it takes for `size` pixels.
    pub(crate) fn bytes(&self, size: [u32; 2]) -> u64 {
        let nodes = (u64::from(self.capacity) * NODE_BYTES).max(16);
        (4 * pixels(size)).max(16) + nodes + size_of::<PoolUniform>() as u64 + ViewCounters::BYTES
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.counters.destroy(backend);
        [self.heads, self.nodes, self.uniform].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}
