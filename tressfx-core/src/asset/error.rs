//! What is wrong with an asset.

use thiserror::Error;

/// An array or a value of an asset that does not fit: see [`super::HairAsset::check`].
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{asset}: {field}: {problem}")]
pub struct AssetError {
    /// The asset's name.
    pub asset: String,
    /// The array or count.
    pub field: String,
    /// What is wrong with it.
    pub problem: AssetProblem,
}

/// What is wrong with an array or a value.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AssetProblem {
    /// A number outside of what is allowed there.
    #[error("is {value}, but must be {expected}")]
    OutOfRange {
        /// The number.
        value: String,
        /// What would be allowed.
        expected: &'static str,
    },
    /// Two statements contradict each other.
    #[error("is {stated}, but {found} {of}")]
    Mismatch {
        /// What the field says.
        stated: u64,
        /// What there is.
        found: u64,
        /// What was counted.
        of: &'static str,
    },
    /// NaN or infinity in a strand.
    #[error("strand {strand}, vertex {vertex}: {value} is not a finite number")]
    NotFinite {
        /// Strand, from 0.
        strand: usize,
        /// Vertex in the strand, from 0; 0 in a value per strand.
        vertex: usize,
        /// The value.
        value: f32,
    },
}

impl AssetProblem {
    /// A number outside of what is allowed.
    pub fn out_of_range(value: impl ToString, expected: &'static str) -> Self {
        Self::OutOfRange { value: value.to_string(), expected }
    }
}
