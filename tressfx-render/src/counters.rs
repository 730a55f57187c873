//! What is counted of a view.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::resolved::storage;

gpu_struct! {
    /// What was drawn of a view.
    pub struct Counters {
        /// Fragments that passed the depth test. Where it is saturated, there were at least so many.
        pub fragments: u32,
        /// What found no room in the pool and is missing in the picture: fragments, or references of tiles to segments. On a CPU also references, at least
        /// one, that a group of tiles has not come to, since the driver would have ended its loops.
        pub dropped: u32,
        /// Pixels with at least one fragment.
        pub pixels_with_hair: u32,
        /// 1 where there were more fragments than can be counted, else 0.
        pub saturated: u32,
        /// What the technique wanted to keep: the fragments where it has lists of them, the references to segments where it has
        /// tiles, else 0. Of lists that do not hold all fragments: those that they were to hold.
        pub wanted: u32,
        /// Tiles of 8 x 8 pixels that have hair, or where it was looked for.
        pub tiles_with_hair: u32,
        /// Fragments that were to be in order and found no room: they are in the picture, blended behind those that are in order.
        pub merged: u32,
        /// Vertices of strands that may be seen, of tiles: they were to be kept.
        pub vertices: u32,
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
    /// If there are not 32 bytes.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        bytemuck::pod_read_unaligned(bytes)
    }
}

/// [`Counters`] of each view of a frame, and what is kept of it for the next frame.
#[derive(Debug)]
pub(crate) struct ViewCounters {
    buffers: Vec<BufferId>,
    /// Bytes that are kept of each view.
    kept: u64,
}

impl ViewCounters {
    pub(crate) fn new(backend: &mut dyn Backend, views: usize, kept: u64) -> Result<Self> {
        let of_a_view = |_| storage(backend, "hair.render.counters", Counters::BYTES + kept);
        Ok(Self { buffers: (0..views).map(of_a_view).collect::<Result<_>>()?, kept })
    }

    /// Size of all of them on the GPU.
    pub(crate) fn bytes(&self) -> u64 {
        self.buffers.len() as u64 * (Counters::BYTES + self.kept)
    }

    /// Those of a view.
    pub(crate) fn of(&self, view: usize) -> BufferId {
        self.buffers[view]
    }

    /// Sets those of the first views to zero.
    pub(crate) fn clear(&self, list: &mut PassList, views: usize) {
        self.buffers[..views].iter().for_each(|&counters| list.clear(counters, 0, Counters::BYTES));
    }

    /// Forgets what was kept.
    pub(crate) fn forget(&self, list: &mut PassList) {
        self.buffers.iter().for_each(|&counters| list.clear(counters, Counters::BYTES, self.kept));
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.buffers.into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}
