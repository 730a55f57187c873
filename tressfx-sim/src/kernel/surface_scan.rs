//! `hair.sim.surface_scan`: what is before each block of nodes, and how large the surface is.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass};
use crate::field::surface::SurfaceMaker;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.surface_scan",
    root: ("surface_scan", include_str!("../../shaders/surface_scan.wgsl")),
    library: LIBRARY,
};

/// One group: it goes through all blocks.
pub(crate) fn surface_scan(maker: &mut SurfaceMaker) -> Result<Pass> {
    let resources = [("build", maker.build), ("blocks", maker.blocks.into()), ("size", maker.size.into())];
    maker.kernels.pass_of(maker.backend, &SOURCE, &Specialization::new(), &resources, Grid([1, 1, 1]))
}
