//! A whole groom in f64.

use glam::{DQuat, DVec3, Quat, Vec3, Vec4};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{Bounds, Strands, relative_to};
use tressfx_core::view::Pose;

use super::direct::{Rod, RodRest, direct_guide};
use super::field::{Field, PlacedField};
use super::volume::{GroomVolume, Moving, to_world, volume_vertex};
use super::{Guide, GuideRoot, RootPlace, RootWay, follow_strand, roots, tressfx};
use crate::buffers::RootTransform;
use crate::clock::{Clock, ClockParams};
use crate::collider::{CapsuleMotion, PlacedShape};
use crate::error::SimError;
use crate::input::StepInput;
use crate::params::SimParams;
use crate::rods::rod_rest;
use crate::section_desc::SectionDesc;
use crate::sim::StepReport;
use crate::solver::Solver;
use crate::step::{SectionInfo, Step};
use crate::volume::VolumeParams;

/// What [`HairSim`](crate::HairSim) does, in f64 on the CPU.
#[derive(Debug)]
pub struct Simulation<'a> {
    sections: Vec<Section<'a>>,
    clock: Clock,
    fields: Vec<Field>,
    volume: Option<GroomVolume>,
    non_finite: u64,
}

#[derive(Debug)]
struct Section<'a> {
    strands: &'a Strands,
    /// Relative to the centre of the groom.
    rest: Vec<Vec4>,
    params: SimParams,
    info: SectionInfo,
    step: Step,
    positions: Vec<DVec3>,
    previous: Vec<DVec3>,
    /// Of each guide: its way in the frame, and its motion; empty where roots ride on the head.
    roots: Vec<(RootWay, GuideRoot)>,
    /// One a guide; empty where another solver moves them.
    rods: Vec<(RodRest, Rod)>,
}

