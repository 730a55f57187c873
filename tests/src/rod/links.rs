//! A chain of rigid links in a plane, with springs at its joints: the motion of a thin rod where links are many.
//!
//! The unknowns are the angles `theta_i` of `n` equal links from the vertical down. With `mu_i` the mass beyond joint `i + 1` and
//! half of the link's own at each end, Lagrange's equations are
//! `sum_k l^2 mu_max(i,k) cos(theta_i - theta_k) theta_k'' = -sum_k l^2 mu_max(i,k) sin(theta_i - theta_k) theta_k'^2 - g l mu_i
//! sin(theta_i) + moments`, less `l^3 / 6` on the diagonal, since the mass of a link is spread along it and not at its ends. They
//! are integrated by the Runge-Kutta method; energy says how well.

use super::G;

/// A chain; each link has the mass of its length.
#[derive(Clone, Debug)]
pub struct Links {
    /// Length of a link, m.
    pub link: f64,
    /// Stiffness of a joint over the mass of a metre, m^3/s^2: `bending / link`. The first one is twice as stiff, since it has half
    /// a link on one side only.
    pub joint: f64,
    /// What the first link is clamped to, from the vertical down, rad; without effect where joints have no stiffness.
    pub clamp: f64,
    /// Angles of the links from the vertical down, rad.
    pub angles: Vec<f64>,
    /// Their rates, 1/s.
    pub rates: Vec<f64>,
}

impl Links {
    /// At rest, straight, at an angle from the vertical down. `bending` is `g * bending_length^3`, m^4/s^2.
    pub fn straight(length: f64, bending: f64, count: usize, angle: f64) -> Self {
        let link = length / count as f64;
        Self { link, joint: bending / link, clamp: angle, angles: vec![angle; count], rates: vec![0.0; count] }
    }

    /// The mass that hangs on the end of a link, half of the link's own included.
    fn beyond(&self, link: usize) -> f64 {
        self.link * ((self.angles.len() - link) as f64 - 0.5)
    }

    fn accelerations(&self, angles: &[f64], rates: &[f64]) -> Vec<f64> {
        let (n, square) = (angles.len(), self.link * self.link);
        let mut matrix = vec![0.0; n * n];
        let mut right = vec![0.0; n];
        for i in 0..n {
            right[i] = -G * self.link * self.beyond(i) * angles[i].sin() + self.moment(angles, i);
            for k in 0..n {
                let mass = square * self.beyond(i.max(k));
                let (sin, cos) = (angles[i] - angles[k]).sin_cos();
                matrix[i * n + k] = mass * cos;
                right[i] -= mass * sin * rates[k] * rates[k];
            }
            matrix[i * n + i] -= self.link.powi(3) / 6.0;
        }
        solve(&mut matrix, &mut right);
        right
    }

    fn moment(&self, angles: &[f64], link: usize) -> f64 {
        let first = if link == 0 { 2.0 * self.joint } else { self.joint };
        let before = if link == 0 { self.clamp } else { angles[link - 1] };
        let beyond = if link + 1 < angles.len() { self.joint * (angles[link + 1] - angles[link]) } else { 0.0 };
        beyond - first * (angles[link] - before)
    }

    /// Goes on for a time, in so many steps.
    pub fn run(&mut self, seconds: f64, steps: usize) {
        let h = seconds / steps as f64;
        let moved = |x: &[f64], by: &[f64], h: f64| x.iter().zip(by).map(|(x, by)| x + h * by).collect::<Vec<_>>();
        for _ in 0..steps {
            let (a, v) = (self.angles.clone(), self.rates.clone());
            let f1 = self.accelerations(&a, &v);
            let v2 = moved(&v, &f1, h / 2.0);
            let f2 = self.accelerations(&moved(&a, &v, h / 2.0), &v2);
            let v3 = moved(&v, &f2, h / 2.0);
            let f3 = self.accelerations(&moved(&a, &v2, h / 2.0), &v3);
            let v4 = moved(&v, &f3, h);
            let f4 = self.accelerations(&moved(&a, &v3, h), &v4);
            for i in 0..a.len() {
                self.angles[i] += h / 6.0 * (v[i] + 2.0 * (v2[i] + v3[i]) + v4[i]);
                self.rates[i] += h / 6.0 * (f1[i] + 2.0 * (f2[i] + f3[i]) + f4[i]);
            }
        }
    }

    /// Where the end of each link is: to the side, and up (negative below the root).
    pub fn places(&self) -> Vec<[f64; 2]> {
        let mut place = [0.0; 2];
        let next = |angle: &f64| {
            place = [place[0] + self.link * angle.sin(), place[1] - self.link * angle.cos()];
            place
        };
        self.angles.iter().map(next).collect()
    }

    /// Energy of motion, of height and of bending, over the mass of a metre.
    pub fn energy(&self) -> f64 {
        let n = self.angles.len();
        let mut energy = 0.0;
        for i in 0..n {
            energy -= G * self.link * self.beyond(i) * self.angles[i].cos();
            energy -= self.link.powi(3) / 12.0 * self.rates[i].powi(2);
            for k in 0..n {
                let mass = self.link.powi(2) * self.beyond(i.max(k));
                energy += 0.5 * mass * (self.angles[i] - self.angles[k]).cos() * self.rates[i] * self.rates[k];
            }
            let (before, stiffness) =
                if i == 0 { (self.clamp, 2.0 * self.joint) } else { (self.angles[i - 1], self.joint) };
            energy += 0.5 * stiffness * (self.angles[i] - before).powi(2);
        }
        energy
    }
}

/// Solves a symmetric positive definite system by Cholesky's method.
fn solve(matrix: &mut [f64], right: &mut [f64]) {
    let n = right.len();
    for i in 0..n {
        for k in 0..=i {
            let (row, other) = (&matrix[i * n..i * n + k], &matrix[k * n..k * n + k]);
            let sum: f64 = row.iter().zip(other).map(|(one, other)| one * other).sum();
            let rest = matrix[i * n + k] - sum;
            matrix[i * n + k] = if i == k { rest.sqrt() } else { rest / matrix[k * n + k] };
        }
        let known: f64 = (0..i).map(|k| matrix[i * n + k] * right[k]).sum();
        right[i] = (right[i] - known) / matrix[i * n + i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| matrix[k * n + i] * right[k]).sum();
        right[i] = (right[i] - known) / matrix[i * n + i];
    }
}
