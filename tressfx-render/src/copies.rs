//! Copies of strands: hair that is thicker than what is simulated. A copy is its strand, moved aside; it has its colours, and no memory in the buffers of the strands.
//! Copies are numbered behind all strands, in their order, so that an even sample leaves them out first.

use glam::DVec3;
use tressfx_core::hash::hash;
use tressfx_core::strand_buffers::StrandShape;

/// The most strands that are drawn for one, itself among them.
pub(crate) const MAX_COPIES: u32 = 32;

/// What is drawn of a section: its copies count as follow strands.
pub(crate) fn drawn_shape(shape: StrandShape, copies: u32) -> StrandShape {
    StrandShape { follows: (1 + shape.follows) * copies.clamp(1, MAX_COPIES) - 1, ..shape }
}

/// How far a strand that is drawn is moved aside: the strands themselves not at all, copies to somewhere in a cube.
pub(crate) fn moved_aside(strands: u32, strand: u32, spread: f32) -> DVec3 {
    if strand < strands {
        return DVec3::ZERO;
    }
    let random = |axis: u32| 2.0 * hash(strand.wrapping_mul(3).wrapping_add(axis)) - 1.0;
    f64::from(spread) * DVec3::new(random(0), random(1), random(2))
}
