//! `hair.sim.follow` in f64.

use glam::{DVec3, Vec4};

use super::roots::{GuideRoot, RootMotion};
use super::vector::{position, rotate};
use crate::step::Step;

/// The follow strand of a guide at an offset in the space of the rest pose. `root` is the guide's, if it has one of its own.
pub fn follow(step: &Step, guide: &[DVec3], offset: Vec4, root: Option<&GuideRoot>) -> Vec<DVec3> {
    let offset = rotate(RootMotion::new(step, root).rotation, position(offset));
    let last = (guide.len() - 1) as f64;
    let spread = |i: usize| 1.0 + f64::from(step.tip_separation) * i as f64 / last;
    guide.iter().enumerate().map(|(i, &point)| point + spread(i) * offset).collect()
}