impl<'a> Simulation<'a> {
    /// A groom before its first frame.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(sections: &[SectionDesc<'a>]) -> Result<Self, SimError> {
        sections.iter().try_for_each(|section| section.params.validate())?;
        let bounds =
            sections.iter().map(|section| section.strands.guide_bounds()).reduce(Bounds::union).unwrap_or_default();
        let clock = Clock::new(ClockParams::default(), bounds)?;
        let center = clock.center();
        Ok(Self {
            sections: sections.iter().map(|section| Section::new(section, center)).collect(),
            clock,
            fields: Vec::new(),
            volume: None,
            non_finite: 0,
        })
    }

    /// The same with fields that colliders may name; one that names another is passed over.
    #[must_use]
    pub fn with_fields(self, fields: Vec<Field>) -> Self {
        Self { fields, ..self }
    }

    /// The same with hair against hair.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn with_volume(self, params: &VolumeParams) -> Result<Self, SimError> {
        params.validate()?;
        let strands: Vec<_> = self.sections.iter().map(|section| section.strands).collect();
        let volume = GroomVolume::new(&strands, self.clock.center(), params);
        Ok(Self { volume: Some(volume), ..self })
    }

    /// Changes how time is cut.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn set_clock_params(&mut self, params: ClockParams) -> Result<(), SimError> {
        Ok(self.clock.set_params(params)?)
    }

    /// Simulates a frame.
    ///
    /// # Errors
    /// Something in the input that is not finite or out of range.
    pub fn step(&mut self, input: &StepInput) -> Result<StepReport, SimError> {
        input.validate()?;
        let plan = self.clock.advance_along(input.dt, input.path, input.head);
        if let Some(rotation) = plan.reset {
            for section in &mut self.sections {
                section.step = Step::reset(&section.params, &section.info, rotation);
                section.move_roots();
                section.solve(&[], &[]);
            }
            self.volume_step();
        }
        let center = self.clock.center();
        for sub_step in &plan.sub_steps {
            for (index, section) in self.sections.iter_mut().enumerate() {
                section.step = Step::new(&section.params, &section.info, sub_step, input.wind.as_ref());
                let hit = input.colliders.iter().filter(|collider| !collider.except.contains(&index));
                let shapes: Vec<_> = hit.map(|collider| collider.at(center, sub_step)).collect();
                let capsules: Vec<_> = shapes.iter().filter_map(capsule).collect();
                let fields: Vec<_> = shapes.iter().filter_map(|shape| placed_field(&self.fields, shape)).collect();
                section.move_roots();
                self.non_finite += section.solve(&capsules, &fields);
            }
            self.volume_step();
        }
        self.sections.iter_mut().flat_map(|section| &mut section.roots).for_each(|(way, _)| way.end_frame());
        Ok(StepReport {
            sub_steps: plan.sub_steps.len() as u32,
            reset: plan.reset.is_some(),
            teleported: plan.teleported,
            dropped: plan.dropped,
            asleep: false,
        })
    }

    /// The end of a sub-step, where hair meets hair.
    fn volume_step(&mut self) {
        let Some(volume) = &self.volume else { return };
        let each = self.sections.iter().zip(&volume.masses);
        let vertices: Vec<_> = each.flat_map(|(section, masses)| section.moving(masses)).collect();
        let length = self.sections.first().map_or(0.0, |section| f64::from(section.step.length));
        let pushes = volume.pushes(length, &vertices);
        let mut pushes = pushes.iter();
        self.sections.iter_mut().for_each(|section| section.push(&mut pushes));
    }

    /// What [`HairSim::set_roots`](crate::HairSim::set_roots) does.
    ///
    /// # Panics
    /// If there is no such section, or it has another number of roots.
    pub fn set_roots(&mut self, section: usize, poses: &[Pose]) {
        let center = self.clock.center();
        let roots = &mut self.sections[section].roots;
        assert_eq!(roots.len(), poses.len(), "roots of section {section}");
        for ((way, _), pose) in roots.iter_mut().zip(poses) {
            way.end = RootTransform::new(center, pose).into();
        }
    }

    /// Positions of all strands of a section relative to the centre of the groom, strand-major.
    ///
    /// # Panics
    /// If there is no such section.
    pub fn positions(&self, section: usize) -> Vec<DVec3> {
        let section = &self.sections[section];
        let (guides, vertices) = (section.strands.guides as usize, section.strands.vertices as usize);
        let follows = section.strands.follow_offsets.iter().enumerate().flat_map(|(index, &offset)| {
            let (guide, start) = (index % guides, index % guides * vertices);
            let root = section.roots.get(guide).map(|(.., root)| root);
            follow_strand(&section.step, &section.positions[start..start + vertices], offset, root)
        });
        section.positions.iter().copied().chain(follows).collect()
    }

    /// Strands that were reset because they had become non-finite.
    pub fn non_finite(&self) -> u64 {
        self.non_finite
    }
}

fn capsule((shape, motion): &(PlacedShape, CapsuleMotion)) -> Option<(Capsule, CapsuleMotion)> {
    match shape {
        PlacedShape::Capsule(capsule) => Some((*capsule, *motion)),
        PlacedShape::Field { .. } => None,
    }
}

fn placed_field<'a>(fields: &'a [Field], (shape, motion): &(PlacedShape, CapsuleMotion)) -> Option<PlacedField<'a>> {
    let PlacedShape::Field { index, rotation, translation } = shape else { return None };
    let (rotation, translation) = (rotation.as_dquat().normalize(), translation.as_dvec3());
    Some(PlacedField { field: fields.get(*index as usize)?, rotation, translation, motion: *motion })
}

impl<'a> Section<'a> {
    fn new(desc: &SectionDesc<'a>, center: Vec3) -> Self {
        let strands = desc.strands;
        let info = SectionInfo::new(strands, desc.solver);
        let rod = |guide: usize| {
            let (rest, _) = rod_rest(strands, &desc.params, guide);
            let rod = Rod::at_rest(&rest, DQuat::IDENTITY);
            (rest, rod)
        };
        let rods = if desc.solver == Solver::Direct { strands.guides as usize } else { 0 };
        let root = GuideRoot { now: RootPlace::WITH_HEAD, last: RootPlace::WITH_HEAD };
        let roots = if desc.own_roots { strands.guides as usize } else { 0 };
        Self {
            strands,
            rest: relative_to(center, &strands.rest),
            params: desc.params.clone(),
            info,
            step: Step::reset(&desc.params, &info, Quat::IDENTITY),
            positions: vec![DVec3::ZERO; strands.rest.len()],
            previous: vec![DVec3::ZERO; strands.rest.len()],
            roots: vec![(RootWay::WITH_HEAD, root); roots],
            rods: (0..rods).map(rod).collect(),
        }
    }

