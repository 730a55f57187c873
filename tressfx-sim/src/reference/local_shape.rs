//! `hair.sim.local_shape` in f64.

use super::Guide;
use super::vector::{NO_LENGTH, position, rotate, turned};
use crate::step::Step;

/// Each edge is pulled towards the angle to the edge before it that it has in the rest pose; the first one to its root's.
pub fn local_shape(step: &Step, guide: &mut Guide, iterations: u32) {
    for _ in 0..iterations {
        constrain(step, guide);
    }
}

/// One iteration: each edge once, from the root to the tip.
fn constrain(step: &Step, guide: &mut Guide) {
    let mut frame = guide.root(step).rotation;
    for i in 0..guide.vertices() - 1 {
        let goal = rotate(frame, position(guide.rest[i + 1]) - position(guide.rest[i]));
        let (here, next) = (guide.inverse_mass(i), guide.inverse_mass(i + 1));
        if here + next > 0.0 {
            let edge = guide.positions[i + 1] - guide.positions[i];
            let correction = f64::from(step.local_stiffness) / (here + next) * (goal - edge);
            guide.positions[i] -= here * correction;
            guide.positions[i + 1] += next * correction;
        }
        let edge = guide.positions[i + 1] - guide.positions[i];
        if goal.length_squared().min(edge.length_squared()) > NO_LENGTH {
            frame = turned(frame, goal.normalize(), edge.normalize());
        }
    }
}
