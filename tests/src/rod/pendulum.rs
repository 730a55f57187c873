//! The pendulum.

use std::f64::consts::{FRAC_PI_2, PI};

use super::G;

/// The complete elliptic integral of the first kind `K(k)` by the arithmetic-geometric mean: `K = pi / (2 M(1, k'))`
/// (Abramowitz and Stegun 17.6.3).
pub fn elliptic_k(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..10 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    PI / (2.0 * a)
}

/// The period of a mathematical pendulum of this length, released at rest at an angle from the vertical.
///
/// Energy gives `theta'^2 = 2 g / L (cos theta - cos theta_0)`; with `sin(theta / 2) = k sin(phi)`, `k = sin(theta_0 / 2)`,
/// the time of a quarter is `sqrt(L / g) K(k)`.
pub fn period(length: f64, amplitude: f64) -> f64 {
    4.0 * (length / G).sqrt() * elliptic_k((amplitude / 2.0).sin())
}

/// The angle of that pendulum at a time: `sin(theta / 2) = k sn(K - sqrt(g / L) t)`. The Jacobi function is computed by
/// descending Landen transformations (Abramowitz and Stegun 16.4).
pub fn angle(length: f64, amplitude: f64, time: f64) -> f64 {
    let k = (amplitude / 2.0).sin();
    let u = elliptic_k(k) - (G / length).sqrt() * time;
    2.0 * (k * sn(u, k)).asin()
}

fn sn(u: f64, k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    let mut ratios = Vec::new();
    for _ in 0..10 {
        let c = (a - b) / 2.0;
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
        ratios.push(c / a);
    }
    let mut phi = 2.0_f64.powi(ratios.len() as i32) * a * u;
    for ratio in ratios.iter().rev() {
        phi = (phi + (ratio * phi.sin()).clamp(-1.0, 1.0).asin()) / 2.0;
    }
    phi.sin()
}

/// The length of the mathematical pendulum that swings as a rigid rod hung at one end: its moment of inertia is
/// `m L^2 / 3` and its weight acts at `L / 2`.
pub fn of_rigid_rod(length: f64) -> f64 {
    2.0 / 3.0 * length
}

/// The period by quadrature: the integral of `dphi / sqrt(1 - k^2 sin^2 phi)`, by the midpoint rule, which converges
/// faster than any power for a periodic function.
pub fn period_by_quadrature(length: f64, amplitude: f64) -> f64 {
    let k = (amplitude / 2.0).sin();
    let parts = 2000;
    let at = |i: usize| (i as f64 + 0.5) / parts as f64 * FRAC_PI_2;
    let sum: f64 = (0..parts).map(|i| 1.0 / (1.0 - (k * at(i).sin()).powi(2)).sqrt()).sum();
    4.0 * (length / G).sqrt() * sum * FRAC_PI_2 / parts as f64
}