    fn move_roots(&mut self) {
        for (way, root) in &mut self.roots {
            roots(&self.step, way, root);
        }
    }

    /// A sub-step or a reset; says how many strands had become non-finite.
    fn solve(&mut self, capsules: &[(Capsule, CapsuleMotion)], fields: &[PlacedField]) -> u64 {
        match self.info.solver {
            Solver::TressFx => self.positions_step(capsules, fields),
            Solver::Direct => self.rods_step(capsules, fields),
        }
    }

    /// The guides as the grid of hair against hair sees them.
    fn moving(&self, masses: &[f64]) -> Vec<Moving> {
        let vertices = self.strands.vertices as usize;
        let vertex = |(index, &mass): (usize, &f64)| {
            let here = self.positions[index];
            let displacement = match self.rods.get(index / vertices) {
                Some((_, rod)) => rod.displacements[index % vertices],
                None => here - self.previous[index],
            };
            let own_root = self.roots.get(index / vertices).map(|(.., root)| root);
            let (place, velocity) = volume_vertex(&self.step, self.info.solver, own_root, here, displacement);
            Moving { place, velocity, mass }
        };
        masses.iter().enumerate().map(vertex).collect()
    }

    /// Takes what changes the velocities of its vertices, displacements in the space of the head.
    fn push<'p>(&mut self, pushes: &mut impl Iterator<Item = &'p DVec3>) {
        let (vertices, length) = (self.strands.vertices as usize, f64::from(self.step.length));
        for (index, push) in pushes.take(self.positions.len()).enumerate() {
            let push = if self.rest[index].w == 0.0 { DVec3::ZERO } else { to_world(&self.step, *push) };
            match self.rods.get_mut(index / vertices) {
                Some((_, rod)) => rod.pushes[index % vertices] = push / (length * length),
                None => self.previous[index] -= push,
            }
        }
    }

    /// A sub-step of positions, or their reset; says how many strands had become non-finite.
    fn positions_step(&mut self, capsules: &[(Capsule, CapsuleMotion)], fields: &[PlacedField]) -> u64 {
        let mut non_finite = 0;
        self.each_guide(|step, params, index, guide| {
            non_finite += u64::from(tressfx(step, params, guide, index, capsules, fields));
        });
        non_finite
    }

    /// A sub-step of rods, or their reset; says how many had become non-finite.
    fn rods_step(&mut self, capsules: &[(Capsule, CapsuleMotion)], fields: &[PlacedField]) -> u64 {
        let mut rods = std::mem::take(&mut self.rods);
        let mut non_finite = 0;
        self.each_guide(|step, _, index, guide| {
            let (rest, rod) = &mut rods[index as usize];
            non_finite += u64::from(direct_guide(step, guide, rest, rod, index, capsules, fields));
        });
        self.rods = rods;
        non_finite
    }

    fn each_guide(&mut self, mut visit: impl FnMut(&Step, &SimParams, u32, &mut Guide)) {
        let vertices = self.strands.vertices as usize;
        let rest = self.rest.chunks(vertices).zip(self.strands.rest_lengths.chunks(vertices));
        let moving = self.positions.chunks_mut(vertices).zip(self.previous.chunks_mut(vertices));
        for (index, ((rest, rest_lengths), (positions, previous))) in rest.zip(moving).enumerate() {
            let own_root = self.roots.get(index).map(|(.., root)| *root);
            let mut guide = Guide { rest, rest_lengths, positions, previous, own_root };
            visit(&self.step, &self.params, index as u32, &mut guide);
        }
    }
}
