//! `hair.sim.follow` in f64.

use glam::{DVec3, Vec4};

use super::vector::{position, rotate};
use crate::step::Step;

/// The follow strand of a guide at an offset in the space of the rest pose.
pub fn follow(step: &Step, guide: &[DVec3], offset: Vec4) -> Vec<DVec3> {
    let offset = rotate(step.head_rotation.as_dvec4(), position(offset));
    let last = (guide.len() - 1) as f64;
    let spread = |i: usize| 1.0 + f64::from(step.tip_separation) * i as f64 / last;
    guide.iter().enumerate().map(|(i, &point)| point + spread(i) * offset).collect()
}
