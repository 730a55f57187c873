//! The stages that a solver chooses from.

use tressfx_core::error::Label;

/// A step of the simulation: one kernel over the strands of each section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Where the roots are; only where they have transforms of their own.
    Roots,
    /// Velocity shock, Verlet integration and global shape; or the reset to the rest pose.
    Integrate,
    /// Edges want the angles of the rest pose.
    LocalShape,
    /// The wind moves vertices across their edges.
    Wind,
    /// Edges get their lengths back.
    Lengths,
    /// Strands that have become non-finite go back to their rest pose.
    Recovery,
    /// Strands leave the capsules.
    Collide,
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
            Self::Integrate => "hair.sim.integrate",
            Self::LocalShape => "hair.sim.local_shape",
            Self::Wind => "hair.sim.wind",
            Self::Lengths => "hair.sim.lengths",
            Self::Recovery => "hair.sim.recovery",
            Self::Collide => "hair.sim.collide",
            Self::Direct => "hair.sim.direct",
            Self::Tangents => "hair.sim.tangents",
        }
    }
}
