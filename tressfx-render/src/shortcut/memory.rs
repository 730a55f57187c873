//! What ShortCut keeps for each pixel.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;

use super::ShortCutDesc;
use crate::counters::ViewCounters;
use crate::output::Output;
use crate::region::Region;
use crate::resolved::{Resolved, pixels, storage};
use crate::views::BoundView;

/// The buffers of ShortCut.
#[derive(Debug)]
pub(crate) struct Memory {
    /// `u32` a layer of each pixel: the key of a depth, 0 for none.
    pub(crate) layers: BufferId,
    /// `u32` a pixel: the sum of the optical depths.
    pub(crate) opticals: BufferId,
    /// What the second pass leaves: `vec2<u32>` a layer of each pixel, a colour, where fragments are in order; else `vec2<u32>` a
    /// pixel, the half of the sums that is not in `resolved`.
    pub(crate) fronts: BufferId,
    /// The result.
    pub(crate) resolved: Resolved,
    /// What is counted of each view.
    pub(crate) counters: ViewCounters,
    /// All of them together.
    pub(crate) bytes: u64,
}

/// Bytes of a pixel in `layers`, `opticals` and `fronts`.
pub(crate) fn bytes_of_pixel(desc: &ShortCutDesc) -> [u64; 3] {
    let k = u64::from(desc.k);
    [4 * k, 4, if desc.ordered { 8 * k } else { 8 }]
}

impl Memory {
    pub(crate) fn new(backend: &mut dyn Backend, size: [u32; 2], desc: &ShortCutDesc, output: Output) -> Result<Self> {
        let [layers, opticals, fronts] = bytes_of_pixel(desc).map(|bytes| bytes * pixels(size));
        let name = if desc.ordered { "hair.render.slots" } else { "hair.render.sums" };
        let resolved = Resolved::new(backend, size, output)?;
        let counters = ViewCounters::new(backend, output.views, 0)?;
        Ok(Self {
            layers: storage(backend, "hair.render.layers", layers)?,
            opticals: storage(backend, "hair.render.opticals", opticals)?,
            fronts: storage(backend, name, fronts)?,
            bytes: [layers, opticals, fronts].map(|bytes| bytes.max(16)).iter().sum::<u64>()
                + resolved.bytes(size)
                + counters.bytes(),
            counters,
            resolved,
        })
    }

    /// `fronts` by the name that it has in the shaders.
    pub(crate) fn fronts(&self, desc: &ShortCutDesc) -> (&'static str, Binding) {
        (if desc.ordered { "slots" } else { "sums" }, self.fronts.into())
    }

    /// What the first pass binds of it.
    pub(crate) fn of_depths(&self, view: &BoundView) -> [(&'static str, Binding); 3] {
        [
            ("layers", self.layers.into()),
            ("opticals", self.opticals.into()),
            ("counters", self.counters.of(view.index).into()),
        ]
    }

    /// What the second pass binds of it.
    pub(crate) fn of_colors(&self, desc: &ShortCutDesc) -> Vec<(&'static str, Binding)> {
        let mut bindings = vec![("layers", self.layers.into()), self.fronts(desc)];
        if !desc.ordered {
            bindings.push(("resolved", self.resolved.colors.into()));
        }
        bindings
    }

    /// Empties the pixels of a view.
    pub(crate) fn clear(&self, list: &mut PassList, region: &Region, desc: &ShortCutDesc) {
        let [layers, opticals, fronts] = bytes_of_pixel(desc);
        self.resolved.clear(list);
        region.clear(list, self.layers, layers);
        region.clear(list, self.opticals, opticals);
        region.clear(list, self.fronts, fronts);
        if !desc.ordered {
            region.clear_tiles(list, self.resolved.colors, self.resolved.output.slot_bytes());
        }
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.resolved.destroy(backend);
        self.counters.destroy(backend);
        [self.layers, self.opticals, self.fronts].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}
