//! Parameters of a section, in SI units.

use std::ops::RangeInclusive;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::bending_length;

/// How the strands of a section move. Metres and seconds; converted to the unit of the file when uploaded.
///
/// The first three count for both solvers, those from `bending_length` to `rounds` for [`Solver::Direct`](crate::Solver::Direct), the others for
/// [`Solver::TressFx`](crate::Solver::TressFx).
///
/// Those of `Direct` are a material, which means the same with any number of vertices and any sub-step. Those of `TressFx` are given for a step
/// of 1/60 s, where TressFX puts them, and converted to the sub-step that is simulated ([`crate::step`]); its defaults hold a style under true
/// gravity as far as it can. TressFX's own samples get there with a hundredth of the gravity. It takes both shapes: the local one keeps
/// curls but, with a few iterations, cannot carry a strand of 32 vertices; the global one carries it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SimParams {
    /// Acceleration by gravity in world space, m/s^2; up to 1000 long.
    pub gravity: Vec3,
    /// Coefficient of Coulomb friction on capsules, from 0, which is ice, to 1.
    pub friction: f32,
    /// How much further than at the root a follow strand is from its guide at the tip: the offset of vertex `i` is multiplied
    /// by `1 + tip_separation * i / (vertices - 1)`. From -1 to 100; `None` keeps the groom's own.
    pub tip_separation: Option<f32>,
    /// Of [`Solver::Direct`](crate::Solver::Direct), as all up to `rounds`: the length, in metres, at which a strand starts to bend under its own weight,
    /// `(EI / (density * area * g))^(1/3)` with `g` = 9.81 m/s^2; 0.002 to 10. Held horizontally, a strand of this length droops by
    /// an eighth of it. Single hairs have 0.03 to 0.06, gelled ones 0.3 to 1: [`Preset`](crate::Preset) has some.
    pub bending_length: f32,
    /// Twist stiffness over bending stiffness, 0.1 to 10; real hair has about 0.75.
    pub twist_ratio: f32,
    /// The time, s, by which the moments of bending and twist lag behind, 0 to 1. A swing of circular frequency `w`
    /// that bending makes has the damping ratio `w * internal_damping / 2`.
    pub internal_damping: f32,
    /// The rate at which still air stops a strand that moves across itself, 1/s, 0 to 1000. A single hair has 20 to
    /// 40. It is measured against the air: hair in a wind never outruns it.
    pub air_drag: f32,
    /// The same for a strand that moves along itself, as a share of it, from 0.25 to 1. A slender cylinder has a
    /// half.
    pub air_drag_along: f32,
    /// The frequency, in Hz, of a spring that pulls each vertex to where the root carries its rest pose, 0 to 100.
    pub pull_frequency: f32,
    /// The share of gravity that the pose of the file is held against, from 0 to 1. With 1 hair does not sag. Where a
    /// pose is no stable equilibrium, the bending length of the strand is raised until it is ([`HairSim::standing`]). It is
    /// found for the material that the simulation is made with.
    ///
    /// [`HairSim::standing`]: crate::HairSim::standing
    pub sag_free: f32,
    /// The most rounds of Newton's method in a sub-step, 1 to 8. The second one follows only where a strand
    /// moves fast.
    pub rounds: u32,
    /// Of [`Solver::TressFx`](crate::Solver::TressFx), as all that follow: damping of the velocity, from 0 to 1. In a second it falls to exp(-60 * damping), as
    /// in TressFX 4.1, whose value is the default. [`SimParams::shock`] decides what the velocity is measured against: with a
    /// shock of 1 the head, with 0 the still air, through which a moving head then drags its hair; between them a share of both.
    pub damping: f32,
    /// How stiffly a strand keeps its bends and curls, from 0, which hangs like a chain, to 1, as stiff as the iterations
    /// allow. It is the share of the distance to its place that an edge moves in 1/60 s; what one sees is the stiffness of a
    /// spring, `s / (1 - s)`. As in TressFX, what is above 0.95 counts as 0.95 (short strands would flicker between two states), and
    /// a vertex moves by half of the share, even if its parent is pinned. It is no material: more vertices make strands softer,
    /// and curls may tremble.
    pub local_stiffness: f32,
    /// Iterations of the local shape constraints in each sub-step, 1 to 16. They share the stiffness.
    pub local_iterations: u32,
    /// How strongly a strand is pulled to where the head carries its rest pose, from 0 to 1: the share of the distance
    /// that is moved in 1/60 s.
    pub global_stiffness: f32,
    /// The share of the strand's vertices, from the root, that the global shape pulls, from 0 to 1.
    pub global_range: f32,
    /// Iterations of the length constraints in each sub-step, 0 to 16: each moves the ends of all even edges and then those of all
    /// odd ones to their lengths. With a few of them edges stretch.
    pub length_iterations: u32,
    /// Velocity shock propagation: the share of the head's motion that the strands make at once, from 0 to 1. On a head that
    /// moves evenly, hair hangs as at rest with 1, and trails with less. A smaller share leaves strands more of their own
    /// motion, and makes more of how evenly the head's poses come in.
    pub shock: f32,
    /// Above this acceleration of the head, m/s^2, anywhere in the groom's bounds, the strands make its whole motion at once.
    /// The default is above what a shaken head reaches.
    pub shock_acceleration: f32,
    /// Speed relative to the head that no vertex exceeds, m/s, 0.001 to 1000. Also bounds what the wind does in a sub-step.
    pub max_speed: f32,
    /// Acceleration, 1/s, that a wind of 1 m/s across a strand gives it; 0 to 1000.
    pub wind_drag: f32,
}

