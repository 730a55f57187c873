//! Loads above which a shape is no longer stable.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};

use super::kirchhoff::Kirchhoff;
use super::ode::{first_root, nearest_to_zero, root};

/// The length over the bending length above which an upright rod falls over by its own weight (Greenhill 1881).
///
/// A small angle `delta` from the vertical obeys `delta'' = -(L / Lb)^3 sigma delta`, with `sigma` from the free end, where
/// `delta' = 0`: `delta = sqrt(sigma) J_{-1/3}(2/3 (L / Lb)^(3/2) sigma^(3/2))`, which is 0 at the clamp. As a power series in
/// `z = (L / Lb)^3` the condition is `sum of (-z)^n / product of (3k - 1) 3k = 0`.
pub fn greenhill() -> f64 {
    let series = |z: f64| {
        let mut term = 1.0;
        let mut sum = 1.0;
        for k in 1..40 {
            let k = f64::from(k);
            term *= -z / ((3.0 * k - 1.0) * 3.0 * k);
            sum += term;
        }
        sum
    };
    root(series, 1.0, 20.0).cbrt()
}

/// The same from the moments of a Kirchhoff rod.
pub fn greenhill_by_shooting() -> f64 {
    let up = DQuat::IDENTITY;
    let stability = |ratio: f64| {
        let rod = Kirchhoff { steps: 400, ..Kirchhoff::straight(ratio, 1.0, -DVec3::Z) };
        rod.planar_stability(up, 1).expect("a straight rod stays straight")
    };
    first_root(stability, [0.5, 3.0], 20)
}

/// The force on the tip, over the mass of a metre, above which a rod without weight, clamped at its other end, buckles
/// (Euler): `B (pi / 2 L)^2`. `delta'' = -(force / B) delta` with `delta' = 0` at the tip and `delta = 0` at the clamp.
pub fn tip_load(bending: f64, length: f64) -> f64 {
    bending * (PI / (2.0 * length)).powi(2)
}

/// The twist from end to end, in radians, above which a closed ring of a straight rod leaves its plane (Michell 1889):
/// `2 pi sqrt(3) B / C`, with `C / B` the twist ratio.
pub fn michell(twist_ratio: f64) -> f64 {
    TAU * 3.0_f64.sqrt() / twist_ratio
}

/// The same from the moments of a Kirchhoff rod. A ring may leave its plane with its highest point anywhere: there are two
/// such shapes, so that the determinant touches 0 and does not change its sign.
pub fn michell_by_shooting(twist_ratio: f64) -> f64 {
    let ring = Kirchhoff { twist_ratio, steps: 600, ..Kirchhoff::straight(1.0, 1.0, DVec3::ZERO) };
    nearest_to_zero(|turn| ring.ring_stability(turn), [1.7 * PI / twist_ratio, 5.0 * PI / twist_ratio])
}

/// The length over the bending length above which a rod that is naturally an arc of `arc` radians, hung from a clamp that
/// points down, leaves its plane under its weight: bending turns into twist, and a hook becomes a curl (Miller, Lazarus, Audoly,
/// Reis 2014, Shapes of a suspended curly hair; the bend-twist test of Romero, Ly, Rasheed, Charrondiere, Lazarus, Neukirch,
/// Bertails-Descoubes 2021). Curves are our own: see [`Kirchhoff::planar_stability`].
pub fn bend_twist(arc: f64, twist_ratio: f64) -> f64 {
    let stability = |ratio: f64| {
        let rod = arched(ratio, arc, twist_ratio);
        rod.planar_stability(down(), 12).expect("the planar rod")
    };
    first_root(stability, [0.2, 4.2], 40)
}

/// The frame of a clamp that points down.
pub fn down() -> DQuat {
    DQuat::from_rotation_y(PI)
}

/// A rod of unit bending length under unit gravity that is naturally an arc in the plane of x and z.
pub fn arched(ratio: f64, arc: f64, twist_ratio: f64) -> Kirchhoff {
    let natural = DVec3::Y * (arc / ratio);
    Kirchhoff { natural, twist_ratio, steps: 600, ..Kirchhoff::straight(ratio, 1.0, -DVec3::Z) }
}
