//! The stages that a solver chooses from.

use tressfx_core::error::Label;

/// A step of the simulation: one kernel over the strands of each section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Where the roots are; only where they have transforms of their own.
    Roots,
    /// All of a sub-step of the method of TressFX; or the reset to the rest pose.
    TressFx,
    /// All of a sub-step of rods; or the reset to the rest pose.
    Direct,
    /// Follow strands are placed, and all strands get their tangents; once a frame.
    Tangents,
}

impl Stage {
    /// The label of its pass.
    pub fn label(self) -> Label {
        match self {
            Self::Roots => "hair.sim.roots",
            Self::TressFx => "hair.sim.tressfx",
            Self::Direct => "hair.sim.direct",
            Self::Tangents => "hair.sim.tangents",
        }
    }
}
