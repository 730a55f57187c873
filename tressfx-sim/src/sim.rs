//! The simulation of a groom.

mod sleeping;

use glam::{Quat, Vec3};
use tressfx_core::backend::{Backend, Owner};
use tressfx_core::id::BufferId;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::strands::Bounds;
use tressfx_core::view::Pose;

use crate::buffers::{ALONE, ColliderBuffer, FIRST, RootTransform, storage};
use crate::clock::{Clock, ClockParams, SubStep};
use crate::collider::{CapsuleMotion, ColliderList, ColliderShape, PlacedShape};
use crate::error::SimError;
use crate::field::Fields;
use crate::input::{StepInput, check_pose};
use crate::kernel::Kernels;
use crate::params::SimParams;
use crate::rods::{GpuRods, Standing};
use crate::section::{NEAR_COUNT, Shared, SimSection};
use crate::section_desc::SectionDesc;
use crate::sleep::Sleep;
use crate::solver::Solver;
use crate::stage::Stage;
use crate::step::Step;
use crate::volume::{Volume, VolumeParams};

/// What a frame did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Sub-steps that were recorded; 0 where less time than one has passed.
    pub sub_steps: u32,
    /// Whether the strands went to their rest pose first: at the start, on demand, or after a teleport.
    pub reset: bool,
    /// Whether that was because the head teleported.
    pub teleported: bool,
    /// Whether nothing was recorded because the groom sleeps; see [`HairSim::allow_sleep`].
    pub asleep: bool,
    /// Time that was not simulated because the frame was too long, s.
    pub dropped: f64,
}

/// Simulates the sections of a groom on one head.
///
/// It makes buffers and pipelines once; after that it only writes passes into a [`PassList`]. Positions stay in the unit of
/// the file, and head poses are in that unit too; parameters are SI.
///
/// Positions on the GPU are relative to the centre of the groom, on the axes of the world: a groom far from the origin loses no
/// bits. [`HairSim::pose`] takes them into the world.
#[derive(Debug)]
pub struct HairSim {
    pub(crate) sections: Vec<SimSection>,
    strand_buffers: Vec<StrandBuffers>,
    kernels: Kernels,
    pub(crate) shared: Shared,
    clock: Clock,
    resets: u64,
    /// Which of the three places of a root is that at the start of the frame.
    root_place: u32,
    /// The colliders of the frame that is being recorded; kept for its memory.
    colliders: ColliderList,
    /// Fields that colliders may name.
    field_count: usize,
    /// Of each section.
    standing: Vec<Option<Standing>>,
    /// Where it may sleep.
    sleep: Option<Sleep>,
    /// Of everything above.
    owner: Owner,
}

impl HairSim {
    /// Makes everything that the simulation needs, and uploads the rest pose.
    ///
    /// A frame may have up to `max_colliders` colliders. Where that is 0, no kernel for collisions is compiled.
    ///
    /// # Errors
    /// A parameter outside its range, or what the backend says.
    pub fn new(
        backend: &mut dyn Backend,
        list: &mut PassList,
        sections: &[SectionDesc],
        max_colliders: usize,
    ) -> Result<Self, SimError> {
        Self::made(backend, list, sections, max_colliders, None, None)
    }

    /// The same for colliders of which some may be signed distance fields ([`Fields::shape`]). The fields have to outlive the simulation, and are made before each
    /// frame in which they have changed ([`Fields::record`]).
    ///
    /// # Errors
    /// As [`HairSim::new`].
    pub fn with_fields(
        backend: &mut dyn Backend,
        list: &mut PassList,
        sections: &[SectionDesc],
        max_colliders: usize,
        fields: &Fields,
    ) -> Result<Self, SimError> {
        Self::made(backend, list, sections, max_colliders, Some(fields), None)
    }

