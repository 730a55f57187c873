//! What can go wrong on a GPU that the caller could not foresee.
//!
//! Mistakes of the program (a missing binding, a stale id) panic instead, with the label of the pass.

use crate::backend::Need;

/// The name of a resource or a pass: the same word in the source, the profiler and the tests.
pub type Label = &'static str;

/// An error of a backend or of a shader.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An allocation failed.
    #[error("{label}: the device has no memory left for {bytes} bytes")]
    OutOfMemory {
        /// The resource that was asked for.
        label: Label,
        /// Its size.
        bytes: u64,
    },
    /// The device is gone: everything on it must be made anew.
    #[error("the graphics device was lost: {reason}")]
    DeviceLost {
        /// What the driver said.
        reason: String,
    },
    /// The device cannot do what a technique needs.
    #[error("{label}: needs {need}, the device has {}", if *have == 0 { String::from("none") } else { have.to_string() })]
    Unsupported {
        /// The technique or resource.
        label: Label,
        /// What it needs.
        need: Need,
        /// What there is.
        have: u64,
    },
    /// A shader does not compose, parse or validate.
    #[error("{label}: {message}")]
    Shader {
        /// The kernel.
        label: Label,
        /// The compiler's message, with the place in the WGSL.
        message: String,
    },
    /// No adapter can be used.
    #[error("{message}")]
    NoAdapter {
        /// What was tried, and what to install.
        message: String,
    },
    /// The driver or the API refused something.
    #[error("{label}: {message}")]
    Backend {
        /// The resource or pass.
        label: Label,
        /// What was said.
        message: String,
    },
}

/// A result of the contract.
pub type Result<T, E = Error> = std::result::Result<T, E>;
