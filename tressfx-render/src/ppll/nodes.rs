//! `nodes` and `more_nodes`: the fragments of all lists. Where a device lets one binding hold less than they may take, there are two buffers of them.

use tressfx_core::backend::{Backend, Caps};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::shader::Binding;

use super::PpllDesc;
use crate::resolved::storage;

/// Storage buffers that the kernels with two buffers of nodes have.
const BUFFERS_WITH_MORE: u32 = 8;

/// Bytes of a fragment: depth key, colour and alpha, next; with several places, what it covers.
fn node_bytes(desc: &PpllDesc) -> u64 {
    if desc.places > 1 { 20 } else { 16 }
}

/// How many nodes there may be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeLimits {
    node_bytes: u64,
    /// In the first buffer.
    pub(crate) first: u32,
    /// In both.
    both: u32,
}

impl NodeLimits {
    pub(crate) fn new(caps: &Caps, desc: &PpllDesc, count_limit: u32) -> Self {
        let node_bytes = node_bytes(desc);
        let of_one = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes);
        let buffers = if caps.max_storage_buffers_per_stage < BUFFERS_WITH_MORE { 1 } else { 2 };
        let nodes_in = |bytes: u64| (bytes / node_bytes).clamp(1, u64::from(count_limit)) as u32;
        let [first, both] =
            [1, buffers].map(|buffers| nodes_in(desc.max_node_bytes.min(of_one.saturating_mul(buffers))));
        Self { node_bytes, first, both }
    }

    /// Whether there are two buffers. Bounded lists have one: their kernels have no binding left.
    pub(crate) fn has_more(&self, is_bounded: bool) -> bool {
        self.both > self.first && !is_bounded
    }

    /// How many there may be.
    pub(crate) fn largest(&self, is_bounded: bool) -> u32 {
        if is_bounded { self.first } else { self.both }
    }

    /// Bytes of `nodes`, and of `more_nodes`; no buffer is empty.
    fn bytes(&self, capacity: u32) -> [u64; 2] {
        let more = if self.has_more(false) { (capacity.max(self.first) - self.first).max(1) } else { 0 };
        [capacity.clamp(1, self.first), more].map(|nodes| u64::from(nodes) * self.node_bytes)
    }

    /// Nodes for so many fragments.
    pub(crate) fn make(&self, backend: &mut dyn Backend, capacity: u32) -> Result<Nodes> {
        let [of_first, of_more] = self.bytes(capacity);
        let first = storage(backend, "hair.render.nodes", of_first)?;
        let more = if of_more > 0 { Some(storage(backend, "hair.render.more_nodes", of_more)?) } else { None };
        Ok(Nodes { first, more, capacity, bytes: of_first + of_more })
    }
}

/// Nodes of lists.
#[derive(Debug)]
pub(crate) struct Nodes {
    first: BufferId,
    /// It is there before it holds any, since kernels bind it.
    more: Option<BufferId>,
    /// How many there are.
    pub(crate) capacity: u32,
    pub(crate) bytes: u64,
}

impl Nodes {
    /// What kernels bind.
    pub(crate) fn bindings(&self, is_bounded: bool) -> Vec<(&'static str, Binding)> {
        let more = self.more.filter(|_| !is_bounded).map(|more| ("more_nodes", more.into()));
        [("nodes", self.first.into())].into_iter().chain(more).collect()
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        [self.first].into_iter().chain(self.more).for_each(|buffer| backend.destroy(buffer.into()));
    }
}
