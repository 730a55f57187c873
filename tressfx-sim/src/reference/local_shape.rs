//! `hair.sim.local_shape` in f64.

use glam::DVec3;

use super::Guide;
use super::vector::{NO_LENGTH, position, rotate, turn};
use crate::step::Step;

/// Each edge is pulled towards the angle to the edge before it that it has in the rest pose.
pub fn local_shape(step: &Step, guide: &mut Guide, iterations: u32) {
    for _ in 0..iterations {
        walk(step, guide);
    }
}

fn walk(step: &Step, guide: &mut Guide) {
    let edges: Vec<DVec3> =
        guide.rest.windows(2).map(|pair| rotate(step.head_rotation, position(pair[1]) - position(pair[0]))).collect();
    let mut directions = (DVec3::X, DVec3::X);
    for i in 1..guide.vertices() - 1 {
        let edge = guide.positions[i] - guide.positions[i - 1];
        if edges[i - 1].length_squared().min(edge.length_squared()) > NO_LENGTH {
            directions = (edges[i - 1].normalize(), edge.normalize());
        }
        let goal = guide.positions[i] + turn(directions.0, directions.1, edges[i]);
        let correction = f64::from(step.local_stiffness) * (goal - guide.positions[i + 1]);
        if !guide.is_pinned(i) {
            guide.positions[i] -= correction;
        }
        if !guide.is_pinned(i + 1) {
            guide.positions[i + 1] += correction;
        }
    }
}
