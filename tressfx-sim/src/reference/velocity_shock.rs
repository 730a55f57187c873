//! `hair.sim.velocity_shock` in f64.

use super::Guide;
use crate::step::Step;

/// Position and past make a share of the root's motion.
pub fn velocity_shock(step: &Step, guide: &mut Guide) {
    let (shock, root) = (f64::from(step.shock), guide.root(step));
    for i in (0..guide.vertices()).filter(|&i| guide.rest[i].w != 0.0) {
        for point in [&mut guide.positions[i], &mut guide.previous[i]] {
            let here = *point - step.shift.as_dvec3();
            *point = here + shock * (root.carried(*point) - here);
        }
    }
}
