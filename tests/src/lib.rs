//! The suite that any TressFX backend must pass, and the tests across crates.

pub mod render;
pub mod sim;

use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::backend::Backend;
use tressfx_core::pass::{PassList, Ticket};

/// A wgpu backend, or `None` where there is no adapter and `TRESSFX_NO_GPU` says that this is known.
///
/// # Panics
/// If there is no adapter and nobody said so: a test must not pass because it did not run.
pub fn gpu() -> Option<WgpuBackend> {
    match WgpuBackend::headless() {
        Ok(backend) => Some(backend),
        Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => {
            eprintln!("skipped: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Runs a list and brings one read-back home.
///
/// # Panics
/// If the backend fails.
pub fn run_and_read(backend: &mut dyn Backend, list: &PassList, ticket: Ticket) -> Vec<u8> {
    backend.run(list).expect("the list runs");
    backend.read(ticket).expect("the list has run, so the bytes are there")
}
