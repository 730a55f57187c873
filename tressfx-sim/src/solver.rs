//! Which stages make a sub-step.

use crate::params::SimParams;
use crate::stage::Stage;

/// What solves the equations of motion of a section: it chooses the stages of a sub-step and their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Solver {
    /// That of TressFX: a position is integrated, and constraints correct it one after the other.
    #[default]
    TressFx,
    /// Rods whose edges turn and never stretch, with bending and twist; all forces are implicit, and all edges of a strand are solved
    /// for at once. Its material is in SI units and means the same at any resolution and sub-step. Contacts and friction
    /// are inside the solve.
    Direct,
}

/// What decides whether a stage has an effect in a sub-step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions {
    pub(crate) wind: bool,
    /// Whether the section has capsules to collide with.
    pub(crate) capsules: bool,
}

impl Solver {
    /// The stages of a reset.
    pub fn reset(self) -> &'static [Stage] {
        match self {
            Self::TressFx => &[Stage::Roots, Stage::Integrate],
            Self::Direct => &[Stage::Roots, Stage::Direct],
        }
    }

    /// The stage that a frame ends with, whatever the solver.
    pub const FRAME_END: Stage = Stage::Tangents;

    /// The stages of a sub-step, in order.
    pub fn stages(self) -> &'static [Stage] {
        match self {
            Self::TressFx => &[
                Stage::Roots,
                Stage::Integrate,
                Stage::LocalShape,
                Stage::Wind,
                Stage::Lengths,
                Stage::Recovery,
                Stage::Collide,
            ],
            Self::Direct => &[Stage::Roots, Stage::Direct],
        }
    }

    /// Whether a stage changes anything.
    pub(crate) fn needs(self, stage: Stage, params: &SimParams, vertices: u32, conditions: Conditions) -> bool {
        match stage {
            Stage::LocalShape => params.has_local_shape(vertices),
            Stage::Wind => conditions.wind && params.wind_drag > 0.0,
            Stage::Collide => conditions.capsules,
            _ => true,
        }
    }
}