    pub(crate) fn made(
        backend: &mut dyn Backend,
        list: &mut PassList,
        sections: &[SectionDesc],
        max_colliders: usize,
        fields: Option<&Fields>,
        volume: Option<&VolumeParams>,
    ) -> Result<Self, SimError> {
        sections.iter().try_for_each(|section| section.params.validate())?;
        let bounds =
            sections.iter().map(|section| section.strands.guide_bounds()).reduce(Bounds::union).unwrap_or_default();
        let clock = Clock::new(ClockParams::default(), bounds)?;
        let ((shared, kernels, made), owner) = Owner::build(backend, |backend| {
            let mut kernels = Kernels::default();
            let shared = Shared {
                colliders: match max_colliders {
                    0 => None,
                    most => Some(ColliderBuffer::new(backend, most, sections.len())?),
                },
                counts: storage(backend, "hair.counts", 4, 2)?,
                fields: fields.filter(|fields| max_colliders > 0 && !fields.is_empty()).map(Fields::buffer),
                volume: match volume {
                    None => None,
                    Some(params) => Some(Volume::new(backend, &mut kernels, sections, clock.center(), params)?),
                },
            };
            let mut made = Vec::with_capacity(sections.len());
            for desc in sections {
                made.push(SimSection::new(backend, &mut kernels, desc, clock.center(), &shared)?);
            }
            Ok::<_, tressfx_core::Error>((shared, kernels, made))
        })?;
        shared.volume.iter().for_each(|volume| volume.upload(list, sections, clock.center()));
        let mut standing = Vec::with_capacity(sections.len());
        for (section, desc) in made.iter().zip(sections) {
            section.buffers.upload(list, desc.strands);
            standing.push(section.buffers.rods.map(|rods| {
                let of_section = GpuRods::new(desc.strands, &desc.params);
                list.upload(rods.rest, 0, &of_section.entries);
                of_section.standing
            }));
        }
        let strand_buffers = made.iter().map(|section| section.buffers.strands).collect();
        Ok(Self {
            sections: made,
            strand_buffers,
            kernels,
            shared,
            clock,
            resets: 0,
            root_place: 0,
            colliders: ColliderList::default(),
            field_count: fields.map_or(0, Fields::len),
            standing,
            sleep: None,
            owner,
        })
    }

    /// Records a frame: any number of sub-steps, follow strands and tangents. Sections are recorded stage by stage, so that
    /// no pass has to wait for the one before it more often than it must.
    ///
    /// # Errors
    /// Something in the input that is not finite or out of range, or too many colliders; nothing is recorded then.
    pub fn step(&mut self, list: &mut PassList, input: &StepInput) -> Result<StepReport, SimError> {
        // What is given again was in order before.
        if !self.sleeps_on_in(input) {
            self.check(input)?;
            self.note(input);
        }
        if self.is_asleep() {
            self.clock.pass(input.dt);
            return Ok(StepReport { asleep: true, ..StepReport::default() });
        }
        Ok(self.simulate(list, input))
    }

    /// A frame in which it is awake. Apart from `step`, which a thousand that sleep run too: its registers need not be saved for them.
    #[inline(never)]
    fn simulate(&mut self, list: &mut PassList, input: &StepInput) -> StepReport {
        let plan = self.clock.advance_along(input.dt, input.path, input.head);
        if let Some(rotation) = plan.reset {
            self.record_reset(list, rotation);
        }
        for sub_steps in plan.sub_steps.chunks(ColliderBuffer::SUB_STEPS) {
            self.record_sub_steps(list, sub_steps, input);
        }
        let report = StepReport {
            sub_steps: plan.sub_steps.len() as u32,
            reset: plan.reset.is_some(),
            teleported: plan.teleported,
            asleep: false,
            dropped: plan.dropped,
        };
        if report.reset || report.sub_steps > 0 {
            let last = plan.sub_steps.chunks(ColliderBuffer::SUB_STEPS).last();
            let place = last.map_or(ALONE, |last| FIRST + last.len() - 1);
            self.sections.iter().for_each(|section| section.record(list, Solver::FRAME_END, place));
        }
        self.end_frame_of_roots(list);
        report
    }

    fn end_frame_of_roots(&mut self, list: &mut PassList) {
        self.root_place = (self.root_place + 1) % 3;
        for SimSection { buffers, info, .. } in &self.sections {
            buffers.roots.iter().for_each(|roots| roots.end_frame(list, self.root_place, info.shape.guides));
        }
    }

