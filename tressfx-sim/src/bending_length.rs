//! Bending lengths from what is known of a fibre, and from the stiffness of the published method.

use std::ops::RangeInclusive;

use crate::step::{REFERENCE_STEP, STIFFEST_LOCAL};

/// Acceleration by gravity that bending lengths are stated for, m/s^2.
pub(crate) const G: f64 = 9.81;
/// What a bending length may be, m.
pub(crate) const RANGE: RangeInclusive<f32> = 0.002..=10.0;

/// The bending length, m, of a round fibre: `(E d^2 / (16 rho g))^(1/3)`, from Young's modulus in Pa, the density in kg/m^3 and the
/// diameter in m. Hair has about 4 GPa and 1300 kg/m^3 (Robbins, Chemical and Physical Behavior of Human Hair, 5th edition, 2012).
///
/// A lock whose fibres are glued to each other bends as one fibre of the diameter of the lock.
pub fn of_fibre(modulus: f64, density: f64, diameter: f64) -> f64 {
    (modulus * diameter * diameter / (16.0 * density * G)).cbrt()
}

/// The bending length, m, at which a strand of `vertices` evenly spaced vertices and of `length` metres bends as the local shape
/// constraints of the published method let it, with steps of 1/60 s: what turns a
/// [`local_stiffness`](crate::SimParams::local_stiffness) of an asset into a
/// [`bending_length`](crate::SimParams::bending_length), within the range of that.
///
/// It was measured: strands of both solvers, whose first two vertices are pinned, were held horizontally under so little gravity that they
/// stay nearly straight, and the formula was fitted to what droops alike. From 3 to 32 vertices and for a stiffness from 0.1 to 0.95 it is within
/// 13 % of what was measured; above, nothing changes. It falls with one over the number of vertices, with which the published method gets softer.
/// Under the gravity of the Earth its strands stretch, and hang lower.
///
/// An asset that was made for another gravity looks alike under that of the Earth with `(9.81 / its gravity)^(1/3)` times as much.
pub fn of_local_stiffness(local_stiffness: f32, vertices: u32, length: f32) -> f32 {
    let share = 1.0 - (1.0 - f64::from(local_stiffness.clamp(0.0, STIFFEST_LOCAL))).sqrt();
    let (count, length) = (f64::from(vertices.max(2)), f64::from(length));
    // Bending stiffness over the mass of unit length, m^4/s^2.
    let bending = 0.38 * share / (1.0 - 0.8 * share) * length.powi(4) / count.powi(3) / REFERENCE_STEP.powi(2);
    ((bending / G).cbrt() as f32).clamp(*RANGE.start(), *RANGE.end())
}
