//! A groom that is far away is simulated at a lower rate, by longer sub-steps: less work, about the same motion, no jump where the rate changes.

mod support;

use glam::Vec3;
use support::gpu;
use tressfx_conformance::sim::{Motion, Rig, builtin};
use tressfx_core::pass::PassList;
use tressfx_sim::{ClockParams, SimParams, Solver, StepInput};

const FPS: f64 = 60.0;
/// From these seconds on sub-steps are so long: every second and every fourth is simulated, then all again.
const RATES: [(f64, f64); 4] = [(0.0, 1.0 / 120.0), (1.0, 1.0 / 60.0), (2.0, 1.0 / 30.0), (3.0, 1.0 / 120.0)];

/// The tips in the world after each frame, and the sub-steps that it had.
fn tips(solver: Solver, rates: &[(f64, f64)]) -> Option<(Vec<Vec<Vec3>>, Vec<usize>)> {
    let strands = builtin("wavy", 60);
    let motion = Motion { turn: 0.4, ..Motion::still(&strands) };
    let mut rig = Rig::with_solver(gpu()?, strands.clone(), SimParams::default(), solver);
    let (mut frames, mut passes) = (Vec::new(), Vec::new());
    for frame in 0..=(4.0 * FPS) as u32 {
        let seconds = f64::from(frame) / FPS;
        if let Some((_, sub_step)) = rates.iter().find(|(from, _)| *from == seconds) {
            let clock = ClockParams { sub_step: *sub_step, ..ClockParams::default() };
            rig.run(|sim, _| sim.set_clock_params(clock)).unwrap();
        }
        let input: StepInput = motion.input(seconds, if frame == 0 { 0.0 } else { 1.0 / FPS });
        let mut list = PassList::new();
        rig.sim.step(&mut list, &input).unwrap();
        passes.push(list.labels().filter(|label| ["hair.sim.direct", "hair.sim.tressfx"].contains(label)).count());
        rig.backend.run(&list).unwrap();
        let world = rig.world(0);
        frames
            .push(world.chunks(strands.vertices as usize).map(|strand| strand[strand.len() - 1].truncate()).collect());
    }
    Some((frames, passes))
}

#[test]
fn a_lower_rate_is_less_work_and_about_the_same_motion() {
    for (solver, apart, jump) in [(Solver::Direct, 0.05, 1.5), (Solver::TressFx, 0.05, 1.5)] {
        let (Some((all, all_counts)), Some((few, few_counts))) = (tips(solver, &RATES[..1]), tips(solver, &RATES))
        else {
            return;
        };
        let strands = builtin("wavy", 60);
        let length: f32 = strands.rest_lengths.iter().sum::<f32>() / strands.guides as f32;
        let mean = |of: &dyn Fn(usize) -> f32| (0..all[0].len()).map(of).sum::<f32>() / all[0].len() as f32 / length;
        // How much the way of tips changes from frame to frame.
        let bend = |frames: &[Vec<Vec3>], frame: usize| {
            mean(&|tip| (frames[frame][tip] - 2.0 * frames[frame - 1][tip] + frames[frame - 2][tip]).length())
        };
        let usual = (60..all.len()).map(|frame| bend(&all, frame)).fold(0.0, f32::max);
        for (index, &(from, sub_step)) in RATES.iter().enumerate() {
            let first = (from * FPS) as usize;
            let until = RATES.get(index + 1).map_or(all.len(), |(next, _)| (next * FPS) as usize);
            let off = (first..until).map(|frame| mean(&|tip| all[frame][tip].distance(few[frame][tip])));
            let off = off.fold(0.0, f32::max);
            // With fewer sub-steps than frames hair stands still in every second frame.
            let is_even = sub_step <= 1.0 / FPS && first > 0;
            let change = (first + 2..first + 6).map(|frame| bend(&few, frame)).fold(0.0, f32::max);
            let sub_steps = |counts: &[usize]| counts[first + 2..until].iter().sum::<usize>() as f32;
            let share = sub_steps(&few_counts) / sub_steps(&all_counts);
            println!(
                "{solver:?}, from {from} s sub-steps of 1/{:.0} s: {share:.2} of the sub-steps, tips off by {:.2} % of length, at the change {:.2} of what is usual",
                1.0 / sub_step,
                100.0 * off,
                change / usual
            );
            assert!(off < apart && (!is_even || change < jump * usual), "{solver:?} {from}: {off} {change} {usual}");
            assert!((share - (1.0 / 120.0 / sub_step) as f32).abs() < 0.03, "{solver:?}: {share} of the sub-steps");
        }
    }
}
