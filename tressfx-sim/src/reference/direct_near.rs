//! `hair.sim.direct_near` in f64.

use super::direct::{Rod, RodRest, RodStep, direct};

/// One sub-step of a strand that may touch something. In f64 that is [`direct`] itself, which asks all strands for their contacts: the two kernels share the strands of a
/// section between them, and each strand moves as there.
pub fn direct_near(step: &RodStep, rest: &RodRest, rod: &mut Rod) {
    direct(step, rest, rod);
}
