//! Cases.

use std::fmt;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use tressfx_core::strands::{Bounds, Strands, StrandsError};
use tressfx_sim::{ClockParams, SimParams, Solver};

use crate::dice::Dice;
use crate::groom::groom;
use crate::motion::{Place, Script, script};
use crate::params::{SUB_STEPS_A_FRAME, clock_params, sim_params};

/// Vertices of guides times sub-steps, in either part of a case: what keeps a case from taking minutes.
const WORK: f64 = 5e5;
/// The most vertices of guides that `Direct` is asked to hold against gravity: what each joint has to want is found on the CPU, and where a
/// strand does not stand at any stiffness, that takes up to a tenth of a second a vertex.
const MOST_STANDING: f64 = 256.0;
/// Sub-steps in either part of a case.
const SUB_STEPS: f64 = 1000.0;

/// A solver, as one types it.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SolverName {
    /// [`Solver::Direct`].
    Direct,
    /// [`Solver::TressFx`].
    Tressfx,
}

impl SolverName {
    /// The solver.
    pub fn solver(self) -> Solver {
        match self {
            Self::Direct => Solver::Direct,
            Self::Tressfx => Solver::TressFx,
        }
    }

    /// As it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Tressfx => "tressfx",
        }
    }
}

/// What is left of a case: what fails is made smaller with it.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Part {
    /// The first strand of the groom.
    pub first: u32,
    /// How many strands, at most.
    pub strands: u32,
    /// How many frames of the wild part, at most.
    pub frames: u32,
}

impl Part {
    /// All of it.
    pub const ALL: Self = Self { first: 0, strands: u32::MAX, frames: u32::MAX };
}

/// Something that a solver has to survive.
#[derive(Clone, Debug)]
pub struct Case {
    /// What it was made from.
    pub seed: u64,
    /// What moves the strands.
    pub solver: SolverName,
    /// The strands.
    pub strands: Strands,
    /// How they move.
    pub params: SimParams,
    /// How time is cut.
    pub clock: ClockParams,
    /// What happens.
    pub script: Script,
    /// Sub-steps that the calm after the wild part may have: where half a second has more, it is cut short.
    pub most_sub_steps: f64,
}

impl Case {
    /// The part of a case of this seed.
    ///
    /// # Errors
    /// Strands that cannot be prepared: a mistake of the generator.
    pub fn new(seed: u64, solver: SolverName, part: Part) -> Result<Self, StrandsError> {
        let dice = Dice::new(seed);
        let groom = groom(dice);
        let whole = Strands::new(&groom.asset, &groom.options)?;
        let work = f64::from(whole.guides * whole.vertices);
        let sub_steps = (WORK / work).clamp(3.0, SUB_STEPS);
        let most_a_frame = SUB_STEPS_A_FRAME.min(sub_steps / 3.0).max(1.0);
        let clock = clock_params(dice, most_a_frame);
        let frame = (clock.max_frame / clock.sub_step).floor().max(1.0);
        let frames = (sub_steps / frame).clamp(3.0, 60.0) as u32;
        let mut params = sim_params(dice, solver);
        if work > MOST_STANDING {
            params.sag_free = 0.0;
        }
        let strands = match part {
            Part { first: 0, strands: u32::MAX, .. } => whole.clone(),
            Part { first, strands, .. } => Strands::new(&groom.only(first, strands).asset, &options(&whole))?,
        };
        let place = place(&strands, solver, &clock);
        let mut script = script(dice, &place, frames);
        script.frames.truncate(part.frames as usize);
        Ok(Self { seed, solver, strands, params, clock, script, most_sub_steps: sub_steps })
    }

    /// Colliders that a frame may have.
    pub fn most_colliders(&self) -> usize {
        let frames = self.script.frames.iter().map(|frame| frame.colliders.len());
        frames.chain([self.script.resting_on.len()]).max().unwrap_or(0)
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Strands { guides, vertices, follows, metres_per_unit, rest_lengths, .. } = &self.strands;
        let Script { head, own_roots, frames, is_left_alone, .. } = &self.script;
        let lengths =
            rest_lengths.chunks(*vertices as usize).map(|lengths| lengths.iter().sum::<f32>() * metres_per_unit);
        let longest = lengths.fold(0.0, f32::max);
        writeln!(
            f,
            "{guides} guides of {vertices} vertices, up to {longest} m long, {follows} follow each; {metres_per_unit} m a unit"
        )?;
        writeln!(f, "{:?}\n{:?}", self.params, self.clock)?;
        write!(f, "{} frames, head {head:?}, own roots {own_roots}, left alone {is_left_alone}", frames.len())
    }
}

fn place(strands: &Strands, solver: SolverName, clock: &ClockParams) -> Place {
    let bounds: Bounds = strands.guide_bounds();
    Place {
        bounds,
        metres_per_unit: strands.metres_per_unit,
        solver,
        guides: strands.guides,
        most_colliders: 8,
        max_frame: clock.max_frame,
    }
}

/// The options that strands were made with.
fn options(strands: &Strands) -> tressfx_core::strands::StrandOptions {
    tressfx_core::strands::StrandOptions {
        vertices: Some(strands.vertices),
        follows: Some(strands.follows),
        tip_separation: strands.tip_separation,
        metres_per_unit: Some(strands.metres_per_unit),
        seed: 1,
        ..Default::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_case_and_a_part_of_it_fits() {
        for seed in 0..40 {
            let case = Case::new(seed, SolverName::Tressfx, Part::ALL).unwrap();
            let again = Case::new(seed, SolverName::Tressfx, Part::ALL).unwrap();
            assert_eq!((&case.strands, &case.params, case.clock), (&again.strands, &again.params, again.clock));
            let part = Part { first: 0, strands: 1, frames: 2 };
            let small = Case::new(seed, SolverName::Tressfx, part).unwrap();
            assert_eq!((small.strands.guides, small.strands.vertices), (1, case.strands.vertices), "{seed}");
            assert!(small.script.frames.len() <= 2 && small.clock == case.clock && small.params == case.params);
        }
    }
}
