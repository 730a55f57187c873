//! `hair.render.resolve`: the list of each pixel becomes one colour.

use std::ops::RangeInclusive;

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Kernel, Specialization};

use super::LIBRARY;
use super::pool::NodePool;
use crate::bound::Bound;
use crate::resolved::{Resolved, TILE};
use crate::shaders::compute;
use crate::views::BoundView;

/// Fragments of a pixel that may be sorted exactly.
pub const K_RANGE: RangeInclusive<u32> = 1..=16;

#[derive(Debug)]
pub(crate) struct Resolve {
    pub(crate) kernel: Kernel,
    pub(crate) bound: Bound<usize>,
}

impl Resolve {
    pub(crate) fn new(backend: &mut dyn Backend, k: u32) -> Result<Self> {
        let root = ("resolve", include_str!("../../shaders/ppll/resolve.wgsl"));
        let kernel = compute(backend, "hair.render.resolve", root, LIBRARY, &Specialization::new().constant("K", k))?;
        Ok(Self { kernel, bound: Bound::new() })
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        pool: &NodePool,
        resolved: &Resolved,
    ) -> Result<()> {
        let bindings = self.bound.get(view.index, || {
            self.kernel.bind(&[
                ("view", view.uniform),
                ("pool", pool.uniform.into()),
                ("heads", pool.heads.into()),
                ("nodes", pool.nodes.into()),
                ("counters", pool.counters.of(view.index).into()),
                ("resolved", resolved.colors.into()),
                ("tiles", resolved.tiles.into()),
                ("tile_vertices", resolved.draw.into()),
            ])
        })?;
        list.compute(&self.kernel, &bindings, Grid::for_image(view.size, TILE));
        Ok(())
    }
}
