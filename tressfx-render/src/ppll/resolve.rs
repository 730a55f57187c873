//! `hair.render.resolve`: the list of each pixel becomes one colour.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::pass::PassList;
use tressfx_core::shader::{Binding, Kernel, Specialization};

use super::pool::NodePool;
use super::{LIBRARY, Tail};
use crate::bound::Bound;
use crate::output::Output;
use crate::places::at_places;
use crate::resolved::Resolved;
use crate::shaders::compute;
use crate::views::BoundView;

/// Fragments of a pixel that may be sorted exactly.
pub const K_RANGE: RangeInclusive<u32> = 0..=32;

/// What a kernel is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Variant {
    pub(crate) k: u32,
    pub(crate) tail: Tail,
    pub(crate) places: u32,
    /// Whether there is a rest of fragments without nodes.
    pub(crate) bounded: bool,
    /// Whether there are two buffers of nodes.
    pub(crate) more_nodes: bool,
    pub(crate) output: Output,
}

impl Variant {
    fn specialization(&self) -> Specialization {
        at_places(self.output.specialization(), self.places, 1)
            .feature("shaded", matches!(self.tail, Tail::Shaded | Tail::Weighted))
            .feature("weighted", self.tail == Tail::Weighted)
            .feature("unshaded", self.tail == Tail::Unshaded)
            .feature("bounded", self.bounded)
            .feature("more_nodes", self.more_nodes)
            .constant("K", self.k)
    }
}

/// Kernels that were needed, and the one that is in use.
#[derive(Debug)]
pub(crate) struct Resolve {
    kernels: HashMap<Variant, Kernel>,
    variant: Variant,
    pub(crate) bound: Bound<(usize, Variant)>,
}

impl Resolve {
    pub(crate) fn new(backend: &mut dyn Backend, variant: Variant) -> Result<Self> {
        let kernels = HashMap::from([(variant, kernel(backend, variant)?)]);
        Ok(Self { kernels, variant, bound: Bound::new() })
    }

    /// Compiles a variant, unless it was before.
    pub(crate) fn prepare(&self, backend: &mut dyn Backend, variant: Variant) -> Result<Option<Kernel>> {
        if self.kernels.contains_key(&variant) { Ok(None) } else { kernel(backend, variant).map(Some) }
    }

    /// Uses a variant from now on, and keeps what was prepared for it.
    pub(crate) fn change(&mut self, variant: Variant, prepared: Option<Kernel>) {
        if let Some(kernel) = prepared {
            self.kernels.insert(variant, kernel);
        }
        self.variant = variant;
    }

    /// The one that is in use.
    #[cfg(test)]
    pub(crate) fn kernel(&self) -> &Kernel {
        &self.kernels[&self.variant]
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        pool: &NodePool,
        resolved: &Resolved,
        rest: Option<(&'static str, Binding)>,
    ) -> Result<()> {
        let Self { kernels, variant, bound } = self;
        let kernel = &kernels[variant];
        let bindings = bound.get((view.index, *variant), || {
            let own = [
                ("view", view.uniform),
                ("resolved", resolved.colors.into()),
                ("tiles", resolved.tiles.into()),
                ("tile_vertices", resolved.draw.into()),
            ];
            let lists = rest.unwrap_or(("heads", pool.heads.into()));
            kernel.bind(&[&own[..], &[lists], &pool.bindings(view.index, variant.bounded)].concat())
        })?;
        list.compute(kernel, &bindings, view.region.grid());
        Ok(())
    }
}

fn kernel(backend: &mut dyn Backend, variant: Variant) -> Result<Kernel> {
    let root = ("resolve", include_str!("../../shaders/ppll/resolve.wgsl"));
    compute(backend, "hair.render.resolve", root, LIBRARY, &variant.specialization())
}
