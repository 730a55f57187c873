//! What the examples share: hair for an engine's frame, and what that engine shows beside it. Neither names a graphics API,
//! so that each example is left with what is special about its own.

#![forbid(unsafe_code)]

mod args;
mod hair;
mod stage;

pub use args::Args;
pub use hair::{Hair, head};
pub use stage::{Shade, Stage, Vertex};

/// The porting guide, so that the compiler reads its code.
#[doc = include_str!("../../docs/porting-guide.md")]
pub mod guide {}
