//! The suite that any TressFX backend must pass, and what the tests across crates share.
//!
//! An engine's team writes, in `tests/conformance.rs` of its own repository:
//!
//! ```ignore
//! tressfx_conformance::suite!(|| MyBackend::headless());
//! ```
//!
//! which is one `#[test]` for each case of [`mod@suite`]. For a backend that records into an engine's own encoder there is
//! [`embed_suite!`] as well: the team says in an [`Embed`](embed::Embed) how its engine begins and submits one.

pub mod embed;
pub mod failing;
pub mod faulty;
pub mod render;
pub mod rod;
pub mod rules;
pub mod scene;
pub mod show;
pub mod sim;
pub mod solid;
pub mod suite;

use tressfx_core::backend::Run;
use tressfx_core::pass::{PassList, Ticket};

/// Runs a list and brings one read-back home.
///
/// # Panics
/// If the backend fails.
pub fn run_and_read(backend: &mut dyn Run, list: &PassList, ticket: Ticket) -> Vec<u8> {
    backend.run(list).expect("the list runs");
    backend.read(ticket).ready().expect("the list has run, so the bytes are there")
}
