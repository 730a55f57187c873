//! A section under simulation: its buffers, its parameters, and its passes.

use glam::Vec3;
use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::buffers::{ColliderBuffer, SectionBuffers, storage};
use crate::clock::SubStep;
use crate::kernel::direct::direct;
use crate::kernel::direct_near::direct_near;
use crate::kernel::moved::moved;
use crate::kernel::roots::roots;
use crate::kernel::tangents::tangents;
use crate::kernel::tressfx::tressfx;
use crate::kernel::volume_push::volume_push;
use crate::kernel::volume_splat::volume_splat;
use crate::kernel::{Kernels, Pass, PassMaker};
use crate::params::SimParams;
use crate::section_desc::SectionDesc;
use crate::solver::Solver;
use crate::stage::Stage;
use crate::step::{SectionInfo, Step};
use crate::volume::Volume;
use crate::wind::Wind;

/// What all sections share.
#[derive(Debug)]
pub(crate) struct Shared {
    /// Room for colliders, if there may be any.
    pub(crate) colliders: Option<ColliderBuffer>,
    /// Two `u32`: strands that were reset because they had become non-finite; and those of the section at hand that `direct` has left to `direct_near`.
    pub(crate) counts: BufferId,
    /// All signed distance fields, if there may be any among the colliders.
    pub(crate) fields: Option<BufferId>,
    /// Where hair meets hair.
    pub(crate) volume: Option<Volume>,
}

/// Where the second of [`Shared::counts`] is, bytes.
pub(crate) const NEAR_COUNT: u64 = 4;

#[derive(Debug)]
pub(crate) struct SimSection {
    pub(crate) buffers: SectionBuffers,
    pub(crate) info: SectionInfo,
    solver: Solver,
    params: SimParams,
    /// Sub-steps until the strains of two are known, which damping asks for: kernels without damping keep none.
    strains_missing: u32,
    passes: Passes,
}

/// A pass for each stage that the section may need.
#[derive(Debug)]
struct Passes {
    roots: Option<Pass>,
    tressfx: Option<Pass>,
    direct: Option<Pass>,
    direct_near: Option<Pass>,
    volume_splat: Option<Pass>,
    volume_push: Option<Pass>,
    tangents: Pass,
    /// [`Shared::counts`].
    counts: BufferId,
}

impl SimSection {
    pub(crate) fn new(
        backend: &mut dyn Backend,
        kernels: &mut Kernels,
        desc: &SectionDesc,
        center: Vec3,
        shared: &Shared,
    ) -> Result<Self> {
        let buffers = SectionBuffers::new(backend, desc, center, shared.volume.is_some())?;
        let passes = Passes::new(&mut PassMaker { backend, kernels, buffers: &buffers, shared }, &desc.params)?;
        let info = SectionInfo::new(desc.strands, desc.solver);
        Ok(Self { buffers, info, solver: desc.solver, params: desc.params.clone(), strains_missing: 0, passes })
    }

    pub(crate) fn params(&self) -> &SimParams {
        &self.params
    }

    pub(crate) fn solver(&self) -> Solver {
        self.solver
    }

    /// Changes the parameters; kernels are compiled only where they are specialised on something that is new.
    pub(crate) fn set_params(
        &mut self,
        backend: &mut dyn Backend,
        kernels: &mut Kernels,
        params: SimParams,
        shared: &Shared,
    ) -> Result<()> {
        let vertices = self.info.shape.vertices;
        if specialization(&params, vertices) != specialization(&self.params, vertices) {
            self.passes = Passes::new(&mut PassMaker { backend, kernels, buffers: &self.buffers, shared }, &params)?;
        }
        if self.params.internal_damping == 0.0 {
            self.strains_missing = 2;
        }
        self.params = params;
        Ok(())
    }

    /// What its kernels are told of the next sub-step.
    pub(crate) fn next_step(&mut self, sub_step: &SubStep, wind: Option<&Wind>) -> Step {
        let mut step = Step::new(&self.params, &self.info, sub_step, wind);
        if self.strains_missing > 0 {
            self.strains_missing -= 1;
            step.internal_damping = 0.0;
        }
        step
    }

    /// What measures how far its guides move.
    pub(crate) fn measure(
        &self,
        backend: &mut dyn Backend,
        kernels: &mut Kernels,
        shared: &Shared,
        largest: BufferId,
    ) -> Result<Pass> {
        let vertices = self.info.shape.guide_vertices();
        let measured = storage(backend, "hair.measured", 16, vertices)?;
        moved(&mut PassMaker { backend, kernels, buffers: &self.buffers, shared }, measured, largest)
    }

    /// Records a stage with one of [`SectionBuffers::steps`]; nothing where the section has no such pass.
    pub(crate) fn record(&self, list: &mut PassList, stage: Stage, step: usize) {
        let passes = &self.passes;
        if let (Stage::Direct, Some(_)) = (stage, &passes.direct_near) {
            // The list is of one section and one sub-step.
            list.clear(passes.counts, NEAR_COUNT, 4);
        }
        let pass = match stage {
            Stage::Roots => passes.roots.as_ref(),
            Stage::TressFx => passes.tressfx.as_ref(),
            Stage::Direct => passes.direct.as_ref(),
            Stage::VolumeSplat => passes.volume_splat.as_ref(),
            Stage::VolumePush => passes.volume_push.as_ref(),
            // It is of all sections.
            Stage::VolumeNodes => None,
            Stage::Tangents => Some(&passes.tangents),
        };
        let after = passes.direct_near.as_ref().filter(|_| stage == Stage::Direct);
        pass.into_iter().chain(after).for_each(|pass| pass.record(list, step));
    }
}

/// What of the parameters the passes are specialised on. The others are uniforms.
fn specialization(params: &SimParams, vertices: u32) -> (bool, [u32; 2], bool, bool) {
    let iterations = [params.local_iterations_of(vertices), params.length_iterations];
    (params.has_global_shape(), iterations, params.internal_damping > 0.0, params.pull_frequency > 0.0)
}

impl Passes {
    fn new(maker: &mut PassMaker, params: &SimParams) -> Result<Self> {
        Ok(Self {
            roots: roots(maker)?,
            tressfx: tressfx(maker, params)?,
            direct: direct(maker, params)?,
            direct_near: direct_near(maker, params)?,
            counts: maker.shared.counts,
            volume_splat: volume_splat(maker)?,
            volume_push: volume_push(maker)?,
            tangents: tangents(maker)?,
        })
    }
}