impl Default for SimParams {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            friction: 0.4,
            tip_separation: None,
            bending_length: 0.05,
            twist_ratio: 0.77,
            internal_damping: 0.0,
            air_drag: 20.0,
            air_drag_along: 0.5,
            pull_frequency: 0.0,
            sag_free: 1.0,
            rounds: 2,
            damping: 0.08,
            local_stiffness: 0.9,
            local_iterations: 2,
            global_stiffness: 0.2,
            global_range: 1.0,
            length_iterations: 2,
            shock: 0.75,
            shock_acceleration: 300.0,
            max_speed: 20.0,
            wind_drag: 3.0,
        }
    }
}

/// A parameter outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("parameter {name} = {value} must be {range}")]
pub struct ParamError {
    /// Its name.
    pub name: &'static str,
    /// What it was given.
    pub value: String,
    /// What it may be, in words.
    pub range: String,
}

/// Refuses what is outside a range, and what is not a number.
pub(crate) fn within<T: PartialOrd + std::fmt::Display>(
    name: &'static str,
    value: T,
    range: RangeInclusive<T>,
) -> Result<(), ParamError> {
    if range.contains(&value) {
        return Ok(());
    }
    let range = format!("from {} to {}", range.start(), range.end());
    Err(ParamError { name, value: value.to_string(), range })
}

impl SimParams {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn validate(&self) -> Result<(), ParamError> {
        within("gravity (its length)", self.gravity.length(), 0.0..=1000.0)?;
        within("friction", self.friction, 0.0..=1.0)?;
        within("tip_separation", self.tip_separation.unwrap_or(0.0), -1.0..=100.0)?;
        within("bending_length", self.bending_length, bending_length::RANGE)?;
        within("twist_ratio", self.twist_ratio, 0.1..=10.0)?;
        within("internal_damping", self.internal_damping, 0.0..=1.0)?;
        within("air_drag", self.air_drag, 0.0..=1000.0)?;
        within("air_drag_along", self.air_drag_along, 0.25..=1.0)?;
        within("pull_frequency", self.pull_frequency, 0.0..=100.0)?;
        within("sag_free", self.sag_free, 0.0..=1.0)?;
        within("rounds", self.rounds, 1..=8)?;
        within("damping", self.damping, 0.0..=1.0)?;
        within("local_stiffness", self.local_stiffness, 0.0..=1.0)?;
        within("local_iterations", self.local_iterations, 1..=16)?;
        within("global_stiffness", self.global_stiffness, 0.0..=1.0)?;
        within("global_range", self.global_range, 0.0..=1.0)?;
        within("length_iterations", self.length_iterations, 0..=16)?;
        within("shock", self.shock, 0.0..=1.0)?;
        within("shock_acceleration", self.shock_acceleration, 0.0..=1e9)?;
        within("max_speed", self.max_speed, 0.001..=1000.0)?;
        within("wind_drag", self.wind_drag, 0.0..=1000.0)
    }

    /// Whether the global shape pulls at all.
    pub fn has_global_shape(&self) -> bool {
        self.global_stiffness > 0.0 && self.global_range > 0.0
    }

    /// Iterations of the local shape constraints of strands of so many vertices; two vertices have no bends.
    pub(crate) fn local_iterations_of(&self, vertices: u32) -> u32 {
        if self.local_stiffness > 0.0 && vertices > 2 { self.local_iterations } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_valid() {
        SimParams::default().validate().unwrap();
    }

    #[test]
    fn a_parameter_outside_its_range_is_refused_by_name() {
        let error = SimParams { damping: 1.5, ..SimParams::default() }.validate().unwrap_err();
        assert_eq!(error.to_string(), "parameter damping = 1.5 must be from 0 to 1");
        let error = SimParams { local_iterations: 0, ..SimParams::default() }.validate().unwrap_err();
        assert_eq!(error.to_string(), "parameter local_iterations = 0 must be from 1 to 16");
        let error = SimParams { max_speed: f32::NAN, ..SimParams::default() }.validate().unwrap_err();
        assert_eq!(error.name, "max_speed");
        let gravity = Vec3::new(0.0, f32::INFINITY, 0.0);
        assert_eq!(SimParams { gravity, ..SimParams::default() }.validate().unwrap_err().value, "inf");
    }
}
