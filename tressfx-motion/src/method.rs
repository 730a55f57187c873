//! Solvers and their settings.

use serde::{Deserialize, Serialize};
use tressfx_sim::{ClockParams, SimParams, Solver};

use crate::figures::Extent;

/// A solver with its settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Method {
    pub(crate) family: Family,
    /// Sub-steps a second.
    pub(crate) rate: u32,
    /// Rounds of Newton's method, or iterations.
    pub(crate) rounds: u32,
    /// None: as many as the case has.
    pub(crate) vertices: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Family {
    Direct,
    TressFx,
}

/// Sub-steps a second of a default simulation.
const DEFAULT_RATE: u32 = 120;
/// Rounds or iterations of a default one.
const DEFAULT_ROUNDS: u32 = 2;

/// All methods, in the order of the tables.
pub(crate) fn methods(extent: Extent) -> Vec<Method> {
    let (rates, rounds, vertices): (&[u32], &[u32], &[u32]) = match extent {
        Extent::Quick => (&[30, 60, 120, 240, 480], &[2], &[8, 64]),
        Extent::Full => (&[30, 60, 120, 240, 480, 960, 1920], &[1, 2, 4], &[8, 16, 32, 64]),
    };
    let of = |family: Family| {
        let at = move |rate: u32, rounds: u32, vertices: Option<u32>| Method { family, rate, rounds, vertices };
        let steps = rounds.iter().flat_map(move |&rounds| rates.iter().map(move |&rate| at(rate, rounds, None)));
        steps.chain(vertices.iter().map(move |&vertices| at(DEFAULT_RATE, DEFAULT_ROUNDS, Some(vertices))))
    };
    [Family::Direct, Family::TressFx].into_iter().flat_map(of).collect()
}

impl Family {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::TressFx => "tressfx",
        }
    }
}

impl Method {
    /// With the sub-step, the rounds and the vertices that a simulation has if nobody says otherwise.
    pub(crate) fn is_default(&self) -> bool {
        (self.rate, self.rounds, self.vertices) == (DEFAULT_RATE, DEFAULT_ROUNDS, None)
    }

    pub(crate) fn solver(&self) -> Solver {
        match self.family {
            Family::Direct => Solver::Direct,
            Family::TressFx => Solver::TressFx,
        }
    }

    /// Parameters of a case with the rounds of the method. The only place that knows how a solver names them.
    pub(crate) fn params(&self, case: &SimParams) -> SimParams {
        match self.family {
            Family::Direct => SimParams { rounds: self.rounds, ..case.clone() },
            Family::TressFx => {
                SimParams { local_iterations: self.rounds, length_iterations: self.rounds, ..case.clone() }
            }
        }
    }

    pub(crate) fn clock(&self) -> ClockParams {
        ClockParams { sub_step: 1.0 / f64::from(self.rate), ..ClockParams::default() }
    }
}

/// Strands that nothing holds: no air, no shape, no stiffness beyond a bending length, in metres.
pub(crate) fn bare(bending_length: f32) -> SimParams {
    let shapeless = SimParams { local_stiffness: 0.0, global_stiffness: 0.0, damping: 0.0, ..SimParams::default() };
    SimParams { bending_length, air_drag: 0.0, sag_free: 0.0, ..shapeless }
}

/// Strands that bend under their weight, in still air, with a bending length in metres.
pub(crate) fn bending(bending_length: f32) -> SimParams {
    SimParams { bending_length, sag_free: 0.0, global_stiffness: 0.0, ..SimParams::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_method_is_there_twice_and_each_solver_has_its_default() {
        for extent in [Extent::Quick, Extent::Full] {
            let methods = methods(extent);
            assert_eq!(methods.iter().filter(|method| method.is_default()).count(), 2);
            for (i, method) in methods.iter().enumerate() {
                assert!(!methods[..i].contains(method), "{method:?}");
                method.params(&bare(0.01)).validate().unwrap();
                method.clock().validate().unwrap();
            }
        }
    }
}
