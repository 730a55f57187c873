//! What can go wrong in the simulation.

use crate::params::ParamError;

/// An error of the simulation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// A parameter is outside its range.
    #[error(transparent)]
    Param(#[from] ParamError),
    /// Something that a step was given is not a finite number.
    #[error("step: {name} is not finite")]
    NonFinite {
        /// What it is: `head`, `wind.velocity`...
        name: &'static str,
    },
    /// The backend could not make something.
    #[error(transparent)]
    Backend(#[from] tressfx_core::Error),
}
