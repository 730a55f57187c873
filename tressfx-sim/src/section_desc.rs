//! What a section of a simulation is made of.

use tressfx_core::strands::Strands;

use crate::params::SimParams;
use crate::solver::Solver;

/// A section of a groom to be simulated.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SectionDesc<'a> {
    /// Its strands.
    pub strands: &'a Strands,
    /// How they move.
    pub params: SimParams,
    /// What solves their equations of motion.
    pub solver: Solver,
    /// Whether roots have transforms of their own ([`HairSim::set_roots`](crate::HairSim::set_roots)). Where they have not, all ride on the head.
    pub own_roots: bool,
}

impl<'a> SectionDesc<'a> {
    /// Strands whose roots ride on the head.
    pub fn new(strands: &'a Strands, params: SimParams) -> Self {
        Self { strands, params, solver: Solver::default(), own_roots: false }
    }

    /// The same with roots that have transforms of their own.
    #[must_use]
    pub fn with_own_roots(self) -> Self {
        Self { own_roots: true, ..self }
    }

    /// The same with another solver.
    #[must_use]
    pub fn with_solver(self, solver: Solver) -> Self {
        Self { solver, ..self }
    }
}
