//! The simulation of hair: kernels (compute shaders), their order, and the same computations in f64 on the CPU as a
//! reference.
//!
//! The method is that of TressFX 4.1 with its errors corrected: Verlet integration, global and local shape constraints,
//! velocity shock propagation, length constraints, wind, and collision with capsules. Sub-steps have a fixed length, and
//! edges have their exact length at the end of each. [`HairSim`] makes its buffers and pipelines once and then only writes
//! passes into a [`PassList`](tressfx_core::pass::PassList). It never names a backend, submits or waits.
//!
//! [`Solver::Direct`] moves strands as rods instead, all edges of a strand at once ([`reference::direct`] says how).
//!
//! A kernel has one name everywhere. `integrate`, for example, is the file `shaders/integrate.wgsl`, the Rust function in
//! `kernel/integrate.rs` that makes its pass, the f64 function `integrate` in [`mod@reference`] and the label
//! `hair.sim.integrate`.

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
mod rods;
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
pub use rods::Standing;
pub use sim::{HairSim, SectionDesc, StepReport};
pub use solver::Solver;
pub use stage::Stage;
pub use wind::Wind;
