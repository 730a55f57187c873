//! `hair.sim.volume_nodes`: the slope of the pressure and the mean velocity at the nodes of a grid.

use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::pass::Grid;
use tressfx_core::shader::{ShaderSource, Specialization};

use super::{GROUP, Kernels, LIBRARY, Pass};
use crate::volume::VolumeBuffers;

pub(crate) const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.volume_nodes",
    root: ("volume_nodes", include_str!("../../shaders/volume_nodes.wgsl")),
    library: LIBRARY,
};

pub(crate) fn volume_nodes(
    backend: &mut dyn Backend,
    kernels: &mut Kernels,
    buffers: &VolumeBuffers,
    nodes: u32,
) -> Result<Pass> {
    let resources = [
        ("volume", buffers.volume.into()),
        ("sums", buffers.sums.into()),
        ("rest_masses", buffers.rest_masses.into()),
        ("node_values", buffers.node_values.into()),
    ];
    kernels.pass_of(backend, &SOURCE, &Specialization::new(), &resources, Grid::for_threads(nodes, GROUP))
}
