//! The f64 function of the `Direct` solver with strands, roots and states that nobody would make.

use glam::{DQuat, DVec3};
use tressfx_conformance::rod::G;
use tressfx_conformance::rod::strand::{self, energy};
use tressfx_conformance::sim::Random;
use tressfx_sim::reference::direct::{Rod, RodRest, RodStep, TipHold, direct};

const SUB_STEP: f64 = 0.002;

/// A rod of this rest whose free edges point anywhere.
fn anywhere(rest: &RodRest, random: &mut Random) -> Rod {
    let mut rod = Rod::at_rest(rest, DQuat::IDENTITY);
    for frame in &mut rod.frames[rest.held..] {
        *frame = DQuat::from_scaled_axis(3.0 * random.vector().as_dvec3()) * *frame;
    }
    rod.place(rest);
    rod
}

/// The highest speed, m/s, of the last of `sub_steps`, each of which moves the root by up to `jitter` on each axis.
fn speed(step: &RodStep, rest: &RodRest, sub_steps: u32, jitter: f64, random: &mut Random) -> f64 {
    let mut rod = anywhere(rest, random);
    for _ in 0..sub_steps {
        let root_displacement = jitter * random.vector().as_dvec3();
        direct(&RodStep { root_displacement, ..*step }, rest, &mut rod);
    }
    rod.displacements.iter().map(|moved| moved.length() / step.length).fold(0.0, f64::max)
}

/// A rod of a bending length of 10 m, in air that stops it within 2 ms.
fn stiff() -> RodStep<'static> {
    RodStep {
        length: SUB_STEP,
        bending: G * 1000.0,
        twist_ratio: 0.15,
        damping: 0.004,
        drag: [600.0, 300.0],
        pull: (std::f64::consts::TAU * 24.0).powi(2),
        ..RodStep::default()
    }
}

/// Points on a line, this far from each other.
fn line(lengths: &[f64]) -> RodRest {
    let mut points = vec![DVec3::ZERO];
    points.extend(lengths.iter().scan(0.0, |place, length| {
        *place += length;
        Some(*place * DVec3::new(0.36, 0.48, 0.8))
    }));
    RodRest::new(&points, 0)
}

#[test]
fn a_strand_that_folds_back_on_itself_rests_where_its_file_has_it() {
    let end = DVec3::new(0.142_132_189, 0.098_668_84, 0.030_148_327);
    for apart in [0.0, 1e-17, 1e-16, 1e-15, 1e-12, 1e-8, 1e-4] {
        let at = |i: u32| f64::from(i % 2) * end + apart * f64::from(i * i) * DVec3::new(0.3, -0.2, 0.1);
        let rest = RodRest::new(&(0..16).map(at).collect::<Vec<_>>(), 1);
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        let off = rod.positions.iter().zip(&rest.positions).map(|(place, rest)| place.distance(*rest));
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-9, "{apart:e}: vertices are off by {off:e} m");
        direct(&stiff(), &rest, &mut rod);
        let moved = rod.displacements.iter().map(|moved| moved.length()).fold(0.0, f64::max);
        assert!(moved < 1e-8, "{apart:e}: it moves by {moved:e} m");
    }
}

/// Rounding moves a root by a micrometre where the head is metres from the origin.
#[test]
fn a_root_that_trembles_by_the_length_of_its_edge_throws_no_strand_about() {
    let rest = line(&[4e-7, 4e-7, 0.4, 4e-7, 4e-7]);
    let mut random = Random::new(1);
    for jitter in [0.0, 1e-7, 2e-7, 5e-7, 1e-6, 1e-5] {
        let fastest = (0..20).map(|_| speed(&stiff(), &rest, 250, jitter, &mut random)).fold(0.0, f64::max);
        println!("root moved by {jitter:e} m: {fastest:e} m/s");
        assert!(fastest < 0.2, "{jitter:e} m: {fastest} m/s");
    }
}

#[test]
fn joints_that_are_damped_and_flip_over_come_to_rest() {
    let rest = line(&[0.08; 5]);
    let mut random = Random::new(2);
    for divided in [1.0, 8.0, 32.0] {
        let step = RodStep { length: SUB_STEP / divided, ..stiff() };
        let sub_steps = (0.25 / step.length) as u32;
        let fastest = (0..10).map(|_| speed(&step, &rest, sub_steps, 0.0, &mut random)).fold(0.0, f64::max);
        println!("{divided} times shorter: {fastest:e} m/s");
        assert!(fastest < 0.1, "{divided}: {fastest} m/s");
    }
}

/// The most energy that a strand gains within so many sub-steps from its rest on, of a fall by its length.
fn gained(step: &RodStep, rest: &RodRest, sub_steps: u32) -> f64 {
    let mut rod = Rod::at_rest(rest, step.root);
    let start = energy(step, rest, &rod);
    let mut most = 0.0_f64;
    for _ in 0..sub_steps {
        direct(step, rest, &mut rod);
        most = most.max(energy(step, rest, &rod) - start);
    }
    most / (G * rest.lengths.iter().sum::<f64>().powi(2))
}

/// Where twist is soft, rounds do not come to their end in a strand that bends far: an edge that rolls turns the bend of its neighbours.
#[test]
fn rounds_that_do_not_come_to_their_end_give_a_strand_no_energy() {
    for twist_ratio in [0.1, 0.2, 0.77] {
        for rate in [60.0, 120.0, 240.0] {
            for aside in [0.02, 0.1, 0.4] {
                // Its joints are bent to and fro, in a plane that leans.
                let side = |i: usize| DVec3::new(0.6, 0.8, 0.0) * aside * (i % 2) as f64;
                let at = |i: usize| 0.019 * (DVec3::new(0.0, -0.15, 1.0) * i as f64 + side(i));
                let rest = RodRest::new(&(0..8).map(at).collect::<Vec<_>>(), 0);
                let most = gained(&RodStep { twist_ratio, ..strand::step(1.0 / rate, 0.05) }, &rest, 2 * rate as u32);
                assert!(most < 1e-3, "twist ratio {twist_ratio}, 1/{rate} s, {aside} aside: {most}");
            }
        }
    }
}

#[test]
fn a_folded_strand_between_two_pins_gains_no_energy_in_short_sub_steps() {
    let at = |i: usize| f64::from(i as u32 % 2) * DVec3::new(-0.032_4, -0.001_4, -0.000_2);
    let rest = RodRest::new(&(0..8).map(at).collect::<Vec<_>>(), 1);
    let tip = Some(TipHold { place: rest.positions[7], frame: None });
    for length in [1e-5, 2e-5, 1e-4, 2.5e-4, 1e-3, 1.0 / 120.0] {
        let most = gained(&RodStep { tip, drag: [20.0, 10.0], ..strand::step(length, 0.05) }, &rest, 2000);
        assert!(most < 1e-6, "{length} s: {most}");
    }
}
