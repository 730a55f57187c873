//! What a case comes to.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::case::{Part, SolverName};
use crate::gpu::BackendName;

/// What is wrong with a case.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trouble {
    /// Something panicked.
    Panic(String),
    /// Something legal was refused, or the backend failed.
    Broken(String),
    /// Positions that are not finite.
    NonFinite(u64),
    /// Strands that were reset because they had become non-finite.
    Resets(u32),
    /// A reset that nobody asked for, without a teleport.
    UnaskedReset,
    /// A root that is not where the head has it: the share of its distance from the centre.
    Root(f64),
    /// An edge that is off by this share of its length, beyond rounding.
    Edge(f64),
    /// Energy out of nothing: the share of what a fall by the strand's length sets free.
    Energy(f64),
    /// Faster, half a second after the last disturbance, than what is left of its speed allows: by this factor.
    Restless(f64),
    /// The two backends left other bits.
    Backends,
}

impl Trouble {
    /// What kind it is, in a word.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Panic(_) => "panic",
            Self::Broken(_) => "broken",
            Self::NonFinite(_) => "non-finite",
            Self::Resets(_) => "resets",
            Self::UnaskedReset => "unasked reset",
            Self::Root(_) => "root",
            Self::Edge(_) => "edge",
            Self::Energy(_) => "energy",
            Self::Restless(_) => "restless",
            Self::Backends => "backends",
        }
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Panic(message) => write!(f, "it panicked: {message}"),
            Self::Broken(message) => write!(f, "{message}"),
            Self::NonFinite(count) => write!(f, "{count} positions are not finite"),
            Self::Resets(count) => write!(f, "{count} strands were reset because they were not finite"),
            Self::UnaskedReset => write!(f, "a reset that nobody asked for"),
            Self::Root(share) => write!(f, "a root is off by {share:.1e} of its distance from the centre"),
            Self::Edge(share) => write!(f, "an edge is off by {share:.1e} of its length"),
            Self::Energy(share) => write!(f, "it gained {share:.1e} of the energy of a fall by its length"),
            Self::Restless(factor) => write!(f, "after half a second it is {factor:.1} times as fast as it may be"),
            Self::Backends => write!(f, "the backends left other bits"),
        }
    }
}

/// What was counted in a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Strands, with those that follow guides.
    pub strands: u64,
    /// Sub-steps.
    pub sub_steps: u64,
    /// Resets because of a teleport.
    pub teleports: u64,
    /// Strands that were reset because they had become non-finite.
    pub resets: u64,
    /// Positions that were not finite when they were looked at.
    pub non_finite: u64,
    /// The worst edge error beyond rounding, of its length.
    pub edge: f64,
    /// The most energy that a guide gained; `None` where energy may come from elsewhere.
    pub energy: Option<f64>,
    /// The highest speed half a second after the last disturbance, m/s; `None` where the calm was cut short.
    pub rest_speed: Option<f64>,
    /// What is wrong.
    pub troubles: Vec<Trouble>,
    /// Of all that was seen: other bits give another number.
    pub fingerprint: u64,
}

/// A case that failed.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Failure {
    /// What moves the strands.
    pub solver: SolverName,
    /// What runs the passes.
    pub backend: BackendName,
    /// Of the case.
    pub seed: u64,
    /// The part of the case that still fails.
    pub part: Part,
    /// What is wrong with it.
    pub trouble: Trouble,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Part { first, strands, frames } = self.part;
        write!(f, "seed {}, {}, {}: {}", self.seed, self.solver.name(), self.backend.name(), self.trouble)?;
        match self.part == Part::ALL {
            true => Ok(()),
            false => write!(f, " (strands from {first}, {strands} of them; {frames} frames)"),
        }
    }
}
