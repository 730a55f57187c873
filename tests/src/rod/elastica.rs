//! The heavy elastica: a rod clamped at one end, bent by its own weight in a plane.
//!
//! Let `sigma` be the arc length from the free end over the length `L`, and `delta` the angle between the rod and the
//! vertical. The part beyond weighs `sigma`, so the balance of moments `EI delta'' = weight * sin(delta)` is
//! `delta'' = (L / Lb)^3 sigma sin(delta)` (Wang 1986, A critical review of the heavy elastica). At the free end
//! `delta' = 0`, at the clamp `delta` is given.

use std::f64::consts::FRAC_PI_2;

use super::ode::{integrate, root};

const STEPS: usize = 6000;

/// Where the tip is from a horizontal clamp, as a share of the length: along the clamp, and up (it is negative).
/// `ratio` is the length over the bending length, up to 40.
///
/// It is shot from the free end. There `delta` may be as small as `exp(-2/3 ratio^(3/2))`, so its logarithm is sought.
/// As long as `delta` stays below a right angle it grows with its start; beyond, the moment is that at a right angle, so that
/// it goes on growing and there is one root.
pub fn tip(ratio: f64) -> [f64; 2] {
    let miss = |logarithm: f64| shot(ratio, logarithm.exp())[0] - FRAC_PI_2;
    let [_, _, along, down] = shot(ratio, root(miss, -600.0, FRAC_PI_2.ln()).exp());
    [along, -down]
}

/// Angle and its derivative at the clamp, and the tip from it: along and down.
fn shot(ratio: f64, at_tip: f64) -> [f64; 4] {
    let cubed = ratio.powi(3);
    let slope = |sigma: f64, y: &[f64; 4]| [y[1], cubed * sigma * y[0].min(FRAC_PI_2).sin(), y[0].sin(), y[0].cos()];
    integrate(slope, [at_tip, 0.0, 0.0, 0.0], [0.0, 1.0], STEPS)
}

/// The droop of the tip in the theory of small deflections: `weight L^4 / (8 EI)`.
pub fn small_droop(ratio: f64) -> f64 {
    ratio.powi(3) / 8.0
}

/// How far from the clamp a soft rod hangs: all bending is near the clamp, where the whole weight `g L` pulls, so that
/// `EI delta'^2 / 2 = g L (1 - cos delta)` and `x` is the integral of `sin(delta) / delta'`, `sqrt(2) (L / Lb)^(-3/2)`.
pub fn soft_reach(ratio: f64) -> f64 {
    2.0_f64.sqrt() * ratio.powf(-1.5)
}
