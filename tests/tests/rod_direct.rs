//! The f64 function of the `Direct` solver against what thin rods are known to do.

use std::f64::consts::FRAC_PI_2;

use glam::{DQuat, DVec3};
use tressfx_conformance::rod::links::Links;
use tressfx_conformance::rod::strand::{LENGTH, energy, line, run, settled, step, tip};
use tressfx_conformance::rod::{G, chain, experiment, pendulum, threshold};
use tressfx_sim::reference::direct::{Rod, RodRest, RodStep, direct};

/// Of a chain of edges: as good as none.
const NO_BENDING: f64 = 1e-4;
/// The sub-step that frames are cut into by default, s.
const SUB_STEP: f64 = 1.0 / 120.0;

#[test]
fn tips_are_where_the_heavy_elastica_has_them() {
    for (vertices, allowed) in [(8, 0.03), (16, 0.015), (32, 0.0075), (64, 0.005)] {
        let mut worst = (0.0, 0.0);
        for ratio in [0.1, 0.3, 1.0, 2.0, 3.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0] {
            let error = experiment::elastica_error(vertices, ratio);
            worst = if error > worst.0 { (error, ratio) } else { worst };
        }
        println!("{vertices} vertices: the tip is off by {:.2} % of length at L / Lb = {}", 100.0 * worst.0, worst.1);
        assert!(worst.0 < allowed, "{vertices} vertices: {worst:?}");
    }
}

#[test]
fn neither_sub_steps_nor_rounds_change_the_droop() {
    let rest = line(16, DVec3::X);
    for ratio in [0.3, 3.0, 30.0] {
        let rest_at = |length: f64, rounds: u32| {
            let step = RodStep { rounds, ..step(length, LENGTH / ratio) };
            tip(&settled(&step, &rest, 4.0))
        };
        let first = rest_at(1.0 / 60.0, 2);
        for (length, rounds) in [(1.0 / 60.0, 1), (1.0 / 60.0, 6), (1.0 / 240.0, 2), (1.0 / 1000.0, 1)] {
            let apart = first.distance(rest_at(length, rounds)) / LENGTH;
            assert!(apart < 1e-5, "L / Lb = {ratio}, {length} s, {rounds} rounds: {apart:e}");
        }
    }
}

#[test]
fn a_hanging_strand_swings_in_the_modes_of_the_bessel_function() {
    for vertices in [8, 16, 32, 64] {
        for (number, allowed) in [(1, 0.01), (2, 0.02), (3, 0.035)] {
            let (frequency, damping) = experiment::mode(vertices, number, SUB_STEP);
            let error = frequency / chain::frequency(LENGTH, number) - 1.0;
            println!("{vertices} vertices, mode {number}: {:+.2} %, damping ratio {damping:.4}", 100.0 * error);
            assert!(error.abs() < allowed && damping.abs() < 0.01, "{vertices}, {number}: {error} {damping}");
        }
    }
}

#[test]
fn one_edge_is_a_pendulum() {
    let rest = line(2, DVec3::X);
    let length = pendulum::of_rigid_rod(LENGTH);
    let error = |sub_step: f64| {
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        run(&step(sub_step, NO_BENDING), &rest, &mut rod, 0.6);
        let expected = pendulum::angle(length, FRAC_PI_2, 0.6);
        let at = tip(&rod) / LENGTH;
        (at.x.atan2(-at.y) - expected).abs()
    };
    let errors = [120.0, 240.0, 480.0].map(|rate| error(1.0 / rate));
    println!("angle after 0.6 s is off by {errors:.6?} rad");
    assert!(errors[0] < 0.025 && errors[0] / errors[1] > 3.0 && errors[1] / errors[2] > 3.0, "{errors:?}");
}

/// Hair that hangs under a head that turns to and fro rolls about itself; where the guess rolls with it, a round is enough.
#[test]
fn the_guess_rolls_with_hair_that_hangs() {
    let rest = line(32, DVec3::NEG_Y);
    let yaw = |seconds: f64| DQuat::from_rotation_y((std::f64::consts::TAU * seconds).sin());
    // The root is off the axis, so that the tip swings.
    let place = |seconds: f64| yaw(seconds) * DVec3::new(0.05, 0.0, 0.0);
    let play = |sub_step: f64, rolls: bool| {
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        let sub_steps = (1.0 / sub_step).round() as u32;
        let rounds = |i: u32| {
            let [before, now] = [i - 1, i].map(|i| f64::from(i) * sub_step);
            let root_displacement = place(now) - place(before);
            if !rolls {
                rod.rolls.fill(0.0);
            }
            direct(&RodStep { root: yaw(now), root_displacement, ..step(sub_step, 0.02) }, &rest, &mut rod)
        };
        let rounds: u32 = (1..=sub_steps).map(rounds).sum();
        (f64::from(rounds) / f64::from(sub_steps), tip(&rod))
    };
    let (_, exact) = play(SUB_STEP / 16.0, true);
    let runs = [true, false].map(|rolls| play(SUB_STEP, rolls));
    let [rolled, aimed] = runs.map(|(rounds, tip)| (rounds, tip.distance(exact) / LENGTH));
    println!("rounds a sub-step, and tips off by so much of length: {rolled:.4?} rolled, {aimed:.4?} not");
    assert!(rolled.0 < 1.2 && aimed.0 > 1.6, "{rolled:?} {aimed:?}");
    assert!(rolled.1 < 0.05 && rolled.1 < 1.5 * aimed.1, "{rolled:?} {aimed:?}");
}

