//! Memory of the lists of fragments, and what becomes of them.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::Result;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;

use super::nodes::{NodeLimits, Nodes};
use super::{PpllDesc, Tail};
use crate::counters::ViewCounters;
use crate::renderer::with_headroom;
use crate::resolved::{pixels, storage};
use crate::usage::is_surplus;

/// A pool is made smaller that is more than so many times as large as what was needed.
const SURPLUS: f64 = 1.6;

/// Nodes of lists that are not in use.
const IDLE_NODES: u32 = 1 << 10;

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
        /// Nodes of the first of two buffers.
        pub first_nodes: u32,
        /// The colour of a tail that is not shaded.
        pub unlit: [f32; 4],
    }
}

/// Lists of fragments, one a pixel.
#[derive(Debug)]
pub(crate) struct NodePool {
    /// `u32` a pixel: the number of the first node, from 1; 0 for none.
    pub(crate) heads: BufferId,
    nodes: Nodes,
    pub(crate) limits: NodeLimits,
    /// What is counted of each view.
    pub(crate) counters: ViewCounters,
    /// [`PoolUniform`].
    pub(crate) uniform: BufferId,
    /// How many fragments there is room for at least.
    least: u32,
    count_limit: u32,
}

impl NodePool {
    /// A pool for `size` pixels, one fragment for each, and for so many views.
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], desc: &PpllDesc, views: usize) -> Result<Self> {
        let pixels = pixels(size);
        let count_limit = desc.count_limit.clamp(1, PpllDesc::COUNT_LIMIT);
        let limits = NodeLimits::new(backend.caps(), desc, count_limit);
        let least = pixels.clamp(1, u64::from(limits.first)) as u32;
        let heads = storage(backend, "hair.render.heads", HEAD_BYTES * pixels)?;
        let counters = ViewCounters::new(backend, views, 0)?;
        let nodes = limits.make(backend, least)?;
        let uniform =
            backend.create_buffer(&BufferDesc::uniform("hair.render.pool", size_of::<PoolUniform>() as u64))?;
        Ok(Self { heads, nodes, limits, counters, uniform, least, count_limit })
    }

    /// How many fragments there is room for.
    pub(crate) fn capacity(&self, is_bounded: bool) -> u32 {
        self.nodes.capacity.min(self.limits.largest(is_bounded))
    }

    /// Nodes for `wanted` fragments, or for as many as are allowed, where there is less room; it changes nothing yet.
    pub(crate) fn prepare(&self, backend: &mut dyn Backend, wanted: u64, is_bounded: bool) -> Result<Option<Nodes>> {
        let capacity = wanted.min(self.limits.largest(is_bounded).into()) as u32;
        if capacity > self.nodes.capacity { self.limits.make(backend, capacity).map(Some) } else { Ok(None) }
    }

    /// Nodes for `needed` fragments and some more, where there is much more room; it changes nothing yet.
    pub(crate) fn prepare_smaller(
        &self,
        backend: &mut dyn Backend,
        needed: u64,
        is_bounded: bool,
    ) -> Result<Option<Nodes>> {
        let largest = self.limits.largest(is_bounded);
        let capacity = with_headroom(needed).clamp(self.least.into(), largest.into()) as u32;
        let shrinks = capacity < self.nodes.capacity && is_surplus(self.nodes.capacity.into(), needed, SURPLUS);
        if shrinks { self.limits.make(backend, capacity).map(Some) } else { Ok(None) }
    }

    /// As few nodes as a pool may have while nobody fills it; it changes nothing yet.
    pub(crate) fn prepare_idle(&self, backend: &mut dyn Backend) -> Result<Option<Nodes>> {
        let capacity = IDLE_NODES.min(self.least);
        if capacity < self.nodes.capacity { self.limits.make(backend, capacity).map(Some) } else { Ok(None) }
    }

    /// Uses other nodes. What the pool held is lost. (To destroy the old ones before the others are made would free nothing yet, since older lists may
    /// still name them.)
    pub(crate) fn replace(&mut self, backend: &mut dyn Backend, nodes: Nodes) {
        std::mem::replace(&mut self.nodes, nodes).destroy(backend);
    }

    /// Sets the counters of views to zero.
    pub(crate) fn begin(&self, list: &mut PassList, views: usize) {
        self.counters.clear(list, views);
    }

    /// What the limits are when so many groups ask for room, of the nearest fragments of a pixel as many as are `kept` of those
    /// that are `asked` for, and what is seen of a tail: `unlit` is the colour of one that is not shaded.
    pub(crate) fn upload(&self, list: &mut PassList, groups: u64, kept: Option<u32>, desc: &PpllDesc, unlit: [f32; 4]) {
        let uniform = PoolUniform {
            capacity: self.capacity(kept.is_some()),
            limit: self.count_limit,
            small_request: (u64::from(self.count_limit) / groups.max(1)) as u32,
            kept: kept.unwrap_or(0),
            asked: desc.asked(),
            weighs: u32::from(desc.tail == Tail::Weighted),
            sorted: desc.k,
            first_nodes: self.limits.first,
            unlit,
        };
        list.upload(self.uniform, 0, &[uniform]);
    }

    /// What the shaders bind that fill it or read it, beside the heads.
    pub(crate) fn bindings(&self, view: usize, is_bounded: bool) -> Vec<(&'static str, Binding)> {
        let mut all = vec![("pool", self.uniform.into()), ("counters", self.counters.of(view).into())];
        all.extend(self.nodes.bindings(is_bounded));
        all
    }

    /// What it takes for `size` pixels.
    pub(crate) fn bytes(&self, size: [u32; 2]) -> u64 {
        (HEAD_BYTES * pixels(size)).max(16) + self.nodes.bytes + size_of::<PoolUniform>() as u64 + self.counters.bytes()
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.counters.destroy(backend);
        self.nodes.destroy(backend);
        [self.heads, self.uniform].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}
