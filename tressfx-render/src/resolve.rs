//! `hair.render.resolve`: the list of each pixel becomes one colour.

use std::ops::RangeInclusive;

use tressfx_core::backend::{Backend, ComputeDesc};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Kernel, Specialization};

use crate::pool::{NodePool, Resolved};
use crate::shaders::shader;

/// Fragments of a pixel that may be sorted exactly.
pub const K_RANGE: RangeInclusive<u32> = 1..=16;

/// Pixels along the edge of a tile: a group of this kernel, and what `hair.render.composite` draws or leaves out.
pub const TILE: u32 = 8;

pub(crate) fn kernel(backend: &mut dyn Backend, k: u32) -> Result<Kernel> {
    let root = ("resolve", include_str!("../shaders/resolve.wgsl"));
    let shader = shader("hair.render.resolve", root, &Specialization::new().constant("K", k))?;
    backend.create_compute(&ComputeDesc::new(shader))
}

pub(crate) fn pass(list: &mut PassList, kernel: &Kernel, frame: BufferId, pool: &NodePool, resolved: &Resolved) {
    let bindings = kernel
        .bind(&[
            ("frame", frame.into()),
            ("heads", pool.heads.into()),
            ("nodes", pool.nodes.into()),
            ("counters", pool.counters.into()),
            ("resolved", resolved.colors.into()),
            ("tiles", resolved.tiles.into()),
        ])
        .expect("the names of the kernel");
    list.compute(kernel, &bindings, Grid::for_image(resolved.size, TILE));
}
