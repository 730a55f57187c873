//! The simulation of a groom.

use glam::{Quat, Vec3};
use tressfx_core::backend::Backend;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shape::Capsule;
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::strands::{Bounds, Strands};
use tressfx_core::view::Pose;

use crate::buffers::{Upload, storage};
use crate::clock::{Clock, ClockParams, StepInput, SubStep};
use crate::error::SimError;
use crate::kernel::collide::GpuCapsule;
use crate::params::SimParams;
use crate::section::{Section, Shared, Stage};
use crate::step::Step;
use crate::wind::Wind;

/// A section of a groom to be simulated.
#[derive(Clone, Debug)]
pub struct SectionDesc<'a> {
    /// Its strands.
    pub strands: &'a Strands,
    /// How they move.
    pub params: SimParams,
}

/// What a frame did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Sub-steps that were recorded; 0 where less time than one has passed.
    pub sub_steps: u32,
    /// Whether the strands went to their rest pose first: at the start, on demand, or after a teleport.
    pub reset: bool,
    /// Whether that was because the head teleported.
    pub teleported: bool,
    /// Time that was not simulated because the frame was too long, s.
    pub dropped: f64,
}

/// Simulates the sections of a groom on one head.
///
/// It makes buffers and pipelines once; after that it only writes passes into a [`PassList`]. Positions stay in the unit of
/// the file, and head poses are in that unit too; parameters are SI.
///
/// Positions on the GPU are about the centre of the groom, on the axes of the world: a groom far from the origin loses no
/// bits. [`HairSim::pose`] takes them into the world.
#[derive(Debug)]
pub struct HairSim {
    sections: Vec<Section>,
    strand_buffers: Vec<StrandBuffers>,
    shared: Shared,
    clock: Clock,
    resets: u64,
    /// What the first frame has to upload.
    uploads: Vec<Upload>,
}

impl HairSim {
    /// Makes everything that the simulation needs. The uploads of the rest pose are part of the first [`HairSim::step`].
    ///
    /// `capsules` are what the strands collide with; they are in the space of the rest pose and move with the head.
    ///
    /// # Errors
    /// A parameter outside its range, or what the backend says.
    pub fn new(backend: &mut dyn Backend, sections: &[SectionDesc], capsules: &[Capsule]) -> Result<Self, SimError> {
        sections.iter().try_for_each(|section| section.params.validate())?;
        let bounds =
            sections.iter().map(|section| section.strands.guide_bounds()).reduce(Bounds::union).unwrap_or_default();
        let clock = Clock::new(ClockParams::default(), bounds)?;
        let mut uploads = Vec::new();
        let shared = Shared {
            capsules: match capsules.len() {
                0 => None,
                count => Some(storage(backend, "hair.capsules", size_of::<GpuCapsule>() as u64, count as u32)?),
            },
            non_finite: storage(backend, "hair.non_finite", 4, 1)?,
        };
        if let Some(buffer) = shared.capsules {
            let capsules: Vec<_> = capsules.iter().map(|capsule| GpuCapsule::about(clock.center(), capsule)).collect();
            uploads.push(Upload::new(buffer, &capsules));
        }
        let mut made = Vec::with_capacity(sections.len());
        for desc in sections {
            let section = Section::new(backend, desc, clock.center(), &shared)?;
            uploads.extend(section.buffers.uploads(desc.strands));
            made.push(section);
        }
        let strand_buffers = made.iter().map(|section| section.buffers.strands).collect();
        Ok(Self { sections: made, strand_buffers, shared, clock, resets: 0, uploads })
    }

    /// Records a frame: any number of sub-steps, follow strands and tangents. Sections are recorded stage by stage, so that
    /// no pass has to wait for the one before it more often than it must.
    ///
    /// # Errors
    /// Something in the input that is not finite or out of range; nothing is recorded then.
    pub fn step(&mut self, list: &mut PassList, input: &StepInput) -> Result<StepReport, SimError> {
        input.validate()?;
        for Upload { buffer, bytes } in self.uploads.drain(..) {
            list.upload(buffer, 0, &bytes);
        }
        let frame = self.clock.advance(input.dt, input.head);
        if let Some(rotation) = frame.reset {
            self.record_reset(list, rotation);
        }
        for sub_step in &frame.sub_steps {
            self.record_sub_step(list, sub_step, input.wind.as_ref());
        }
        let report = StepReport {
            sub_steps: frame.sub_steps.len() as u32,
            reset: frame.reset.is_some(),
            teleported: frame.teleported,
            dropped: frame.dropped,
        };
        if report.reset || report.sub_steps > 0 {
            Stage::FRAME_END.iter().for_each(|&stage| self.record_stage(list, stage, false));
        }
        Ok(report)
    }

    /// Puts the strands to rest where the head is, with the next frame.
    pub fn reset(&mut self) {
        self.clock.reset();
    }

