//! The f64 function of the `Direct` solver with random strands that are left alone.

use glam::Vec4;
use rayon::prelude::*;
use tressfx_core::view::Pose;
use tressfx_sim::reference::Simulation;
use tressfx_sim::{SectionDesc, StepInput};
use tressfx_stress::case::{Case, Part, SolverName};
use tressfx_stress::energy::Ledger;
use tressfx_stress::judge::ENERGY;

/// Seeds that are tried.
const SEEDS: u64 = 2400;
/// Sub-steps of a case, at most.
const SUB_STEPS: usize = 300;
/// Edges shorter than this share of the longest one, but longer than 0, make joints so stiff that what a round leaves undone counts there.
const SHORTEST: f32 = 1e-2;

/// A case with sub-steps of this length, s, and all but no drag, which would hide what is gained; its joints want the pose of the file.
fn case(seed: u64, sub_step: f64) -> Option<Case> {
    let mut case = Case::new(seed, SolverName::Direct, Part { first: 0, strands: 3, frames: 0 }).unwrap();
    let lengths = &case.strands.rest_lengths;
    let longest = lengths.iter().copied().fold(0.0, f32::max);
    let is_even = lengths.iter().all(|&length| length == 0.0 || length > SHORTEST * longest);
    if !case.script.is_left_alone || case.script.own_roots || case.strands.vertices > 64 || !is_even {
        return None;
    }
    (case.params.air_drag, case.params.internal_damping, case.params.sag_free) = (0.05, 0.0, 0.0);
    // The least there may be, in every second one: soft twist is the hardest.
    if seed.is_multiple_of(2) {
        case.params.twist_ratio = 0.1;
    }
    (case.clock.sub_step, case.clock.max_frame) = (sub_step, 2.0 * sub_step);
    Some(case)
}

/// The most energy that a strand gains, of a fall by its length.
fn gained(case: &Case) -> f64 {
    let desc = SectionDesc::new(&case.strands, case.params.clone()).with_solver(case.solver.solver());
    let mut sim = Simulation::new(&[desc]).unwrap();
    sim.set_clock_params(case.clock).unwrap();
    let center = case.strands.guide_bounds().rounded_center();
    let ledger = Ledger::new(&case.strands, &case.params, case.solver, Pose::IDENTITY.rotation, center);
    let mut before: Vec<Vec4> = Vec::new();
    let mut most = 0.0_f64;
    sim.step(&StepInput::new(0.0, Pose::IDENTITY)).unwrap();
    for _ in 0..SUB_STEPS {
        let report = sim.step(&StepInput::new(case.clock.sub_step, Pose::IDENTITY)).unwrap();
        let after: Vec<_> = sim.positions(0).iter().map(|place| place.as_vec3().extend(1.0)).collect();
        if report.sub_steps == 1 && !before.is_empty() {
            most = most.max(ledger.most_gained(&before, &after, case.clock.sub_step));
        }
        before = after;
    }
    most
}

#[test]
fn strands_that_are_left_alone_gain_no_energy() {
    for sub_step in [0.1, 1.0 / 60.0, 1.0 / 120.0, 0.003, 1e-5] {
        let cases = (0..SEEDS).into_par_iter().filter_map(|seed| case(seed, sub_step));
        let found: Vec<_> = cases.map(|case| (case.seed, gained(&case))).collect();
        let wrong: Vec<_> = found.iter().filter(|(_, gained)| *gained > ENERGY).collect();
        println!("{sub_step} s: {} cases, {wrong:?}", found.len());
        assert!(found.len() > 200 && wrong.is_empty(), "{sub_step} s: {wrong:?}");
    }
}
