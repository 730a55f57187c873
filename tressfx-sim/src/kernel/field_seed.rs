//! `hair.sim.field_seed`: what the flood begins with.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{GROUP, LIBRARY, Pass};
use crate::field::build::{FieldMaker, Reads};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.field_seed",
    root: ("field_seed", include_str!("../../shaders/field_seed.wgsl")),
    library: LIBRARY,
};

pub(crate) fn field_seed(maker: &mut FieldMaker) -> Result<Pass> {
    let (body, buffers) = (maker.body, maker.buffers);
    let resources = [("band", buffers.band.into()), ("nearest_points", buffers.points[0].into())];
    let grid = Grid::for_threads(body.node_count(), GROUP);
    maker.pass(&SOURCE, &Specialization::new(), Reads::InCells, &resources, grid)
}
