//! Strands, views, and the contract between the library and a graphics API: the [`Backend`](backend::Backend) trait, and
//! lists of passes as plain data ([`pass`]).
//!
//! This crate names no graphics API, makes no device, never submits and never waits. It holds the data of strands. How they
//! move is in [`tressfx-sim`](https://docs.rs/tressfx-sim), how they are drawn in
//! [`tressfx-render`](https://docs.rs/tressfx-render).

#![forbid(unsafe_code)]

pub mod asset;
pub mod backend;
pub mod body;
pub mod check;
mod epoch;
pub mod error;
mod format;
pub mod hash;
pub mod hazards;
pub mod id;
pub mod null;
pub mod pass;
pub mod shader;
pub mod shape;
pub mod strand_buffers;
pub mod strands;
pub mod texels;
pub mod uniform_array;
pub mod view;

pub use error::{Error, Result};
/// The vectors, matrices and rotations that all crates use.
pub use glam;
/// The shader compiler, for backends that build their shaders from its [`naga::Module`].
#[cfg(feature = "naga-ir")]
pub use naga;
