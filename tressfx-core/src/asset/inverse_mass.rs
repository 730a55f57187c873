//! The inverse masses that an asset stands for.

use std::borrow::Cow;

use super::HairAsset;

impl HairAsset {
    /// Inverse mass per vertex: the file's, or else the TressFX 3 convention: the first two vertices of a strand are
    /// pinned, which fixes its root and the direction there, and the last two as well where both ends are immovable.
    /// A strand of two vertices is pinned at its root alone, so that it can move.
    pub fn inverse_masses(&self) -> Cow<'_, [f32]> {
        if let Some(inverse_mass) = &self.inverse_mass {
            return inverse_mass.as_slice().into();
        }
        let mut masses = vec![1.0; self.points.len()];
        for range in self.ranges() {
            let Some(strand) = masses.get_mut(range) else { break };
            let length = strand.len();
            let pinned = match length {
                0 => 0,
                1 | 2 => 1,
                _ => 2,
            };
            strand[..pinned].fill(0.0);
            if self.both_ends_immovable {
                strand[length - pinned..].fill(0.0);
            }
        }
        masses.into()
    }
}
