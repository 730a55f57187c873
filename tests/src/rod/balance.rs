//! Balances of forces in closed form.

use super::G;

/// The angle from the vertical at which a strand hangs in a steady horizontal wind, where the air drags it by
/// `drag` (1/s, across the strand, per mass) times the velocity of the wind past it.
///
/// Weight and drag are the same all along the strand, so it is straight; across it `g sin(angle) = drag * wind *
/// cos(angle)`. The drag along it only changes its tension.
pub fn wind_angle(drag: f64, wind: f64) -> f64 {
    (drag * wind / G).atan()
}

/// The angle of the slope above which a body slides (Coulomb): `tan(slope) = friction`.
pub fn sliding_slope(friction: f64) -> f64 {
    friction.atan()
}

/// The acceleration down a slope of a body that slides: `g (sin(slope) - friction cos(slope))`; 0 where it sticks.
pub fn sliding_acceleration(slope: f64, friction: f64) -> f64 {
    (G * (slope.sin() - friction * slope.cos())).max(0.0)
}
