//! `hair.sim.surface_emit`: the vertices and triangles of a surface.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{GROUP, LIBRARY, Pass};
use crate::field::surface::{SurfaceBuffers, SurfaceMaker};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.surface_emit",
    root: ("surface_emit", include_str!("../../shaders/surface_emit.wgsl")),
    library: LIBRARY,
};

pub(crate) fn surface_emit(maker: &mut SurfaceMaker, to: &SurfaceBuffers) -> Result<Pass> {
    let resources = [
        ("build", maker.build),
        ("fields", maker.fields.into()),
        ("cells", maker.cells.into()),
        ("blocks", maker.blocks.into()),
        ("size", maker.size.into()),
        ("surface_vertices", to.vertices.into()),
        ("surface_indices", to.indices.into()),
    ];
    let grid = Grid::for_threads(maker.nodes, GROUP);
    maker.kernels.pass_of(maker.backend, &SOURCE, &Specialization::new(), &resources, grid)
}
