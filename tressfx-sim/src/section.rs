//! A section: its buffers, its parameters, and the passes that are specialised on them.

use glam::Vec3;
use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::error::Label;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::buffers::SectionBuffers;
use crate::kernel::Pass;
use crate::kernel::collide::collide;
use crate::kernel::follow::follow;
use crate::kernel::integrate::integrate;
use crate::kernel::length::length;
use crate::kernel::local_shape::local_shape;
use crate::kernel::tangents::tangents;
use crate::kernel::velocity_shock::velocity_shock;
use crate::params::SimParams;
use crate::sim::SectionDesc;
use crate::step::Units;

/// The kernels, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Verlet integration and global shape; or the reset to the rest pose.
    Integrate,
    /// Strands make a share of the head's motion at once.
    VelocityShock,
    /// Edges want the angles of the rest pose.
    LocalShape,
    /// Wind, length constraints, guard against non-finite strands.
    Length,
    /// Strands leave the capsules.
    Collide,
    /// Follow strands are placed; once a frame.
    Follow,
    /// Tangents of all strands; once a frame.
    Tangents,
}

impl Stage {
    /// What each sub-step consists of.
    pub const SUB_STEP: [Self; 5] =
        [Self::Integrate, Self::VelocityShock, Self::LocalShape, Self::Length, Self::Collide];
    /// What each frame ends with.
    pub const FRAME_END: [Self; 2] = [Self::Follow, Self::Tangents];

    /// The label of its pass.
    pub fn label(self) -> Label {
        match self {
            Self::Integrate => "hair.sim.integrate",
            Self::VelocityShock => "hair.sim.velocity_shock",
            Self::LocalShape => "hair.sim.local_shape",
            Self::Length => "hair.sim.length",
            Self::Collide => "hair.sim.collide",
            Self::Follow => "hair.sim.follow",
            Self::Tangents => "hair.sim.tangents",
        }
    }
}

/// What all sections share.
#[derive(Debug)]
pub(crate) struct Shared {
    /// The capsules, if any.
    pub(crate) capsules: Option<BufferId>,
    /// Strands that were reset because they had become non-finite.
    pub(crate) non_finite: BufferId,
}

#[derive(Debug)]
pub(crate) struct Section {
    pub(crate) buffers: SectionBuffers,
    pub(crate) units: Units,
    params: SimParams,
    passes: Passes,
}

/// The passes; those that the parameters make useless are left out.
#[derive(Debug)]
struct Passes {
    integrate: Pass,
    velocity_shock: Option<Pass>,
    local_shape: Option<Pass>,
    length: Pass,
    length_in_wind: Pass,
    collide: Option<Pass>,
    follow: Option<Pass>,
    tangents: Pass,
}

impl Section {
    pub(crate) fn new(
        backend: &mut dyn Backend,
        SectionDesc { strands, params }: &SectionDesc,
        center: Vec3,
        shared: &Shared,
    ) -> Result<Self> {
        let buffers = SectionBuffers::new(backend, strands, center)?;
        let passes = Passes::new(backend, &buffers, params, shared)?;
        let units = Units { metres_per_unit: strands.metres_per_unit, tip_separation: strands.tip_separation };
        Ok(Self { buffers, units, params: params.clone(), passes })
    }

    pub(crate) fn params(&self) -> &SimParams {
        &self.params
    }

    /// Changes the parameters; the passes are made anew only where they are specialised on something that changed.
    pub(crate) fn set_params(&mut self, backend: &mut dyn Backend, params: SimParams, shared: &Shared) -> Result<()> {
        if specialization(&params) != specialization(&self.params) {
            let passes = Passes::new(backend, &self.buffers, &params, shared)?;
            std::mem::replace(&mut self.passes, passes).destroy(backend);
        }
        self.params = params;
        Ok(())
    }

    pub(crate) fn record(&self, list: &mut PassList, stage: Stage, wind: bool) {
        let passes = &self.passes;
        let pass = match stage {
            Stage::Integrate => Some(&passes.integrate),
            Stage::VelocityShock => passes.velocity_shock.as_ref(),
            Stage::LocalShape => passes.local_shape.as_ref(),
            Stage::Length => Some(if wind { &passes.length_in_wind } else { &passes.length }),
            Stage::Collide => passes.collide.as_ref(),
            Stage::Follow => passes.follow.as_ref(),
            Stage::Tangents => Some(&passes.tangents),
        };
        pass.iter().for_each(|pass| pass.record(list));
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.passes.destroy(backend);
        self.buffers.destroy(backend);
    }
}

/// What the passes are specialised on.
fn specialization(params: &SimParams) -> (bool, bool, bool, u32, u32) {
    (
        params.has_global_shape(),
        params.shock > 0.0,
        params.local_stiffness > 0.0,
        params.local_iterations,
        params.length_iterations,
    )
}

impl Passes {
    fn new(backend: &mut dyn Backend, buffers: &SectionBuffers, params: &SimParams, shared: &Shared) -> Result<Self> {
        let vertices = buffers.strands.shape.vertices;
        Ok(Self {
            integrate: integrate(backend, buffers, params)?,
            velocity_shock: when(params.shock > 0.0, || velocity_shock(backend, buffers))?,
            local_shape: when(params.has_local_shape(vertices), || local_shape(backend, buffers, params))?,
            length: length(backend, buffers, shared.non_finite, params, false)?,
            length_in_wind: length(backend, buffers, shared.non_finite, params, true)?,
            collide: shared.capsules.map(|capsules| collide(backend, buffers, capsules)).transpose()?,
            follow: buffers.follow_offsets.map(|offsets| follow(backend, buffers, offsets)).transpose()?,
            tangents: tangents(backend, buffers)?,
        })
    }

    fn destroy(self, backend: &mut dyn Backend) {
        let always = [self.integrate, self.length, self.length_in_wind, self.tangents];
        let sometimes = [self.velocity_shock, self.local_shape, self.collide, self.follow];
        for pass in always.into_iter().chain(sometimes.into_iter().flatten()) {
            pass.destroy(backend);
        }
    }
}

fn when(condition: bool, make: impl FnOnce() -> Result<Pass>) -> Result<Option<Pass>> {
    if condition { make().map(Some) } else { Ok(None) }
}
