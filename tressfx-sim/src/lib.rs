//! The simulation of hair: kernels (compute shaders), their order, and the same computations in f64 on the CPU as a
//! reference.
//!
//! [`Solver::Direct`], the default, moves strands as rods that bend, twist and never stretch, all edges of a strand at once
//! ([`reference::direct`] says how). [`Solver::TressFx`] is the published method of TressFX with what is wrong there mended: Verlet
//! integration with velocity shock propagation, global and local shape constraints, wind, length constraints, and collision with
//! capsules ([`reference::tressfx`] says how). Sub-steps have a fixed length. [`HairSim`] makes its buffers and pipelines once and then only
//! writes passes into a [`PassList`](tressfx_core::pass::PassList). It never names a backend, submits or waits.
//!
//! A kernel has one name everywhere. `tressfx`, for example, is the file `shaders/tressfx.wgsl`, the Rust function in
//! `kernel/tressfx.rs` that makes its pass, the f64 function `tressfx` in [`mod@reference`] and the label `hair.sim.tressfx`.

#![forbid(unsafe_code)]

pub mod bending_length;
pub mod body;
mod buffers;
mod clock;
mod collider;
mod error;
pub mod field;
mod input;
mod interpolate;
mod kernel;
pub mod metrics;
mod params;
mod preset;
pub mod reference;
mod rods;
mod section;
mod section_desc;
mod sim;
mod sleep;
mod solver;
mod stage;
pub mod step;
mod volume;
mod wind;

pub use buffers::RootTransform;
pub use clock::{Clock, ClockParams, FramePlan, RootPath, SubStep};
pub use collider::{CapsuleMotion, Collider, ColliderMotion, ColliderShape, PlacedShape};
pub use error::SimError;
pub use input::StepInput;
pub use interpolate::{BetweenGuides, Interpolation, InterpolationParams, InterpolationUniform};
pub use params::{ParamError, SimParams};
pub use preset::{NoPreset, Preset};
pub use rods::Standing;
pub use section_desc::SectionDesc;
pub use sim::{HairSim, StepReport};
pub use sleep::{MotionTicket, SleepParams};
pub use solver::Solver;
pub use stage::Stage;
pub use volume::{VolumeGrid, VolumeParams};
pub use wind::Wind;
