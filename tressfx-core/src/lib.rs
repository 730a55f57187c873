//! Strands, views, and the contract with a graphics API.
//!
//! This crate names no graphics API, makes no device, never submits and never waits. It knows strands, not how they move
//! ([`tressfx-sim`](https://docs.rs/tressfx-sim)) or look ([`tressfx-render`](https://docs.rs/tressfx-render)).

#![forbid(unsafe_code)]

pub mod asset;
pub mod backend;
pub mod check;
mod epoch;
pub mod error;
mod format;
pub mod hazards;
pub mod id;
pub mod null;
pub mod pass;
pub mod shader;
pub mod shape;
pub mod strand_buffers;
pub mod strands;
pub mod view;

pub use error::{Error, Result};
/// The vectors, matrices and rotations that all crates use.
pub use glam;
/// The shader compiler, for backends that take its modules.
#[cfg(feature = "naga-ir")]
pub use naga;
