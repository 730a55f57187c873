//! What a kernel is told about a sub-step, and how SI parameters become shares and displacements of one.
//!
//! With `h` the length of the sub-step and `h0` = 1/60 s:
//!
//! * damping keeps `exp(-60 D h)` of the velocity;
//! * a shape constraint that moves a vertex by a share `s` of the distance to its goal in each step is, behind the Verlet
//!   integration, a spring that is integrated implicitly, with `k / m = s / (1 - s) / h^2` (as in XPBD: Macklin, Mueller,
//!   Chentanez 2016). It is the spring that has to stay, so `s / (1 - s)` changes with `(h / h0)^2`;
//! * the shock is a share of the head's motion, not of a time, and stays as it is: in any number of sub-steps the strands
//!   make the same share of the motion at once. It is made before the integration, so that damping acts on what is left: with
//!   a shock of 1 on the velocity relative to the head, with 0 on that relative to the air.

use glam::{Quat, Vec3, Vec4};
use tressfx_core::gpu_struct;
use tressfx_core::strand_buffers::StrandShape;
use tressfx_core::strands::Strands;

use crate::bending_length::G;
use crate::clock::SubStep;
use crate::params::SimParams;
use crate::solver::Solver;
use crate::wind::Wind;

/// The length of the step for which TressFX states stiffness and damping, s.
pub const REFERENCE_STEP: f64 = 1.0 / 60.0;
/// A stiffer local shape counts as this, as in TressFX: short strands would flicker between two states.
pub(crate) const STIFFEST_LOCAL: f32 = 0.95;

/// No root is bent away from the straight line within a frame by more than this acceleration would bend it, m/s^2: one that jumps would
/// overshoot in the two frames behind.
const MOST_ROOT_ACCELERATION: f64 = 1000.0;

gpu_struct! {
    /// What changes from sub-step to sub-step. Lengths in the unit of the file; shares and displacements are those of one
    /// sub-step.
    pub struct Step {
        /// From the axes of the rest pose to those of the world: the rotation of the head at the end of the sub-step, a unit
        /// quaternion.
        pub head_rotation: Vec4,
        /// The rotation that the head made during the sub-step, a unit quaternion.
        pub head_turn: Vec4,
        /// The displacement of the centre of the groom, which moves with the head, during the sub-step. All positions are
        /// relative to that centre.
        pub center_displacement: Vec3,
        /// Share of the velocity that damping leaves.
        pub velocity_kept: f32,
        /// Displacement by gravity.
        pub gravity: Vec3,
        /// The longest displacement relative to the head.
        pub max_displacement: f32,
        /// Displacement by the wind from the four corners of its cone, across an edge; for [`Solver::Direct`] its velocity,
        /// units/s.
        pub wind: [Vec4; 4],
        /// How far roots are away from the straight line between where they are at the ends of the frame: that much of the way to its end, and
        /// of those to the starts of the last frame and of the one before it.
        pub root_bend: Vec3,
        /// The farthest that this may lead away from the line, units.
        pub root_slack: f32,
        /// Share of the distance to the global shape that a vertex is moved.
        pub global_stiffness: f32,
        /// Share of the strand's vertices, from the root, that the global shape reaches.
        pub global_range: f32,
        /// Share of the distance to the local shape that one iteration moves, by both vertices of an edge together; each makes half of
        /// it, if it is not pinned.
        pub local_stiffness: f32,
        /// Coefficient of sliding friction.
        pub friction: f32,
        /// How much further a follow strand is from its guide at the tip.
        pub tip_separation: f32,
        /// Share of the head's motion that the strands make at once.
        pub shock: f32,
        /// Not 0: the strands go to their rest pose, at rest.
        pub reset: u32,
        /// Guides of the section.
        pub guides: u32,
        /// Guides and follow strands of the section.
        pub strands: u32,
        /// Vertices of each strand.
        pub vertices: u32,
        /// The share of the frame that has passed at the end of the sub-step.
        pub root_share: f32,
        /// The first capsule that the section collides with.
        pub first_capsule: u32,
        /// The capsule after the last one.
        pub end_capsule: u32,
        /// Not 0: the past of a strand says nothing, since the sub-step before had another length.
        pub first_order: u32,
        /// Length of the sub-step, s.
        pub length: f32,
        /// Bending stiffness over the mass of unit length, units^4/s^2.
        pub bending: f32,
        /// Twist stiffness over bending stiffness.
        pub twist_ratio: f32,
        /// Time by which bending moments lag behind, s.
        pub internal_damping: f32,
        /// Rate at which still air stops hair that moves across itself, 1/s.
        pub drag_across: f32,
        /// The same along itself.
        pub drag_along: f32,
        /// Stiffness of the spring to the rest pose over mass, 1/s^2.
        pub pull: f32,
        /// The most rounds of Newton's method.
        pub rounds: u32,
        /// Which of the three places of a root is that at the start of the frame; those before it are the two before, in turns.
        pub root_place: u32,
        /// Nothing.
        pub padding: f32,
    }
}

