//! Random and hostile cases for the solvers, and a judge of what they do: what `cargo xtask stress` runs.
//!
//! A [`Case`](case::Case) is made from a seed: strands, parameters, and frames with all that happens in them. It is played on a
//! backend, in a wild part and half a second of calm after it, and judged. What fails is made smaller, and its seed is kept.
//! A map of stability shows where strands come to rest, over stiffness, sub-step and vertices.

#![forbid(unsafe_code)]

pub mod case;
pub mod dice;
pub mod energy;
pub mod gpu;
pub mod groom;
pub mod judge;
pub mod kept;
pub mod map;
pub mod motion;
pub mod page;
pub mod params;
pub mod player;
pub mod plot;
pub mod run;
pub mod tally;
pub mod verdict;
