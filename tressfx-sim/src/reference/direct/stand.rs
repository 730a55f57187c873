//! Rods that stand in the pose of their file under gravity.

use glam::{DMat3, DQuat, DVec3};

use super::joint::{Joint, Stiffness};
use super::rest::half;
use super::{RodRest, RodStep};

/// A strand is made stiffer by this factor until its pose is stable.
const STIFFER: f64 = 1.2;
/// A pose is stable enough if it is so with a strand that is less stiff by this factor. What is only just stable sways at the
/// least touch, and rounding is one.
const MARGIN: f64 = 1.5;
/// After so many factors nothing helps.
const MOST_FACTORS: u32 = 200;
/// What a joint wants is corrected so often.
const MOST_CORRECTIONS: u32 = 500;
/// The longest correction of what a joint wants, rad.
const LONGEST_CORRECTION: f64 = 0.3;

impl RodRest {
    /// Bends what the joints want so that their torques hold the pose of the file under `share` of gravity: with 1 the strand
    /// does not sag, with 0 the joints want the pose itself. Of `step` gravity, as the root's frame sees it, and the material
    /// count.
    ///
    /// Where the pose is no stable equilibrium, as of a long soft strand that stands upright, the strand is made stiffer until
    /// it is; [`RodRest::stiffening`] says by how much, and its cube root what the bending length is multiplied by. Where `share`
    /// is 0 nothing is made stiffer. Says whether the strand stands.
    pub fn stand(&mut self, step: &RodStep, share: f64) -> bool {
        if share == 0.0 {
            return true;
        }
        let wanted = self.clone();
        let mut try_with = |stiffening: f64| {
            *self = Self { stiffening, ..wanted.clone() };
            self.balance(step, share)
        };
        let mut stiffening = wanted.stiffening / MARGIN;
        for _ in 0..MOST_FACTORS {
            if try_with(stiffening) {
                return try_with((stiffening * MARGIN).max(wanted.stiffening));
            }
            stiffening *= STIFFER;
        }
        false
    }

    /// Finds what the joints have to want; `false` where it is not found or the pose is not stable.
    fn balance(&mut self, step: &RodStep, share: f64) -> bool {
        let (mut torque, mut weight) = (DVec3::ZERO, DVec3::ZERO);
        for edge in (self.held..self.lengths.len()).rev() {
            weight += self.masses[edge + 1] * step.gravity * share;
            torque -= self.lengths[edge] * (self.frames[edge] * DVec3::Z).cross(weight);
            if !self.want(step, edge, torque) {
                return false;
            }
        }
        self.is_stable(step, share)
    }

    /// Sets what a joint wants so that it gives this torque in the pose of the file.
    fn want(&mut self, step: &RodStep, edge: usize, torque: DVec3) -> bool {
        let stiffness = self.stiffness(step, edge);
        let (parent, child) = (self.parent(edge), self.frames[edge]);
        let turn = parent.conjugate() * child;
        // What the joint wants is the turn of the pose after a correction.
        let joint = |correction: DVec3| half(turn * DQuat::from_scaled_axis(correction));
        let miss =
            |correction: DVec3| Joint::new(parent, joint(correction), child).torque(&stiffness, DVec3::ZERO) - torque;
        let scale = stiffness.bending * step.twist_ratio.min(1.0);
        let mut correction = DVec3::ZERO;
        for _ in 0..MOST_CORRECTIONS {
            let error = miss(correction);
            if error.length() < 1e-12 * scale.max(torque.length()) {
                self.joints[edge] = joint(correction);
                return true;
            }
            // On the axes of the child; the stiffness is never less than the true one, so that corrections fall short.
            let spring = Joint::new(parent, joint(correction), child).stiffness(&stiffness);
            correction -= (child.conjugate() * (spring.inverse() * error)).clamp_length_max(LONGEST_CORRECTION);
            if !correction.is_finite() {
                return false;
            }
        }
        false
    }

    /// Whether every small rotation of the edges costs energy, where the joints hold the pose of the file under `share` of
    /// gravity: the second derivatives of the energy, a block for each edge and one
    /// for each pair of neighbours, are eliminated from the tip on, and all pivots have to be positive.
    pub fn is_stable(&self, step: &RodStep, share: f64) -> bool {
        let (size, edges) = (1e-5, self.lengths.len());
        let mut weight = DVec3::ZERO;
        let mut beyond = DMat3::ZERO;
        for edge in (self.held..edges).rev() {
            weight += self.masses[edge + 1] * step.gravity * share;
            let turned = |axis: DVec3| DQuat::from_scaled_axis(size * axis) * self.frames[edge];
            // What the edge itself and its parent feel when it turns.
            let own = |axis: DVec3| {
                let frame = turned(axis);
                let mut torque = self.lengths[edge] * (frame * DVec3::Z).cross(weight);
                torque += self.torque(step, edge, self.parent(edge), frame);
                if edge + 1 < edges {
                    torque -= self.torque(step, edge + 1, frame, self.frames[edge + 1]);
                }
                torque
            };
            let on_parent = |axis: DVec3| -self.torque(step, edge, self.parent(edge), turned(axis));
            let pivot = symmetric(columns(|axis| (own(-axis) - own(axis)) / (2.0 * size))) - beyond;
            if !is_positive(&pivot) {
                return false;
            }
            let mixed = columns(|axis| (on_parent(-axis) - on_parent(axis)) / (2.0 * size));
            beyond = mixed * pivot.inverse() * mixed.transpose();
        }
        true
    }

    fn parent(&self, edge: usize) -> DQuat {
        if edge == 0 { DQuat::IDENTITY } else { self.frames[edge - 1] }
    }

    fn stiffness(&self, step: &RodStep, edge: usize) -> Stiffness {
        let bending = step.bending * self.stiffening / self.spans[edge];
        Stiffness { bending, twist_ratio: step.twist_ratio, lag: 0.0 }
    }

    fn torque(&self, step: &RodStep, edge: usize, parent: DQuat, child: DQuat) -> DVec3 {
        Joint::new(parent, self.joints[edge], child).torque(&self.stiffness(step, edge), DVec3::ZERO)
    }
}

fn columns(of: impl Fn(DVec3) -> DVec3) -> DMat3 {
    DMat3::from_cols(of(DVec3::X), of(DVec3::Y), of(DVec3::Z))
}

fn symmetric(m: DMat3) -> DMat3 {
    (m + m.transpose()) * 0.5
}

/// Whether a symmetric matrix is positive definite: its leading minors are positive (Sylvester).
fn is_positive(m: &DMat3) -> bool {
    let minor = m.x_axis.x * m.y_axis.y - m.y_axis.x * m.x_axis.y;
    m.x_axis.x > 0.0 && minor > 0.0 && m.determinant() > 0.0
}
