//! `hair.sim.field_splat`: the nearest triangle of each node that is near the surface.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{GROUP, LIBRARY, Pass};
use crate::field::build::{FieldMaker, LANES, Reads};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.field_splat",
    root: ("field_splat", include_str!("../../shaders/field_splat.wgsl")),
    library: LIBRARY,
};

pub(crate) fn field_splat(maker: &mut FieldMaker) -> Result<Pass> {
    let (body, buffers) = (maker.body, maker.buffers);
    let resources = [("band", buffers.band.into())];
    let grid = Grid::for_threads(LANES * body.triangles, GROUP);
    maker.pass(&SOURCE, &Specialization::new(), Reads::InCells, &resources, grid)
}
