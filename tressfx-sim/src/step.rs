//! What a kernel is told about a sub-step, and how SI parameters become shares and displacements of one.
//!
//! With `h` the length of the sub-step and `h0` = 1/60 s:
//!
//! * damping keeps `exp(-60 D h)` of the velocity;
//! * the shape constraints act through the Verlet integration as springs: what moves a vertex by a share `s` of its way in
//!   each step accelerates it by `s / h^2` of the way. So it is `s / h^2` that has to stay, and the share becomes
//!   `1 - (1 - s)^((h / h0)^2)`, which is that for small shares and never exceeds 1;
//! * the shock is a share of the head's motion, not of a time, and stays as it is: in any number of sub-steps the strands
//!   make the same share of the motion at once.

use glam::{Vec3, Vec4};
use tressfx_core::gpu_struct;
use tressfx_core::view::Pose;

use crate::clock::SubStep;
use crate::params::SimParams;
use crate::wind::Wind;

/// The length of the step for which TressFX states stiffness and damping, s.
pub const REFERENCE_STEP: f64 = 1.0 / 60.0;

gpu_struct! {
    /// What changes from sub-step to sub-step. Lengths in the unit of the file; shares and displacements are those of one
    /// sub-step.
    pub struct Step {
        /// Rotation from the rest pose to the world at the end of the sub-step, a unit quaternion.
        pub head_rotation: Vec4,
        /// The translation that goes with it.
        pub head_translation: Vec3,
        /// Share of the velocity that is kept.
        pub keep: f32,
        /// Rotation of the head during the sub-step, a unit quaternion.
        pub motion_rotation: Vec4,
        /// The translation that goes with it.
        pub motion_translation: Vec3,
        /// Share of the head's motion that the strands make at once.
        pub shock: f32,
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
        /// Half of the share of the way to the local shape in one iteration: each of the two vertices moves half.
        pub local_stiffness: f32,
        /// Coefficient of sliding friction.
        pub friction: f32,
        /// How much further a follow strand is from its guide at the tip.
        pub tip_separation: f32,
        /// Not 0: the strands go to their rest pose, at rest.
        pub reset: u32,
        /// Nothing.
        pub padding: [u32; 2],
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
    let ratio = length / REFERENCE_STEP;
    -((-f64::from(stiffness)).ln_1p() * ratio * ratio).exp_m1()
}

impl Step {
    /// The strands go to rest where the head is.
    pub fn reset(params: &SimParams, units: &Units, head: &Pose) -> Self {
        let still = SubStep {
            length: REFERENCE_STEP,
            length_ratio: 1.0,
            time: 0.0,
            head: *head,
            motion: Pose::IDENTITY,
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
            head_rotation: sub.head.rotation.into(),
            head_translation: sub.head.translation,
            keep: ((-60.0 * f64::from(params.damping) * sub.length).exp() * sub.length_ratio) as f32,
            motion_rotation: sub.motion.rotation.into(),
            motion_translation: sub.motion.translation,
            shock: if shocked { 1.0 } else { params.shock },
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
            local_stiffness: (0.5 * -((-local).ln_1p() / iterations).exp_m1()) as f32,
            friction: params.friction,
            tip_separation: params.tip_separation.unwrap_or(units.tip_separation),
            reset: 0,
            padding: [0; 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_shares_keep_the_spring_and_large_ones_stay_shares() {
        let spring = |stiffness, length: f64| spring_share(stiffness, length) / (length * length);
        for length in [1.0 / 60.0, 1.0 / 120.0, 1.0 / 240.0, 1.0 / 1000.0] {
            let relative = spring(0.01, length) / spring(0.01, REFERENCE_STEP);
            assert!((relative - 1.0).abs() < 0.006, "{relative}");
            assert_eq!(spring_share(0.0, length), 0.0);
            assert_eq!(spring_share(1.0, length), 1.0);
        }
        assert!((spring_share(0.4, REFERENCE_STEP) - 0.4).abs() < 1e-7);
        assert!(spring_share(0.9, 1.0) <= 1.0);
    }
}
