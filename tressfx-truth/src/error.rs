//! What can be wrong with the input.

/// Why there is nothing to render.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TruthError {
    /// An array is not as long as the counts of its section say.
    #[error("section {section}: {found} {what}, its counts ask for {expected}")]
    Length {
        /// Which section.
        section: usize,
        /// What the array holds.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// A number is not finite, or is negative where it must not be.
    #[error("section {section}: {what} {index} is not finite, or negative")]
    Number {
        /// Which section.
        section: usize,
        /// What the array holds.
        what: &'static str,
        /// The place in the array.
        index: usize,
    },
    /// A pose does more than to turn and to move.
    #[error("section {section}: {error}")]
    Pose {
        /// Which section.
        section: usize,
        /// What is wrong with it, in words.
        error: String,
    },
    /// The depths are not one a pixel.
    #[error("{found} depths of the scene for {expected} pixels")]
    Depth {
        /// How many there are.
        found: usize,
        /// Pixels of the view.
        expected: usize,
    },
    /// Not every section has its light.
    #[error("the light of {found} sections for {expected}")]
    Sections {
        /// Sections with their light.
        found: usize,
        /// Sections of strands.
        expected: usize,
    },
    /// A light has no direction, or no place.
    #[error("light {0}: its direction is 0, or a number is not finite")]
    Light(usize),
    /// Radiance of the sky or of the ground that cannot be.
    #[error("the light of the sky or of the ground is not finite, or negative")]
    Sky,
    /// Fibres that are no distance apart.
    #[error("the spacing of fibres is not above 0, or not finite")]
    Spacing,
    /// A share is not from 0 to 1.
    #[error("section {section}: {what} is not from 0 to 1")]
    Share {
        /// Which section.
        section: usize,
        /// Which share.
        what: &'static str,
    },
    /// A mesh that has no triangles to it.
    #[error("mesh {mesh}: {what}")]
    Mesh {
        /// Which mesh.
        mesh: usize,
        /// What is wrong with it, in words.
        what: String,
    },
    /// All sections together have 2^32 vertices or more.
    #[error("{0} vertices, there may be less than 2^32")]
    TooMany(u64),
}
