//! `hair.sim.integrate` in f64.

use glam::DVec3;

use super::Guide;
use super::vector::position;
use crate::step::Step;

/// Verlet integration with damping and gravity, and the pull towards the global shape; or back to the rest pose.
pub fn integrate(step: &Step, guide: &mut Guide) {
    let last = (guide.vertices() - 1) as f64;
    for i in 0..guide.vertices() {
        let shape = step.in_world(position(guide.rest[i]));
        if step.reset != 0 || guide.is_pinned(i) {
            guide.positions[i] = shape;
            guide.previous[i] = shape;
            continue;
        }
        // Both are about where the centre was at the end of the last sub-step.
        let [here, before] = [guide.positions[i], guide.previous[i]].map(|point| point - step.shift.as_dvec3());
        let mut goal = here + f64::from(step.keep) * bounded(step, here - before, before) + step.gravity.as_dvec3();
        if step.global_stiffness > 0.0 {
            let along = i as f64 / last / f64::from(step.global_range);
            let fade = (1.0 - along * along).max(0.0);
            goal += f64::from(step.global_stiffness) * fade * (shape - goal);
        }
        guide.previous[i] = here;
        guide.positions[i] = goal;
    }
}

/// The displacement, no longer than allowed relative to the head.
fn bounded(step: &Step, displacement: DVec3, before: DVec3) -> DVec3 {
    let carried = step.carry(before) - before;
    let relative = displacement - carried;
    let longest = f64::from(step.max_displacement);
    if relative.length_squared() <= longest * longest {
        return displacement;
    }
    carried + relative.normalize_or_zero() * longest
}
