//! Why strands cannot be made.

use thiserror::Error;

use crate::asset::AssetError;

/// Why strands cannot be made from an asset, or an asset from strands.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StrandsError {
    /// The asset contradicts itself.
    #[error(transparent)]
    Asset(#[from] AssetError),
    /// An option, or a hint in the header of the file, is out of range.
    #[error("{file}: option {option} is {value}, but must be {expected}")]
    Option {
        /// The asset.
        file: String,
        /// A field of [`super::StrandOptions`].
        option: &'static str,
        /// Its value.
        value: String,
        /// What would be allowed.
        expected: &'static str,
    },
    /// There are more vertices than a 32-bit index reaches.
    #[error("{file}: {strands} strands of {vertices} vertices are more than 2^32 - 1 vertices")]
    TooMany {
        /// The asset.
        file: String,
        /// Guides and follow strands.
        strands: u64,
        /// Vertices of each.
        vertices: u32,
    },
    /// The strand is so large that its lengths are not finite.
    #[error("{file}: strand {strand} is too large: its vertices or lengths overflow")]
    Overflow {
        /// The asset.
        file: String,
        /// The strand in the file, from 0.
        strand: u32,
    },
    /// A pose has the wrong number of positions.
    #[error("the pose has {found} positions, but {needed} are needed")]
    PoseLength {
        /// Positions given.
        found: usize,
        /// Positions needed.
        needed: usize,
    },
}
