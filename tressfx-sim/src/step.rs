//! What a kernel is told about a sub-step, and how SI parameters become shares and displacements of one.
//!
//! With `h` the length of the sub-step and `h0` = 1/60 s:
//!
//! * damping keeps `exp(-60 D h)` of the velocity;
//! * a shape constraint that moves a vertex by a share `s` of its way in each step is, behind the Verlet integration, a
//!   spring that is integrated implicitly, with `k / m = s / (1 - s) / h^2` (as in XPBD: Macklin, Mueller, Chentanez 2016).
//!   It is the spring that has to stay, so `s / (1 - s)` changes with `(h / h0)^2`;
//! * the shock is a share of the head's motion, not of a time, and stays as it is: in any number of sub-steps the strands
//!   make the same share of the motion at once.

use glam::{Quat, Vec3, Vec4};
use tressfx_core::gpu_struct;

use crate::clock::SubStep;
use crate::params::SimParams;
use crate::wind::Wind;

/// The length of the step for which TressFX states stiffness and damping, s.
pub const REFERENCE_STEP: f64 = 1.0 / 60.0;

gpu_struct! {
    /// What changes from sub-step to sub-step. Lengths in the unit of the file; shares and displacements are those of one
    /// sub-step.
    pub struct Step {
        /// From the axes of the rest pose to those of the world: the rotation of the head at the end of the sub-step, a unit
        /// quaternion.
        pub head_rotation: Vec4,
        /// The rotation that the head made during the sub-step, a unit quaternion.
        pub turn: Vec4,
        /// The way that the centre of the groom made with the head during the sub-step. All positions are about that centre.
        pub shift: Vec3,
        /// Share of the velocity that is kept.
        pub keep: f32,
        /// Displacement by gravity.
        pub gravity: Vec3,
        /// The longest displacement relative to the head.
        pub max_displacement: f32,
        /// Displacement by the wind from the four corners of its cone, across an edge.
        pub wind: [Vec4; 4],
        /// Share of the way to the global shape at the root.
        pub global_stiffness: f32,
        /// Share of the strand, from the root, that the global shape reaches.
        pub global_range: f32,
        /// Share of the way to the local shape in one iteration, by both vertices of an edge together.
        pub local_stiffness: f32,
        /// Coefficient of sliding friction.
        pub friction: f32,
        /// How much further a follow strand is from its guide at the tip.
        pub tip_separation: f32,
        /// Share of the head's motion that the strands make at once.
        pub shock: f32,
        /// Not 0: the strands go to their rest pose, at rest.
        pub reset: u32,
        /// Nothing.
        pub padding: u32,
    }
}

/// What a step needs to know about a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Metres that a unit of the file stands for.
    pub metres_per_unit: f32,
    /// The groom's own tip separation, where the parameters give none.
    pub tip_separation: f32,
}

/// The share of the way that a shape constraint moves a vertex in a step of `length` seconds.
pub fn spring_share(stiffness: f32, length: f64) -> f64 {
    let (stiffness, ratio) = (f64::from(stiffness), length / REFERENCE_STEP);
    let spring = stiffness * ratio * ratio;
    spring / (1.0 - stiffness + spring)
}

impl Step {
    /// The strands go to rest on a head that is turned so.
    pub fn reset(params: &SimParams, units: &Units, rotation: Quat) -> Self {
        let still = SubStep {
            length: REFERENCE_STEP,
            length_ratio: 1.0,
            time: 0.0,
            rotation,
            turn: Quat::IDENTITY,
            shift: Vec3::ZERO,
            acceleration: 0.0,
        };
        Self { reset: 1, ..Self::new(params, units, &still, None) }
    }

    /// Converts the parameters of a section for a sub-step.
    pub fn new(params: &SimParams, units: &Units, sub: &SubStep, wind: Option<&Wind>) -> Self {
        let square = sub.length * sub.length;
        let metres = f64::from(units.metres_per_unit);
        let max_displacement = f64::from(params.max_speed) * sub.length / metres;
        let drag = f64::from(params.wind_drag) * square / metres;
        let blow = |corner: Vec3| (corner.as_dvec3() * drag).clamp_length_max(max_displacement).as_vec3().extend(0.0);
        let iterations = f64::from(params.local_iterations);
        let local = spring_share(params.local_stiffness, sub.length);
        let shocked = sub.acceleration * units.metres_per_unit > params.shock_acceleration;
        Self {
            head_rotation: sub.rotation.into(),
            turn: sub.turn.into(),
            shift: sub.shift,
            keep: ((-60.0 * f64::from(params.damping) * sub.length).exp() * sub.length_ratio) as f32,
            gravity: (params.gravity.as_dvec3() * (square / metres)).as_vec3(),
            max_displacement: max_displacement as f32,
            wind: wind.map_or([Vec4::ZERO; 4], |wind| wind.corners(sub.time).map(blow)),
            global_stiffness: if params.has_global_shape() {
                spring_share(params.global_stiffness, sub.length) as f32
            } else {
                0.0
            },
            global_range: params.global_range,
            // The iterations share the stiffness: n of them, one after the other, make as much of the way as one would.
            local_stiffness: -((-local).ln_1p() / iterations).exp_m1() as f32,
            friction: params.friction,
            tip_separation: params.tip_separation.unwrap_or(units.tip_separation),
            shock: if shocked { 1.0 } else { params.shock },
            reset: 0,
            padding: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_stands_for_the_same_spring_at_any_length() {
        let spring = |share: f64, length: f64| share / (1.0 - share) / (length * length);
        for stiffness in [0.01, 0.4, 0.99] {
            let expected = spring(f64::from(stiffness), REFERENCE_STEP);
            for length in [0.1, 1.0 / 60.0, 1.0 / 240.0, 1.0 / 1000.0] {
                let share = spring_share(stiffness, length);
                assert!((spring(share, length) / expected - 1.0).abs() < 1e-9, "{stiffness} at {length}");
            }
        }
        assert_eq!([0.0, 1.0].map(|stiffness| spring_share(stiffness, 0.001)), [0.0, 1.0]);
    }
}
