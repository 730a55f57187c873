//! Rods that stand in the pose of their file under gravity.

use glam::{DMat3, DQuat, DVec3};

use super::joint::{Joint, Stiffness};
use super::rest::half;
use super::{RodRest, RodStep, outer};

/// A strand is made stiffer by powers of this factor until its pose is stable.
const STIFFER: f64 = 1.2;
/// A pose is stable enough if it is so with a strand that is less stiff by this factor. What is only just stable sways at the
/// least touch, and rounding is one.
const MARGIN: f64 = 1.5;
/// After this power nothing helps.
const LARGEST_POWER: i32 = 200;
/// What a joint wants is corrected at most so often.
const MOST_CORRECTIONS: u32 = 100;
/// No strain makes a torque that is larger than this times the bending stiffness; it is largest at an angle of 136 degrees.
const LARGEST_TORQUE: f64 = 5.4;
/// The longest correction of half of what a joint wants, rad,
const LONGEST_CORRECTION: f64 = 0.5;
/// and one that is so short that it brings nothing any more.
const SHORTEST_CORRECTION: f64 = 1e-9;

impl RodRest {
    /// Bends what the joints want so that their torques hold the pose of the file under `share` of gravity: with 1 the strand
    /// does not sag, with 0 the joints want the pose itself. Of `step` gravity, as the root's frame sees it, and the material
    /// count.
    ///
    /// Where the pose is no stable equilibrium, as of a long soft strand that stands upright, the strand is made stiffer until
    /// it is; [`RodRest::stiffening`] says by how much, and its cube root what the bending length is multiplied by. Where `share`
    /// is 0 nothing is made stiffer. Says whether the strand stands.
    pub fn stand(&mut self, step: &RodStep, share: f64) -> bool {
        self.stand_near(step, share, &mut 0)
    }