    /// Resets so far: the first frame, those on demand, and teleports.
    pub fn resets(&self) -> u64 {
        self.resets
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.clock.time()
    }

    /// From the positions on the GPU to the world, with what the head has turned since the last sub-step. A renderer that
    /// draws the strands so keeps the roots on the skin at any frame rate.
    pub fn pose(&self) -> Pose {
        self.clock.pose()
    }

    /// The point of the rest pose that positions are about.
    pub fn center(&self) -> Vec3 {
        self.clock.center()
    }

    /// What the simulation shares with the rendering, a section each.
    pub fn buffers(&self) -> &[StrandBuffers] {
        &self.strand_buffers
    }

    /// How time is cut.
    pub fn clock_params(&self) -> &ClockParams {
        self.clock.params()
    }

    /// Changes how time is cut, from the next frame on.
    ///
    /// # Errors
    /// A parameter outside its range; nothing changes then.
    pub fn set_clock_params(&mut self, params: ClockParams) -> Result<(), SimError> {
        Ok(self.clock.set_params(params)?)
    }

    /// The parameters of a section.
    ///
    /// # Panics
    /// If there is no such section.
    pub fn params(&self, section: usize) -> &SimParams {
        self.sections[section].params()
    }

    /// Changes the parameters of a section, from the next frame on. Pipelines are made anew only where a pass comes, goes or
    /// changes its iterations.
    ///
    /// # Errors
    /// A parameter outside its range, or what the backend says; nothing changes then.
    ///
    /// # Panics
    /// If there is no such section.
    pub fn set_params(&mut self, backend: &mut dyn Backend, section: usize, params: SimParams) -> Result<(), SimError> {
        params.validate()?;
        Ok(self.sections[section].set_params(backend, params, &self.shared)?)
    }

    /// Brings the positions of all strands back, a ticket each section: `vec4<f32>`, vertex-major over all strands; position
    /// and inverse mass. [`Strands::deinterleave`] makes them strand-major, and [`HairSim::pose`] takes them to the world.
    pub fn read_positions(&self, list: &mut PassList) -> Vec<Ticket> {
        let read = |buffers: &StrandBuffers| {
            list.read_buffer(buffers.positions, 0, 16 * u64::from(buffers.shape.strand_vertices()))
        };
        self.strand_buffers.iter().map(read).collect()
    }

    /// Brings the positions of the guides one sub-step ago back, a ticket each section: `vec4<f32>`, vertex-major over the
    /// guides; `w` is 0.
    pub fn read_previous(&self, list: &mut PassList) -> Vec<Ticket> {
        let read = |section: &Section| {
            let bytes = 16 * u64::from(section.buffers.strands.shape.guide_vertices());
            list.read_buffer(section.buffers.previous, 0, bytes)
        };
        self.sections.iter().map(read).collect()
    }

    /// Brings back how many strands were reset so far because they had become non-finite: one `u32`.
    pub fn read_non_finite(&self, list: &mut PassList) -> Ticket {
        list.read_buffer(self.shared.non_finite, 0, 4)
    }

    /// Records what a section is told about a sub-step. [`HairSim::step`] does this; tests and measurements of single
    /// kernels do it themselves.
    ///
    /// # Panics
    /// If there is no such section.
    pub fn record_step(&self, list: &mut PassList, section: usize, step: &Step) {
        list.upload(self.sections[section].buffers.step, 0, &[*step]);
    }

    /// Records one kernel of all sections, or nothing where their parameters leave it out. [`HairSim::step`] does this; tests
    /// and measurements of single kernels do it themselves.
    pub fn record_stage(&self, list: &mut PassList, stage: Stage, wind: bool) {
        self.sections.iter().for_each(|section| section.record(list, stage, wind));
    }

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        for buffer in self.shared.capsules.into_iter().chain([self.shared.non_finite]) {
            backend.destroy(buffer.into());
        }
        self.sections.into_iter().for_each(|section| section.destroy(backend));
    }

    fn record_reset(&mut self, list: &mut PassList, rotation: Quat) {
        self.resets += 1;
        for (index, section) in self.sections.iter().enumerate() {
            self.record_step(list, index, &Step::reset(section.params(), &section.units, rotation));
        }
        self.record_stage(list, Stage::Integrate, false);
    }

    fn record_sub_step(&self, list: &mut PassList, sub_step: &SubStep, wind: Option<&Wind>) {
        for (index, section) in self.sections.iter().enumerate() {
            self.record_step(list, index, &Step::new(section.params(), &section.units, sub_step, wind));
        }
        let still = sub_step.turn == Quat::IDENTITY && sub_step.shift == Vec3::ZERO;
        for stage in Stage::SUB_STEP {
            // A head that has not moved gives no shock.
            if !(still && stage == Stage::VelocityShock) {
                self.record_stage(list, stage, wind.is_some());
            }
        }
    }
}
