//! `hair.sim.field_grid`: the nodes of a field, around the box of its mesh.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{LIBRARY, Pass};
use crate::field::build::{FieldMaker, Reads};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.field_grid",
    root: ("field_grid", include_str!("../../shaders/field_grid.wgsl")),
    library: LIBRARY,
};

pub(crate) fn field_grid(maker: &mut FieldMaker) -> Result<Pass> {
    let buffers = maker.buffers;
    let resources = [
        ("extremes", buffers.extremes.into()),
        ("new_grid", buffers.grid.into()),
        ("all_fields", buffers.fields.into()),
    ];
    let grid = Grid([1, 1, 1]);
    maker.pass(&SOURCE, &Specialization::new(), Reads::Nothing, &resources, grid)
}
