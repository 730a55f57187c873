//! `hair.sim.collide`: strands leave the capsules and slide on them.

use glam::Vec3;
use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::shader::ShaderSource;
use tressfx_core::shape::Capsule;

use super::{LIBRARY, Pass, counts};
use crate::buffers::SectionBuffers;

const SOURCE: ShaderSource = ShaderSource {
    label: "hair.sim.collide",
    root: ("collide", include_str!("../../shaders/collide.wgsl")),
    library: LIBRARY,
};

gpu_struct! {
    /// A [`Capsule`] as the kernel reads it.
    pub(crate) struct GpuCapsule {
        /// Centre of one end.
        pub a: Vec3,
        /// Radius there.
        pub radius_a: f32,
        /// Centre of the other end.
        pub b: Vec3,
        /// Radius there.
        pub radius_b: f32,
    }
}

impl GpuCapsule {
    /// About the centre of the groom.
    pub(crate) fn about(center: Vec3, &Capsule { a, b, radius_a, radius_b }: &Capsule) -> Self {
        Self { a: a - center, radius_a, b: b - center, radius_b }
    }
}

pub(crate) fn collide(backend: &mut dyn Backend, buffers: &SectionBuffers, capsules: BufferId) -> Result<Pass> {
    let shape = &buffers.strands.shape;
    let resources = [
        ("step", buffers.step.into()),
        ("capsules", capsules.into()),
        ("rest_lengths", buffers.rest_lengths.into()),
        ("previous", buffers.previous.into()),
        ("positions", buffers.strands.positions.into()),
    ];
    Pass::new(backend, &SOURCE, &counts(shape), &resources, shape.guides)
}
