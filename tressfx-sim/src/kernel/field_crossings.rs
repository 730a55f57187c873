//! `hair.sim.field_crossings`: where the lines through the nodes cross the mesh.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{GROUP, LIBRARY, Pass};
use crate::field::build::{FieldMaker, LANES, Reads};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.field_crossings",
    root: ("field_crossings", include_str!("../../shaders/field_crossings.wgsl")),
    library: LIBRARY,
};

pub(crate) fn field_crossings(maker: &mut FieldMaker) -> Result<Pass> {
    let (body, buffers) = (maker.body, maker.buffers);
    let resources = [("crossings", buffers.crossings.into())];
    let grid = Grid::for_threads(LANES * body.triangles, GROUP);
    maker.pass(&SOURCE, &Specialization::new(), Reads::InCells, &resources, grid)
}