/// Released from the horizontal, with a bending length of 1 cm.
fn released(vertices: usize, sub_step: f64, seconds: f64, mut each: impl FnMut(&RodStep, &RodRest, &Rod)) -> DVec3 {
    let (rest, step) = (line(vertices, DVec3::X), step(sub_step, 0.01));
    let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
    for _ in 0..(seconds / sub_step).round() as usize {
        direct(&step, &rest, &mut rod);
        each(&step, &rest, &rod);
    }
    tip(&rod)
}

#[test]
fn a_released_strand_falls_as_many_links_do() {
    let mut links = Links::straight(LENGTH, G * 1e-6, 48, FRAC_PI_2);
    links.run(0.3, 2000);
    let [x, y] = links.places()[47];
    for vertices in [8, 16, 32, 64] {
        let error =
            |rate: f64| released(vertices, 1.0 / rate, 0.3, |_, _, _| ()).distance(DVec3::new(x, y, 0.0)) / LENGTH;
        let errors = [60.0, 120.0, 240.0].map(error);
        println!("{vertices} vertices: the tip is off by {errors:.4?} of length at 60, 120, 240 sub-steps a second");
        assert!(errors[1] < 0.05, "{vertices}: {errors:?}");
    }
}

#[test]
fn errors_fall_with_the_square_of_the_sub_step() {
    let exact = released(16, 1.0 / 15360.0, 0.1, |_, _, _| ());
    let rates = [60.0, 120.0, 240.0, 480.0, 960.0, 1920.0];
    let errors = rates.map(|rate| released(16, 1.0 / rate, 0.1, |_, _, _| ()).distance(exact) / LENGTH);
    println!("off by {errors:.7?} of length at {rates:?} sub-steps a second");
    for (rate, pair) in rates.iter().zip(errors.windows(2)) {
        assert!(pair[0] / pair[1] > 3.0, "from {rate} on: {errors:?}");
    }
    // Single steps of the ladder are higher or lower by chance.
    let halved = (errors[0] / errors[5]).powf(0.2);
    assert!(halved > 3.6, "an average step divides them by {halved}: {errors:?}");
}

#[test]
fn energy_never_grows_above_its_start() {
    for vertices in [2, 5, 8, 32] {
        for rate in [30.0, 60.0, 120.0, 240.0, 500.0, 1000.0, 1920.0, 7680.0] {
            // The start has the energy 0; what it can lose is its height.
            let mut most = f64::MIN;
            let highest = |step: &RodStep, rest: &RodRest, rod: &Rod| most = most.max(energy(step, rest, rod));
            released(vertices, 1.0 / rate, 1.5, highest);
            let share = most / (G * LENGTH * LENGTH / 2.0);
            assert!(share <= 0.0, "{vertices} vertices, 1 / {rate} s: {share}");
        }
    }
}

#[test]
fn a_helix_lengthens_as_a_kirchhoff_rod() {
    let known = experiment::known_helix();
    println!("Kirchhoff: {:.2} % longer, tip at {}", 100.0 * (known.longer - 1.0), known.tip);
    for (vertices, allowed) in [(48, 0.02), (96, 0.01), (192, 0.01)] {
        let found = experiment::helix(vertices);
        let off = found.tip.distance(known.tip) / experiment::HELIX_LENGTH;
        println!(
            "{vertices} vertices: {:.2} % longer, tip off by {:.2} % of length",
            100.0 * (found.longer - 1.0),
            100.0 * off
        );
        assert!((found.longer / known.longer - 1.0).abs() < allowed, "{vertices}: {}", found.longer);
    }
}

#[test]
fn an_upright_strand_falls_over_where_greenhill_says() {
    let stands = |ratio: f64| line(32, DVec3::Y).is_stable(&step(SUB_STEP, LENGTH / ratio), 1.0);
    let expected = threshold::greenhill();
    assert!(stands(0.99 * expected) && !stands(1.01 * expected));
    // The same in motion: a strand that is pushed a little stands up again, or falls.
    let (below, above) = (experiment::lean(0.95 * expected), experiment::lean(1.05 * expected));
    println!("leans by {below:.3} and by {above:.3} of what it was pushed");
    assert!(below < 0.5 && above > 2.0, "{below} {above}");
}

#[test]
fn a_loaded_tip_buckles_where_euler_says() {
    // All mass at the tip.
    let stands = |load: f64| {
        let mut rest = line(32, DVec3::Y);
        rest.masses.fill(0.0);
        rest.masses[31] = load / G;
        rest.is_stable(&step(SUB_STEP, 0.05), 1.0)
    };
    let expected = threshold::tip_load(step(SUB_STEP, 0.05).bending, LENGTH);
    assert!(stands(0.99 * expected) && !stands(1.01 * expected));
}

#[test]
fn a_hanging_arc_leaves_its_plane_where_bending_turns_into_twist() {
    for arc in [8.0, 12.0] {
        let expected = threshold::bend_twist(arc, 0.77);
        let aside = |ratio: f64| experiment::arc_aside(arc, ratio);
        let (below, above) = (aside(0.95 * expected), aside(1.05 * expected));
        println!("arc of {arc}: aside by {below:.1e} below the threshold and {above:.1e} above it");
        assert!(above > 10.0 * below, "{arc}: {below} {above}");
    }
}
