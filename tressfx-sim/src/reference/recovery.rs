//! `hair.sim.recovery` in f64.

use super::Guide;
use super::vector::position;
use crate::step::Step;

/// A strand that has become non-finite goes back to its rest pose, at rest. Says whether it had.
pub fn recovery(step: &Step, guide: &mut Guide) -> bool {
    let finite = guide.positions.iter().all(|point| point.is_finite());
    let root = guide.root(step);
    for i in (0..guide.vertices()).filter(|_| !finite) {
        guide.positions[i] = root.shape(position(guide.rest[i]));
        guide.previous[i] = guide.positions[i];
    }
    !finite
}
