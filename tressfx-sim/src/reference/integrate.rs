//! `hair.sim.integrate` in f64.

use glam::DVec3;

use super::Guide;
use super::roots::RootMotion;
use super::vector::position;
use crate::step::Step;

/// Velocity shock, Verlet integration with damping and gravity, and the pull towards the global shape; or back to the rest pose.
pub fn integrate(step: &Step, guide: &mut Guide) {
    let (last, root) = ((guide.vertices() - 1) as f64, guide.root(step));
    for i in 0..guide.vertices() {
        let shape = root.shape(position(guide.rest[i]));
        if step.reset != 0 || guide.is_pinned(i) {
            guide.positions[i] = shape;
            guide.previous[i] = shape;
            continue;
        }
        let (here, before) = (shocked(step, &root, guide.positions[i]), shocked(step, &root, guide.previous[i]));
        let mut goal = here
            + f64::from(step.velocity_kept) * bounded(step, &root, here - before, before)
            + step.gravity.as_dvec3();
        if step.global_stiffness > 0.0 {
            let along = i as f64 / last / f64::from(step.global_range);
            let fade = (1.0 - along * along).max(0.0);
            goal += f64::from(step.global_stiffness) * fade * (shape - goal);
        }
        guide.previous[i] = here;
        guide.positions[i] = goal;
    }
}

/// A point that has made its share of the root's motion.
fn shocked(step: &Step, root: &RootMotion, last: DVec3) -> DVec3 {
    let here = last - step.center_displacement.as_dvec3();
    here + f64::from(step.shock) * (root.carried(last) - here)
}

/// The displacement, no longer than allowed relative to the head, whose motion counts without the share of the shock.
fn bounded(step: &Step, root: &RootMotion, displacement: DVec3, before: DVec3) -> DVec3 {
    let remaining =
        (1.0 - f64::from(step.shock)) * (root.carried(before + step.center_displacement.as_dvec3()) - before);
    let relative = displacement - remaining;
    let longest = f64::from(step.max_displacement);
    if relative.length_squared() <= longest * longest {
        return displacement;
    }
    remaining + relative.normalize_or_zero() * longest
}
