//! Small swings of a hanging chain (Daniel Bernoulli 1733; Lamb, Higher Mechanics).
//!
//! At the height `z` over the free end the tension is `g z`, so that `y_tt = (g z y_z)_z`. With `z = g u^2 / 4` this is
//! Bessel's equation of order 0: `y = J0(2 omega sqrt(z / g)) cos(omega t)`. The support at `z = L` does not move:
//! `2 omega sqrt(L / g)` is a zero of `J0`.

use std::f64::consts::PI;

use super::G;
use super::ode::root;

/// The Bessel function `J0` by its power series: the sum of `(-x^2 / 4)^n / n!^2`. Good to 1e-10 for `x` below 15.
pub fn j0(x: f64) -> f64 {
    let mut term = 1.0;
    let mut sum = 1.0;
    for n in 1..60 {
        term *= -x * x / 4.0 / (n * n) as f64;
        sum += term;
    }
    sum
}

/// The zero of `J0` of this number, from 1. Each lies between `(n - 1/2) pi` and `n pi`.
pub fn zero_of_j0(number: usize) -> f64 {
    let n = number as f64;
    root(j0, (n - 0.5) * PI, n * PI)
}

/// The same by McMahon's expansion for large zeros (Abramowitz and Stegun 9.5.12).
pub fn zero_by_expansion(number: usize) -> f64 {
    let b = (number as f64 - 0.25) * PI;
    let x = 1.0 / (8.0 * b);
    b + x - 4.0 * 31.0 / 3.0 * x.powi(3) + 32.0 * 3779.0 / 15.0 * x.powi(5)
}

/// The circular frequency of a mode, 1/s; `mode` from 1.
pub fn frequency(length: f64, mode: usize) -> f64 {
    zero_of_j0(mode) / 2.0 * (G / length).sqrt()
}

/// The shape of a mode at a distance from the support, both as shares of the length: 1 at the tip.
pub fn shape(mode: usize, from_root: f64) -> f64 {
    j0(zero_of_j0(mode) * (1.0 - from_root).max(0.0).sqrt())
}
