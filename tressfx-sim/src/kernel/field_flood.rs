//! `hair.sim.field_flood`: a pass of the flood that takes the nearest triangle to all nodes.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{GROUP, LIBRARY, Pass};
use crate::field::build::{FieldMaker, Reads};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.field_flood",
    root: ("field_flood", include_str!("../../shaders/field_flood.wgsl")),
    library: LIBRARY,
};

/// The pass of an index, from 0: what one has found the next one reads.
pub(crate) fn field_flood(maker: &mut FieldMaker, index: usize) -> Result<Pass> {
    let (body, points) = (maker.body, maker.buffers.points);
    let resources = [("known_points", points[index % 2].into()), ("nearest_points", points[(index + 1) % 2].into())];
    let grid = Grid::for_threads(body.node_count(), GROUP);
    maker.pass_at(&SOURCE, &Specialization::new(), Reads::InCells, &resources, grid, index)
}
