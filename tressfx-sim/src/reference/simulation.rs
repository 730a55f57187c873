//! A whole groom in f64.

use glam::{DVec3, Quat, Vec3, Vec4};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{Bounds, Strands, about};

use super::{Guide, collide, follow, integrate, length, local_shape, velocity_shock};
use crate::clock::{Clock, ClockParams, StepInput};
use crate::error::SimError;
use crate::params::SimParams;
use crate::sim::{SectionDesc, StepReport};
use crate::step::{Step, Units};

/// What [`HairSim`](crate::HairSim) does, in f64 on the CPU.
#[derive(Debug)]
pub struct Simulation<'a> {
    sections: Vec<Section<'a>>,
    capsules: Vec<Capsule>,
    clock: Clock,
    non_finite: u64,
}

#[derive(Debug)]
struct Section<'a> {
    strands: &'a Strands,
    /// About the centre of the groom.
    rest: Vec<Vec4>,
    params: SimParams,
    units: Units,
    step: Step,
    positions: Vec<DVec3>,
    previous: Vec<DVec3>,
}

impl<'a> Simulation<'a> {
    /// A groom before its first frame.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(sections: &[SectionDesc<'a>], capsules: &[Capsule]) -> Result<Self, SimError> {
        sections.iter().try_for_each(|section| section.params.validate())?;
        let bounds =
            sections.iter().map(|section| section.strands.guide_bounds()).reduce(Bounds::union).unwrap_or_default();
        let clock = Clock::new(ClockParams::default(), bounds)?;
        let center = clock.center();
        let about = |capsule: &Capsule| Capsule { a: capsule.a - center, b: capsule.b - center, ..*capsule };
        Ok(Self {
            sections: sections.iter().map(|section| Section::new(section, center)).collect(),
            capsules: capsules.iter().map(about).collect(),
            clock,
            non_finite: 0,
        })
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
        let frame = self.clock.advance(input.dt, input.head);
        for section in &mut self.sections {
            if let Some(rotation) = frame.reset {
                section.step = Step::reset(&section.params, &section.units, rotation);
                section.each_guide(|step, _, _, guide| integrate(step, guide));
            }
            for sub_step in &frame.sub_steps {
                section.step = Step::new(&section.params, &section.units, sub_step, input.wind.as_ref());
                self.non_finite += section.sub_step(&self.capsules);
            }
        }
        Ok(StepReport {
            sub_steps: frame.sub_steps.len() as u32,
            reset: frame.reset.is_some(),
            teleported: frame.teleported,
            dropped: frame.dropped,
        })
    }

    /// Positions of all strands of a section about the centre of the groom, strand-major.
    ///
    /// # Panics
    /// If there is no such section.
    pub fn positions(&self, section: usize) -> Vec<DVec3> {
        let section = &self.sections[section];
        let (guides, vertices) = (section.strands.guides as usize, section.strands.vertices as usize);
        let follows = section.strands.follow_offsets.iter().enumerate().flat_map(|(index, &offset)| {
            let start = index % guides * vertices;
            follow(&section.step, &section.positions[start..start + vertices], offset)
        });
        section.positions.iter().copied().chain(follows).collect()
    }

    /// Strands that were reset because they had become non-finite.
    pub fn non_finite(&self) -> u64 {
        self.non_finite
    }
}

impl<'a> Section<'a> {
    fn new(desc: &SectionDesc<'a>, center: Vec3) -> Self {
        let strands = desc.strands;
        let units = Units { metres_per_unit: strands.metres_per_unit, tip_separation: strands.tip_separation };
        Self {
            strands,
            rest: about(center, &strands.rest),
            params: desc.params.clone(),
            units,
            step: Step::reset(&desc.params, &units, Quat::IDENTITY),
            positions: vec![DVec3::ZERO; strands.rest.len()],
            previous: vec![DVec3::ZERO; strands.rest.len()],
        }
    }

    /// One sub-step; says how many strands had become non-finite.
    fn sub_step(&mut self, capsules: &[Capsule]) -> u64 {
        let mut non_finite = 0;
        self.each_guide(|step, params, index, guide| {
            integrate(step, guide);
            velocity_shock(step, guide);
            if params.has_local_shape(guide.vertices() as u32) {
                local_shape(step, guide, params.local_iterations);
            }
            non_finite += u64::from(length(step, guide, index, params.length_iterations));
            collide(step, guide, capsules);
        });
        non_finite
    }

    fn each_guide(&mut self, mut visit: impl FnMut(&Step, &SimParams, u32, &mut Guide)) {
        let vertices = self.strands.vertices as usize;
        let rest = self.rest.chunks(vertices).zip(self.strands.rest_lengths.chunks(vertices));
        let moving = self.positions.chunks_mut(vertices).zip(self.previous.chunks_mut(vertices));
        for (index, ((rest, rest_lengths), (positions, previous))) in rest.zip(moving).enumerate() {
            let mut guide = Guide { rest, rest_lengths, positions, previous };
            visit(&self.step, &self.params, index as u32, &mut guide);
        }
    }
}
