//! `hair.sim.field_bounds`: the box around the triangles of a mesh.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{GROUP, LIBRARY, Pass};
use crate::field::build::{FieldMaker, Reads};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.field_bounds",
    root: ("field_bounds", include_str!("../../shaders/field_bounds.wgsl")),
    library: LIBRARY,
};

pub(crate) fn field_bounds(maker: &mut FieldMaker) -> Result<Pass> {
    let (body, buffers) = (maker.body, maker.buffers);
    let resources = [("extremes", buffers.extremes.into())];
    let grid = Grid::for_threads(body.triangles, GROUP);
    maker.pass(&SOURCE, &Specialization::new(), Reads::InItsUnit, &resources, grid)
}
