//! What the benchmarks share: grooms by name, devices that can time passes, an engine that records, and criterion with the clock of the GPU.

mod clock;
mod device;
mod groom;
mod recorder;
mod spread;

pub use clock::GpuClock;
pub use device::{DEVICES, Open, timed, timed_by_name};
pub use groom::{Failure, asset, strands};
pub use recorder::Recorder;
pub use spread::{Spread, median_and_least};
