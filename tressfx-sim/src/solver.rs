//! Which stages make a sub-step.

use tressfx_core::strands::Strands;

use crate::buffers::RodBuffers;
use crate::stage::Stage;

/// What solves the equations of motion of a section: it chooses the stages of a sub-step and their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Solver {
    /// The published method of TressFX: positions are integrated, and constraints correct them one after the other
    /// ([`tressfx`](crate::reference::tressfx) says how). Edges stretch.
    TressFx,
    /// Rods whose edges turn and never stretch, with bending and twist; all forces are implicit, and all edges of a strand are solved
    /// for at once. Its material is in SI units and means the same at any resolution and sub-step. Contacts and friction
    /// are inside the solve. It keeps [`Solver::state_bytes`] a section, and finds what strands want at rest when the simulation is made, which
    /// takes time on the CPU.
    #[default]
    Direct,
}

impl Solver {
    /// The stage that a frame ends with, whatever the solver.
    pub const FRAME_END: Stage = Stage::Tangents;

    /// Bytes of the largest buffer that the solver alone makes for a section: 0 of those that make none.
    pub fn state_bytes(self, strands: &Strands) -> u64 {
        match self {
            Self::TressFx => 0,
            Self::Direct => RodBuffers::state_bytes(strands.guides, strands.vertices),
        }
    }

    /// The stages of a sub-step, in order, and of a reset.
    pub fn stages(self) -> &'static [Stage] {
        match self {
            Self::TressFx => &[Stage::Roots, Stage::TressFx],
            Self::Direct => &[Stage::Roots, Stage::Direct],
        }
    }
}
