//! `hair.sim.surface_count`: how many vertices and triangles of a surface each node has.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{GROUP, LIBRARY, Pass};
use crate::field::surface::SurfaceMaker;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.surface_count",
    root: ("surface_count", include_str!("../../shaders/surface_count.wgsl")),
    library: LIBRARY,
};

pub(crate) fn surface_count(maker: &mut SurfaceMaker) -> Result<Pass> {
    let resources = [
        ("build", maker.build),
        ("fields", maker.fields.into()),
        ("cells", maker.cells.into()),
        ("blocks", maker.blocks.into()),
    ];
    let grid = Grid::for_threads(maker.nodes, GROUP);
    maker.kernels.pass_of(maker.backend, &SOURCE, &Specialization::new(), &resources, grid)
}
