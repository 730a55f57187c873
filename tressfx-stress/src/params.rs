//! Random parameters over their whole legal ranges.

use std::ops::RangeInclusive;

use glam::Vec3;
use tressfx_sim::{ClockParams, SimParams};

use crate::case::SolverName;
use crate::dice::Dice;

/// How often a parameter is at one of the ends of its range.
const AT_AN_END: f64 = 0.15;

/// Sub-steps of a frame, at most. What is legal allows a million, which would take hours.
pub const SUB_STEPS_A_FRAME: f64 = 64.0;

/// A number from its range, at its ends more often than by chance.
fn number(dice: Dice, name: &str, range: RangeInclusive<f64>, usual: f64) -> f64 {
    let mut rolls = dice.of(name);
    if rolls.chance(0.3) {
        return usual;
    }
    if rolls.chance(AT_AN_END) {
        return rolls.one_of(&[*range.start(), *range.end()]);
    }
    let spans_decades = *range.end() >= 50.0 * range.start().max(0.0);
    match (spans_decades, *range.start()) {
        (true, start) if start >= 0.0 && rolls.chance(0.7) => {
            rolls.decades(start.max(1e-5 * range.end())..=*range.end())
        }
        _ => rolls.even(range),
    }
}

fn whole(dice: Dice, name: &str, range: RangeInclusive<u32>, usual: u32) -> u32 {
    let mut rolls = dice.of(name);
    if rolls.chance(0.5) { usual } else { rolls.whole(range) }
}

/// A share from 0 to 1, as often near 1 as near 0.
fn share(dice: Dice, name: &str, usual: f32) -> f32 {
    let share = number(dice, name, 0.0..=1.0, usual.into());
    let is_usual = share == f64::from(usual);
    (if !is_usual && dice.of(name).chance(0.3) { 1.0 - share } else { share }) as f32
}

/// All parameters that a solver knows. One case in eight has those of [`SimParams::default`].
pub fn sim_params(dice: Dice, solver: SolverName) -> SimParams {
    let usual = SimParams::default();
    if dice.of("usual params").chance(0.125) {
        return usual;
    }
    let real = |name: &str, range: RangeInclusive<f64>, usual: f32| number(dice, name, range, usual.into()) as f32;
    let shared = SimParams {
        gravity: gravity(dice),
        tip_separation: Some(real("tip_separation", -1.0..=100.0, 0.0)).filter(|separation| *separation != 0.0),
        friction: share(dice, "friction", usual.friction),
        ..usual
    };
    match solver {
        SolverName::Direct => direct_params(dice, shared),
        SolverName::Tressfx => tressfx_params(dice, shared),
    }
}

fn tressfx_params(dice: Dice, usual: SimParams) -> SimParams {
    let real = |name: &str, range: RangeInclusive<f64>, usual: f32| number(dice, name, range, usual.into()) as f32;
    SimParams {
        damping: share(dice, "damping", usual.damping),
        local_stiffness: share(dice, "local_stiffness", usual.local_stiffness),
        local_iterations: whole(dice, "local_iterations", 1..=16, usual.local_iterations),
        global_stiffness: share(dice, "global_stiffness", usual.global_stiffness),
        global_range: share(dice, "global_range", usual.global_range),
        // A kernel is compiled for each number.
        length_iterations: dice.of("length_iterations").one_of(&[0, 1, usual.length_iterations, 16]),
        shock: share(dice, "shock", usual.shock),
        shock_acceleration: real("shock_acceleration", 0.0..=1e9, usual.shock_acceleration),
        max_speed: real("max_speed", 0.001..=1000.0, usual.max_speed),
        wind_drag: real("wind_drag", 0.0..=1000.0, usual.wind_drag),
        ..usual
    }
}

fn direct_params(dice: Dice, usual: SimParams) -> SimParams {
    let real = |name: &str, range: RangeInclusive<f64>, usual: f32| number(dice, name, range, usual.into()) as f32;
    SimParams {
        bending_length: real("bending_length", 0.002..=10.0, usual.bending_length),
        twist_ratio: real("twist_ratio", 0.1..=10.0, usual.twist_ratio),
        internal_damping: real("internal_damping", 0.0..=1.0, usual.internal_damping),
        air_drag: real("air_drag", 0.0..=1000.0, usual.air_drag),
        air_drag_along: real("air_drag_along", 0.25..=1.0, usual.air_drag_along),
        pull_frequency: real("pull_frequency", 0.0..=100.0, usual.pull_frequency),
        sag_free: share(dice, "sag_free", usual.sag_free),
        rounds: whole(dice, "rounds", 1..=8, usual.rounds),
        ..usual
    }
}

fn gravity(dice: Dice) -> Vec3 {
    let mut rolls = dice.of("gravity");
    let length = match rolls.whole(0..=7) {
        0 => 0.0,
        // Just below the limit: the length of a rounded vector may be above.
        1 => 999.9,
        2 | 3 => rolls.decades(1e-2..=999.9),
        _ => 9.81,
    };
    let direction = if rolls.chance(0.7) { Vec3::NEG_Y } else { rolls.direction() };
    direction * length as f32
}

/// How time is cut. A frame has at most as many sub-steps as `most`.
pub fn clock_params(dice: Dice, most: f64) -> ClockParams {
    let usual = ClockParams::default();
    if dice.of("usual clock").chance(0.3) {
        return usual;
    }
    let mut rolls = dice.of("sub_step");
    let sub_step = match rolls.whole(0..=9) {
        0 => 1e-5,
        1 => 0.1,
        2 | 3 => rolls.decades(1e-5..=0.1),
        _ => rolls.decades(1.0 / 2000.0..=1.0 / 30.0),
    };
    let max_frame = dice.of("max_frame").decades(sub_step..=(sub_step * most).min(10.0));
    let distance = number(dice, "teleport_distance", 1e-3..=1e3, usual.teleport_distance.into()) as f32;
    let angle = number(dice, "teleport_angle", 1e-3..=10.0, usual.teleport_angle.into()) as f32;
    let never = dice.of("never teleports").chance(0.2);
    ClockParams {
        sub_step,
        max_frame,
        teleport_distance: if never { f32::MAX } else { distance },
        teleport_angle: if never { f32::MAX } else { angle },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_of_them_are_legal_and_reach_the_ends_of_their_ranges() {
        let of = |solver| (0..2000).map(|seed| sim_params(Dice::new(seed), solver)).collect::<Vec<_>>();
        let (params, published) = (of(SolverName::Direct), of(SolverName::Tressfx));
        for (seed, params) in params.iter().chain(&published).enumerate() {
            params.validate().unwrap_or_else(|error| panic!("{seed}: {error}"));
            clock_params(Dice::new(seed as u64), SUB_STEPS_A_FRAME)
                .validate()
                .unwrap_or_else(|error| panic!("{seed}: {error}"));
        }
        let has = |of: &dyn Fn(&SimParams) -> f32, value: f32| params.iter().any(|params| of(params) == value);
        for value in [0.002, 10.0, 0.05] {
            assert!(has(&|params| params.bending_length, value), "{value}");
        }
        assert!(has(&|params| params.air_drag, 0.0) && has(&|params| params.rounds as f32, 8.0));
        assert!(has(&|params| params.gravity.length(), 0.0));
        assert!(published.iter().any(|params| params.local_stiffness == 1.0 && params.local_iterations == 16));
        let soft = params.iter().filter(|params| params.bending_length < 0.01).count();
        assert!(soft > 100, "{soft} of 2000 are softer than 1 cm");
    }
}
