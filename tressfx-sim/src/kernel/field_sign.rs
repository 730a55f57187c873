//! `hair.sim.field_sign`: the signed distance of each node.

use tressfx_core::Result;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{Binding, ShaderSource, Specialization};

use super::{GROUP, LIBRARY, Pass};
use crate::field::build::{FieldMaker, Reads};

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.field_sign",
    root: ("field_sign", include_str!("../../shaders/field_sign.wgsl")),
    library: LIBRARY,
};

/// A mesh that is closed has no open edges to read.
pub(crate) fn field_sign(maker: &mut FieldMaker) -> Result<Pass> {
    let (body, buffers) = (maker.body, maker.buffers);
    let mut resources: Vec<(&str, Binding)> = vec![
        ("known_points", buffers.points[body.floods().len() % 2].into()),
        ("crossings", buffers.crossings.into()),
        ("all_fields", buffers.fields.into()),
        ("grid", buffers.grid.into()),
    ];
    let open_edges =
        body.open_edges.map(|edges| [("open_edges", edges.into()), ("vertices", body.vertices.buffer.into())]);
    resources.extend(open_edges.into_iter().flatten());
    let specialization = Specialization::new().feature("open_edges", body.open_edges.is_some());
    let grid = Grid::for_threads(body.node_count(), GROUP);
    maker.pass(&SOURCE, &specialization, Reads::Nothing, &resources, grid)
}