    /// The same, found sooner where `power` is near to the power of [`STIFFER`] that it needs, as that of a strand beside it mostly is. The
    /// power that it needed is left there.
    pub(crate) fn stand_near(&mut self, step: &RodStep, share: f64, power: &mut i32) -> bool {
        if share == 0.0 {
            return true;
        }
        let wanted = self.clone();
        let mut stands = |stiffening: f64| {
            *self = Self { stiffening, ..wanted.clone() };
            self.balance(step, share)
        };
        let stiffer = |power: i32| wanted.stiffening / MARGIN * STIFFER.powi(power);
        let Some(least) = least_power(*power, |power| stands(stiffer(power))) else {
            return false;
        };
        *power = least;
        stands((stiffer(least) * MARGIN).max(wanted.stiffening))
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

    /// Sets what a joint wants so that it gives this torque in the pose of the file, by Newton's method. A correction that makes
    /// nothing better is halved: there is no such joint beyond the strain at which torques are largest.
    fn want(&mut self, step: &RodStep, edge: usize, torque: DVec3) -> bool {
        let stiffness = self.stiffness(step, edge);
        if torque.length() > LARGEST_TORQUE * stiffness.bending * step.twist_ratio.max(1.0) {
            return false;
        }
        let (parent, child) = (self.parent(edge), self.frames[edge]);
        let allowed = 1e-12 * (stiffness.bending * step.twist_ratio.min(1.0)).max(torque.length());
        let mut best = half(parent.conjugate() * child);
        let (mut trial, mut correction, mut least) = (best, DVec3::ZERO, f64::INFINITY);
        for _ in 0..MOST_CORRECTIONS {
            let joint = Joint::new(parent, trial, child);
            let miss = joint.torque(&stiffness, DVec3::ZERO) - torque;
            let size = miss.length();
            if size < allowed {
                self.joints[edge] = trial;
                return true;
            }
            if size < least {
                (best, least) = (trial, size);
                let newton = joint.torque_by_half(trial, &stiffness).inverse() * -miss;
                correction = newton.clamp_length_max(LONGEST_CORRECTION);
            } else if correction.length() > SHORTEST_CORRECTION {
                correction *= 0.5;
            } else {
                return false;
            }
            // Half of a rotation by at most half a turn: the kernel knows no other.
            let corrected = best * DQuat::from_scaled_axis(correction);
            trial = half(corrected * corrected);
        }
        false
    }

    /// Whether every small rotation of the edges costs energy, where the joints hold the pose of the file under `share` of
    /// gravity: the second derivatives of the energy, a block for each edge and one
    /// for each pair of neighbours, are eliminated from the tip on, and all pivots have to be positive.
    ///
    /// A joint whose edges are turned together keeps its torque on its own axes, so that the derivative by the parent is the
    /// opposite of that by the child, up to a part without symmetry that those of gravity and of the next joint make up for.
    pub fn is_stable(&self, step: &RodStep, share: f64) -> bool {
        let mut weight = DVec3::ZERO;
        let mut beyond = DMat3::ZERO;
        for edge in (self.held..self.lengths.len()).rev() {
            weight += self.masses[edge + 1] * step.gravity * share;
            let along = self.frames[edge] * DVec3::Z;
            let hanging = self.lengths[edge] * (along.dot(weight) * DMat3::IDENTITY - outer(along, weight));
            let joint = Joint::new(self.parent(edge), self.joints[edge], self.frames[edge]);
            let mixed = joint.torque_by_child(&self.stiffness(step, edge));
            let pivot = symmetric(hanging - mixed) + beyond;
            if !is_positive(&pivot) {
                return false;
            }
            beyond = -symmetric(mixed + mixed * pivot.inverse() * mixed.transpose());
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
}

/// The least power of [`STIFFER`] at which a strand stands, where it stands at all larger ones too. It is looked for from `guess` on, in steps
/// that grow.
fn least_power(guess: i32, mut stands: impl FnMut(i32) -> bool) -> Option<i32> {
    let (mut falls, mut power) = (-1, LARGEST_POWER + 1);
    let (mut at, mut step) = (guess.clamp(0, LARGEST_POWER), 1);
    // Until the least one lies between one that was tried and another, or a limit.
    while falls < at && at < power {
        if stands(at) {
            (power, at) = (at, if falls < 0 { (at - step).max(0) } else { falls });
        } else {
            (falls, at) = (at, if power > LARGEST_POWER { (at + step).min(LARGEST_POWER) } else { power });
        }
        step *= 2;
    }
    while power - falls > 1 && power <= LARGEST_POWER {
        let middle = falls + (power - falls) / 2;
        if stands(middle) {
            power = middle;
        } else {
            falls = middle;
        }
    }
    (power <= LARGEST_POWER).then_some(power)
}

fn symmetric(m: DMat3) -> DMat3 {
    (m + m.transpose()) * 0.5
}

/// Whether a symmetric matrix is positive definite: its leading minors are positive (Sylvester).
fn is_positive(m: &DMat3) -> bool {
    let minor = m.x_axis.x * m.y_axis.y - m.y_axis.x * m.x_axis.y;
    m.x_axis.x > 0.0 && minor > 0.0 && m.determinant() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_power_is_found_from_any_guess() {
        for least in [0, 1, 2, 19, 20, 21, 199, LARGEST_POWER] {
            for guess in [-3, 0, 1, 18, 19, 20, 21, 22, 100, 199, LARGEST_POWER, LARGEST_POWER + 9] {
                let mut tried = 0;
                let found = least_power(guess, |power| {
                    tried += 1;
                    power >= least
                });
                assert_eq!(found, Some(least), "from {guess}");
                assert!(guess != least || tried <= 2, "{tried} for {least}");
                assert!(tried <= 17, "{tried} for {least} from {guess}");
            }
        }
        assert_eq!([0, 7, LARGEST_POWER].map(|guess| least_power(guess, |_| false)), [None; 3]);
    }
}
