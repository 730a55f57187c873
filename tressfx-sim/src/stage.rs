//! The stages that a solver chooses from.

use tressfx_core::error::Label;

/// A step of the simulation: one kernel over the strands of each section, but for [`Stage::Direct`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Where the roots are; only where they have transforms of their own.
    Roots,
    /// All of a sub-step of the method of TressFX; or the reset to the rest pose.
    TressFx,
    /// All of a sub-step of rods; or the reset to the rest pose. With room for colliders it is a clear of the list of strands that may touch
    /// one, `hair.sim.direct`, and `hair.sim.direct_near` for these.
    Direct,
    /// Mass and momentum of the strands at the nodes of a grid; this and the next two where hair meets hair.
    VolumeSplat,
    /// Pressure and mean velocity at the nodes.
    VolumeNodes,
    /// What these change of the velocities of the strands.
    VolumePush,
    /// Follow strands are placed, and all strands get their tangents; once a frame.
    Tangents,
}

impl Stage {
    /// The label of its pass; of the first one, where there are two.
    pub fn label(self) -> Label {
        match self {
            Self::Roots => "hair.sim.roots",
            Self::TressFx => "hair.sim.tressfx",
            Self::Direct => "hair.sim.direct",
            Self::VolumeSplat => "hair.sim.volume_splat",
            Self::VolumeNodes => "hair.sim.volume_nodes",
            Self::VolumePush => "hair.sim.volume_push",
            Self::Tangents => "hair.sim.tangents",
        }
    }
}
