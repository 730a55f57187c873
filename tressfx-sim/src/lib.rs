//! The simulation of hair: kernels, their order, and their f64 references.
//!
//! The method is that of TressFX 4.1 with its defects mended: Verlet integration, global and local shape constraints,
//! velocity shock propagation, length constraints, wind, capsules; in fixed sub-steps, and with exact lengths at the end of
//! each. [`HairSim`] makes its buffers and pipelines once and then only writes passes into a
//! [`PassList`](tressfx_core::pass::PassList); it never names a backend, submits or waits.
//!
//! Every kernel `x` is one file `shaders/x.wgsl`, one function `kernel::x`, one f64 function [`mod@reference`]`::x` and one label
//! `hair.sim.x`.

#![forbid(unsafe_code)]

mod buffers;
mod clock;
mod collider;
mod error;
mod input;
mod kernel;
pub mod metrics;
mod params;
pub mod reference;
mod section;
mod sim;
mod solver;
mod stage;
pub mod step;
mod wind;

pub use buffers::RootTransform;
pub use clock::{Clock, ClockParams, FramePlan, SubStep};
pub use collider::{CapsuleMotion, Collider, ColliderMotion};
pub use error::SimError;
pub use input::StepInput;
pub use params::{ParamError, SimParams};
pub use sim::{HairSim, SectionDesc, StepReport};
pub use solver::Solver;
pub use stage::Stage;
pub use wind::Wind;
