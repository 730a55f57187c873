//! What the benchmarks share: grooms by name, devices that can time passes, and criterion with the clock of the GPU.

#![forbid(unsafe_code)]

mod clock;
mod device;
mod groom;

pub use clock::GpuClock;
pub use device::{DEVICES, Open, timed};
pub use groom::{Failure, asset, strands};