    fn check(&self, input: &StepInput) -> Result<(), SimError> {
        input.validate()?;
        let most = self.shared.colliders.map_or(0, |buffers| buffers.most);
        if input.colliders.len() > most {
            return Err(SimError::TooManyColliders { given: input.colliders.len(), most });
        }
        let count = self.field_count;
        for (index, collider) in input.colliders.iter().enumerate() {
            match collider.shape {
                ColliderShape::Field { index: field, .. } if field as usize >= count => {
                    return Err(SimError::NoField { index, field, count });
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Says where the roots of a section are at the end of the next frame: a pose a guide, within the space of the rest pose;
    /// the head is applied after it. An identity rides on the head. Guides are in the order of [`Strands::rest`](tressfx_core::strands::Strands::rest).
    ///
    /// Transforms stay until they are given again. Within a frame a root goes along the cubic curve through where it is at the ends of this frame and
    /// of the two before it, as the head does, but no farther from the straight line than 1,000 m/s^2 would lead it.
    ///
    /// # Errors
    /// A section whose roots ride on the head or that does not exist, another number of poses than guides, and poses that are
    /// not finite or no rotations.
    pub fn set_roots(&mut self, list: &mut PassList, section: usize, poses: &[Pose]) -> Result<(), SimError> {
        let index = section;
        let Some(section) = self.sections.get(index) else {
            return Err(SimError::NoSection { index, count: self.sections.len() });
        };
        let roots = section.buffers.roots;
        let expected = roots.map_or(0, |_| section.info.shape.guides as usize);
        let Some(roots) = roots.filter(|_| poses.len() == expected) else {
            return Err(SimError::RootCount { given: poses.len(), expected });
        };
        poses.iter().try_for_each(|pose| check_pose(pose, "root.rotation", "root.translation"))?;
        let center = self.clock.center();
        let transforms: Vec<_> = poses.iter().map(|pose| RootTransform::new(center, pose)).collect();
        list.upload(roots.targets, 0, &transforms);
        self.wake();
        Ok(())
    }

    /// The buffer that [`HairSim::set_roots`] fills, a [`RootTransform`] a guide, for a kernel that does it on the GPU; `None`
    /// where roots ride on the head, or there is no such section.
    pub fn root_transforms(&self, section: usize) -> Option<BufferId> {
        Some(self.sections.get(section)?.buffers.roots?.targets)
    }

    /// Puts the strands to rest where the head is, with the next frame.
    pub fn reset(&mut self) {
        self.wake();
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

    /// The point of the rest pose that positions are relative to.
    pub fn center(&self) -> Vec3 {
        self.clock.center()
    }

    /// What the simulation shares with the rendering, a section each.
    pub fn buffers(&self) -> &[StrandBuffers] {
        &self.strand_buffers
    }

    /// How the strands of a section stand in the pose of the file under gravity; `None` where its solver does not ask, or there is no
    /// such section.
    pub fn standing(&self, section: usize) -> Option<Standing> {
        self.standing.get(section).copied().flatten()
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
        self.clock.set_params(params)?;
        self.wake();
        Ok(())
    }

    /// The parameters of a section.
    ///
    /// # Panics
    /// If there is no such section.
    pub fn params(&self, section: usize) -> &SimParams {
        self.sections[section].params()
    }

    /// Changes the parameters of a section, from the next frame on. Kernels are compiled only where the
    /// global shape comes or goes, or constraints change their iterations, and once for each.
    ///
    /// # Errors
    /// A parameter outside its range, or what the backend says; nothing changes then.
    ///
    /// # Panics
    /// If there is no such section.
    pub fn set_params(&mut self, backend: &mut dyn Backend, section: usize, params: SimParams) -> Result<(), SimError> {
        params.validate()?;
        let Self { sections, kernels, shared, owner, .. } = self;
        // Kernels that were compiled before something failed are gone.
        let mut compiled = kernels.clone();
        owner.change(backend, |backend| sections[section].set_params(backend, &mut compiled, params, shared))?;
        *kernels = compiled;
        self.wake();
        Ok(())
    }

    /// Brings the positions of all strands back, a ticket each section: `vec4<f32>`, vertex-major over all strands; position
    /// and inverse mass. [`Strands::deinterleave`](tressfx_core::strands::Strands::deinterleave) makes them strand-major, and [`HairSim::pose`] takes them to the world.
    pub fn read_positions(&self, list: &mut PassList) -> Vec<Ticket> {
        let read = |buffers: &StrandBuffers| {
            list.read_buffer(buffers.positions, 0, 16 * u64::from(buffers.shape.strand_vertices()))
        };
        self.strand_buffers.iter().map(read).collect()
    }

    /// Brings the positions of the guides one sub-step ago back, a ticket each section: `vec4<f32>`, vertex-major over the
    /// guides; `w` is 0.
    pub fn read_previous(&self, list: &mut PassList) -> Vec<Ticket> {
        let read = |section: &SimSection| {
            let bytes = 16 * u64::from(section.buffers.strands.shape.guide_vertices());
            list.read_buffer(section.buffers.previous, 0, bytes)
        };
        self.sections.iter().map(read).collect()
    }

    /// Brings back how many strands were reset so far because they had become non-finite: one `u32`.
    pub fn read_non_finite(&self, list: &mut PassList) -> Ticket {
        list.read_buffer(self.shared.counts, 0, 4)
    }

    /// Brings back how many strands of the last section with [`Solver::Direct`] came near a collider in the last sub-step, so that their contacts were asked for: one
    /// `u32`, and 0 where there is no room for colliders. It says what colliders cost: such a strand takes many times as long as others.
    pub fn read_near(&self, list: &mut PassList) -> Ticket {
        list.read_buffer(self.shared.counts, NEAR_COUNT, 4)
    }

    /// Records what a section is told about a sub-step. [`HairSim::step`] does this; tests and measurements of single
    /// kernels do it themselves.
    ///
    /// # Panics
    /// If there is no such section.
    pub fn record_step(&self, list: &mut PassList, section: usize, step: &Step) {
        self.sections[section].buffers.steps.upload(list, ALONE, &[*step]);
    }

    /// Records capsules and fields for steps that name them. [`HairSim::step`] does this; tests and measurements of single kernels do it
    /// themselves. The shapes are relative to the centre of the groom.
    ///
    /// # Errors
    /// More capsules than the simulation was made for.
    pub fn record_capsules<S: Into<PlacedShape> + Copy>(
        &self,
        list: &mut PassList,
        capsules: &[(S, CapsuleMotion)],
    ) -> Result<(), SimError> {
        let most = self.shared.colliders.map_or(0, |buffers| buffers.most);
        if capsules.len() > most {
            return Err(SimError::TooManyColliders { given: capsules.len(), most });
        }
        self.upload_colliders(list, &capsules.iter().copied().collect());
        Ok(())
    }

    /// Records one stage of all sections, or nothing where a section has none. [`HairSim::step`] does this; tests and
    /// measurements of single kernels do it themselves.
    pub fn record_stage(&self, list: &mut PassList, stage: Stage) {
        self.record_stage_at(list, stage, ALONE);
    }

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }

    fn upload_colliders(&self, list: &mut PassList, colliders: &ColliderList) {
        if let Some(buffers) = self.shared.colliders.filter(|_| !colliders.colliders.is_empty()) {
            list.upload(buffers.colliders, 0, &colliders.colliders);
        }
    }

    fn record_reset(&mut self, list: &mut PassList, rotation: Quat) {
        self.resets += 1;
        for section in &self.sections {
            let step = Step::reset(section.params(), &section.info, rotation);
            section.buffers.steps.upload(list, ALONE, &[step]);
        }
        for section in &self.sections {
            section.solver().stages().iter().for_each(|&stage| section.record(list, stage, ALONE));
        }
        self.record_volume(list, ALONE);
    }

    fn record_sub_steps(&mut self, list: &mut PassList, sub_steps: &[SubStep], input: &StepInput) {
        let mut colliders = std::mem::take(&mut self.colliders);
        colliders.clear();
        let center = self.clock.center();
        let mut each_section = |sub_step: &SubStep| -> Vec<[u32; 2]> {
            let sections = 0..self.sections.len();
            sections.map(|section| colliders.add(input.colliders, section, center, sub_step)).collect()
        };
        let ranges: Vec<_> = sub_steps.iter().map(&mut each_section).collect();
        self.upload_colliders(list, &colliders);
        let root_place = self.root_place;
        for (index, section) in self.sections.iter_mut().enumerate() {
            let step = |(sub_step, ranges): (&SubStep, &Vec<[u32; 2]>)| {
                let [first, end] = ranges[index];
                let step = section.next_step(sub_step, input.wind.as_ref());
                step.with_capsules(first, end).with_root_place(root_place)
            };
            let steps: Vec<_> = sub_steps.iter().zip(&ranges).map(step).collect();
            section.buffers.steps.upload(list, FIRST, &steps);
        }
        (0..sub_steps.len()).for_each(|index| self.record_sub_step(list, FIRST + index));
        self.colliders = colliders;
    }

    /// `place` is where the steps are.
    fn record_sub_step(&self, list: &mut PassList, place: usize) {
        let stages = |section: &SimSection| section.solver().stages();
        let most = self.sections.iter().map(|section| stages(section).len()).max().unwrap_or(0);
        for index in 0..most {
            for section in &self.sections {
                stages(section).get(index).iter().for_each(|&&stage| section.record(list, stage, place));
            }
        }
        self.record_volume(list, place);
    }
}