/// What a step needs to know about a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionInfo {
    /// How many strands of how many vertices it has.
    pub shape: StrandShape,
    /// Metres that a unit of the file stands for.
    pub metres_per_unit: f32,
    /// The groom's own tip separation, where the parameters give none.
    pub tip_separation: f32,
    /// What solves its equations of motion.
    pub solver: Solver,
}

impl SectionInfo {
    /// That of a section of these strands, which this solver moves.
    pub fn new(strands: &Strands, solver: Solver) -> Self {
        Self {
            shape: StrandShape::of(strands),
            metres_per_unit: strands.metres_per_unit,
            tip_separation: strands.tip_separation,
            solver,
        }
    }
}

/// The share of the distance to its goal that a shape constraint moves a vertex in a sub-step of `length` seconds.
pub fn spring_share(stiffness: f32, length: f64) -> f64 {
    let (stiffness, ratio) = (f64::from(stiffness), length / REFERENCE_STEP);
    let spring = stiffness * ratio * ratio;
    spring / (1.0 - stiffness + spring)
}

/// Bending stiffness over the mass of unit length, units^4/s^2.
pub(crate) fn bending(params: &SimParams, metres_per_unit: f32) -> f64 {
    G * f64::from(params.bending_length).powi(3) / f64::from(metres_per_unit).powi(4)
}

impl Step {
    /// Resets the strands to the rest pose, on a head with this rotation.
    pub fn reset(params: &SimParams, info: &SectionInfo, rotation: Quat) -> Self {
        let still = SubStep::at_rest(REFERENCE_STEP, rotation);
        Self { reset: 1, ..Self::new(params, info, &still, None) }
    }

    /// The same, with the capsules that the section collides with.
    #[must_use]
    pub fn with_capsules(self, first: u32, end: u32) -> Self {
        Self { first_capsule: first, end_capsule: end, ..self }
    }

    /// The same, where this is the place of a root at the start of the frame.
    #[must_use]
    pub(crate) fn with_root_place(self, root_place: u32) -> Self {
        Self { root_place, ..self }
    }

    /// Converts the parameters of a section for a sub-step without capsules.
    pub fn new(params: &SimParams, info: &SectionInfo, sub: &SubStep, wind: Option<&Wind>) -> Self {
        let square = sub.length * sub.length;
        let metres = f64::from(info.metres_per_unit);
        let max_displacement = f64::from(params.max_speed) * sub.length / metres;
        let drag = f64::from(params.wind_drag) * square / metres;
        let blow = |corner: Vec3| match info.solver {
            Solver::TressFx => (corner.as_dvec3() * drag).clamp_length_max(max_displacement).as_vec3().extend(0.0),
            Solver::Direct => (corner.as_dvec3() / metres).as_vec3().extend(0.0),
        };
        let iterations = f64::from(params.local_iterations);
        let local = spring_share(params.local_stiffness.min(STIFFEST_LOCAL), sub.length);
        let shocked = sub.head_acceleration * info.metres_per_unit > params.shock_acceleration;
        Self {
            head_rotation: sub.head_rotation.into(),
            head_turn: sub.head_turn.into(),
            center_displacement: sub.center_displacement,
            velocity_kept: ((-60.0 * f64::from(params.damping) * sub.length).exp() * sub.length_ratio) as f32,
            gravity: (params.gravity.as_dvec3() * (square / metres)).as_vec3(),
            max_displacement: max_displacement as f32,
            wind: wind.map_or([Vec4::ZERO; 4], |wind| wind.corners(sub.time).map(blow)),
            root_bend: sub.roots.bend.as_vec3(),
            root_slack: (MOST_ROOT_ACCELERATION * sub.roots.frame * sub.roots.frame / 8.0 / metres) as f32,
            global_stiffness: if params.has_global_shape() {
                spring_share(params.global_stiffness, sub.length) as f32
            } else {
                0.0
            },
            global_range: params.global_range,
            // The iterations share the stiffness: n of them, one after the other, move a vertex as far as one would.
            local_stiffness: -((-local).ln_1p() / iterations).exp_m1() as f32,
            friction: params.friction,
            tip_separation: params.tip_separation.unwrap_or(info.tip_separation),
            shock: if shocked { 1.0 } else { params.shock },
            reset: 0,
            guides: info.shape.guides,
            strands: info.shape.strands(),
            vertices: info.shape.vertices,
            root_share: sub.roots.share as f32,
            first_capsule: 0,
            end_capsule: 0,
            first_order: u32::from((sub.length_ratio - 1.0).abs() > 1e-9),
            length: sub.length as f32,
            bending: bending(params, info.metres_per_unit) as f32,
            twist_ratio: params.twist_ratio,
            internal_damping: params.internal_damping,
            drag_across: params.air_drag,
            drag_along: params.air_drag * params.air_drag_along,
            pull: (std::f32::consts::TAU * params.pull_frequency).powi(2),
            rounds: params.rounds,
            root_place: 0,
            padding: 0.0,
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
