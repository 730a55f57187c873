//! What is counted of a view.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::resolved::storage;
use crate::views::MAX_VIEWS;

gpu_struct! {
    /// What was drawn of a view.
    pub struct Counters {
        /// Fragments that passed the depth test. Where it is saturated, there were at least so many.
        pub fragments: u32,
        /// What found no room in the pool and is missing in the picture: fragments, or references of tiles to segments.
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
pub(crate) struct ViewCounters([BufferId; MAX_VIEWS]);

impl ViewCounters {
    /// Size of all of them on the GPU, with so many bytes more in each.
    pub(crate) const fn bytes(kept: u64) -> u64 {
        MAX_VIEWS as u64 * (Counters::BYTES + kept)
    }

    pub(crate) fn new(backend: &mut dyn Backend, kept: u64) -> Result<Self> {
        let made: Result<Vec<_>> =
            (0..MAX_VIEWS).map(|_| storage(backend, "hair.render.counters", Counters::BYTES + kept)).collect();
        Ok(Self(made?.try_into().expect("as many as there are views")))
    }

    /// Those of a view.
    pub(crate) fn of(&self, view: usize) -> BufferId {
        self.0[view]
    }

    /// Sets those of the first views to zero.
    pub(crate) fn clear(&self, list: &mut PassList, views: usize) {
        self.0[..views].iter().for_each(|&counters| list.clear(counters, 0, Counters::BYTES));
    }

    /// Forgets what was kept: so many bytes of each.
    pub(crate) fn forget(&self, list: &mut PassList, kept: u64) {
        self.0.iter().for_each(|&counters| list.clear(counters, Counters::BYTES, kept));
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.0.into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}
