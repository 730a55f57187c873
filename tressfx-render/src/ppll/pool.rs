//! Memory of the lists of fragments, and what becomes of them.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::Result;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;

use super::{PpllDesc, Tail};
use crate::counters::ViewCounters;
use crate::renderer::with_headroom;
use crate::resolved::{pixels, storage};
use crate::usage::is_surplus;
use crate::views::BoundView;

/// A pool is made smaller that is more than so many times as large as what was needed.
const SURPLUS: f64 = 1.6;

/// Nodes of lists that are not in use.
const IDLE_NODES: u32 = 1 << 10;

/// Bytes of a fragment: depth key, colour and alpha, next; with several places, what it covers.
fn node_bytes(desc: &PpllDesc) -> u64 {
    if desc.places > 1 { 20 } else { 16 }
}

/// Bytes of the number of the first node of a pixel.
pub(crate) const HEAD_BYTES: u64 = 4;

gpu_struct! {
    /// Limits of the pool.
    pub(crate) struct PoolUniform {
        /// Fragments that there is room for.
        pub capacity: u32,
        /// Where counting ends.
        pub limit: u32,
        /// Requests up to this one are added without a look at the limit.
        pub small_request: u32,
        /// Where not all fragments have a node: how many of a pixel have.
        pub kept: u32,
        /// How many of a pixel were to have one.
        pub asked: u32,
        /// 1 where the colours of a tail are weighted by what is seen of them.
        pub weighs: u32,
        /// How many of the nearest are put in order.
        pub sorted: u32,
        /// Nothing.
        pub unused_2: u32,
        /// The colour of a tail that is not shaded.
        pub unlit: [f32; 4],
    }
}

/// Nodes that are not in use yet.
#[derive(Debug)]
pub(crate) struct Nodes {
    buffer: BufferId,
    capacity: u32,
}

/// Lists of fragments, one a pixel.
#[derive(Debug)]
pub(crate) struct NodePool {
    /// `u32` a pixel: the number of the first node, from 1; 0 for none.
    pub(crate) heads: BufferId,
    /// Four `u32` a fragment, or five.
    pub(crate) nodes: BufferId,
    /// Bytes of a fragment.
    node_bytes: u64,
    /// What is counted of each view.
    pub(crate) counters: ViewCounters,
    /// [`PoolUniform`].
    pub(crate) uniform: BufferId,
    /// How many fragments there is room for.
    pub(crate) capacity: u32,
    /// How many there is room for at least.
    least: u32,
    /// How many there may be room for.
    pub(crate) largest: u32,
    count_limit: u32,
}

impl NodePool {
    /// A pool for `size` pixels, one fragment for each, and for so many views.
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], desc: &PpllDesc, views: usize) -> Result<Self> {
        let pixels = pixels(size);
        let caps = backend.caps();
        let bytes = desc.max_node_bytes.min(caps.max_storage_binding_bytes).min(caps.max_buffer_bytes);
        let count_limit = desc.count_limit.clamp(1, PpllDesc::COUNT_LIMIT);
        let node_bytes = node_bytes(desc);
        let largest = (bytes / node_bytes).clamp(1, u64::from(count_limit)) as u32;
        let capacity = pixels.clamp(1, u64::from(largest)) as u32;
        let heads = storage(backend, "hair.render.heads", HEAD_BYTES * pixels)?;
        let counters = ViewCounters::new(backend, views, 0)?;
        let nodes = storage(backend, "hair.render.nodes", u64::from(capacity) * node_bytes)?;
        let uniform =
            backend.create_buffer(&BufferDesc::uniform("hair.render.pool", size_of::<PoolUniform>() as u64))?;
        Ok(Self { heads, nodes, node_bytes, counters, uniform, capacity, least: capacity, largest, count_limit })
    }

    /// Nodes for `wanted` fragments, or for as many as are allowed, where there is less room; it changes nothing yet.
    pub(crate) fn prepare(&self, backend: &mut dyn Backend, wanted: u64) -> Result<Option<Nodes>> {
        let capacity = wanted.min(u64::from(self.largest)) as u32;
        if capacity > self.capacity { self.nodes_for(backend, capacity).map(Some) } else { Ok(None) }
    }

    /// Nodes for `needed` fragments and some more, where there is much more room; it changes nothing yet.
    pub(crate) fn prepare_smaller(&self, backend: &mut dyn Backend, needed: u64) -> Result<Option<Nodes>> {
        let capacity = with_headroom(needed).clamp(u64::from(self.least), u64::from(self.largest)) as u32;
        let shrinks = capacity < self.capacity && is_surplus(self.capacity.into(), needed, SURPLUS);
        if shrinks { self.nodes_for(backend, capacity).map(Some) } else { Ok(None) }
    }

    /// As few nodes as a pool may have while nobody fills it; it changes nothing yet.
    pub(crate) fn prepare_idle(&self, backend: &mut dyn Backend) -> Result<Option<Nodes>> {
        let capacity = IDLE_NODES.min(self.least);
        if capacity < self.capacity { self.nodes_for(backend, capacity).map(Some) } else { Ok(None) }
    }

    fn nodes_for(&self, backend: &mut dyn Backend, capacity: u32) -> Result<Nodes> {
        // To destroy the old nodes before would free nothing yet, since older lists may still name them.
        let buffer = storage(backend, "hair.render.nodes", u64::from(capacity) * self.node_bytes)?;
        Ok(Nodes { buffer, capacity })
    }

    /// Uses other nodes. What the pool held is lost.
    pub(crate) fn replace(&mut self, backend: &mut dyn Backend, nodes: Nodes) {
        backend.destroy(std::mem::replace(&mut self.nodes, nodes.buffer).into());
        self.capacity = nodes.capacity;
    }

    /// Sets the counters of views to zero.
    pub(crate) fn begin(&self, list: &mut PassList, views: usize) {
        self.counters.clear(list, views);
    }

    /// What the limits are when so many groups ask for room, of the nearest fragments of a pixel as many as are `kept` of those
    /// that are `asked` for, and what is seen of a tail: `unlit` is the colour of one that is not shaded.
    pub(crate) fn upload(&self, list: &mut PassList, groups: u64, kept: u32, desc: &PpllDesc, unlit: [f32; 4]) {
        let uniform = PoolUniform {
            capacity: self.capacity,
            limit: self.count_limit,
            small_request: (u64::from(self.count_limit) / groups.max(1)) as u32,
            kept,
            asked: desc.asked(),
            weighs: u32::from(desc.tail == Tail::Weighted),
            sorted: desc.k,
            unused_2: 0,
            unlit,
        };
        list.upload(self.uniform, 0, &[uniform]);
    }

    /// What the shaders that fill it bind of it, beside the heads.
    pub(crate) fn bindings(&self, view: &BoundView) -> [(&'static str, Binding); 3] {
        [("pool", self.uniform.into()), ("nodes", self.nodes.into()), ("counters", self.counters.of(view.index).into())]
    }

    /// What it takes for `size` pixels.
    pub(crate) fn bytes(&self, size: [u32; 2]) -> u64 {
        let nodes = (u64::from(self.capacity) * self.node_bytes).max(16);
        (HEAD_BYTES * pixels(size)).max(16) + nodes + size_of::<PoolUniform>() as u64 + self.counters.bytes()
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.counters.destroy(backend);
        [self.heads, self.nodes, self.uniform].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}
