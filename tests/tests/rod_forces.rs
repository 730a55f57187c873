//! The f64 function of the `Direct` solver under air, springs, damping, moving heads and gravity that it does not sag under.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};
use tressfx_conformance::rod::strand::{LENGTH, bend, line, run, settled, step, tip};
use tressfx_conformance::rod::{G, balance, elastica};
use tressfx_sim::reference::direct::{Rod, RodRest, RodStep, direct};

const NO_BENDING: f64 = 1e-4;
const SUB_STEP: f64 = 1.0 / 120.0;

#[test]
fn a_steady_wind_holds_a_strand_at_the_angle_of_its_balance() {
    let (drag, wind) = (5.0, 3.0);
    let expected = balance::wind_angle(drag, wind).to_degrees();
    for vertices in [3, 8, 32, 64] {
        for (rate, along) in [(30.0, drag), (60.0, 0.3 * drag), (120.0, 0.5 * drag), (1000.0, drag)] {
            let rest = line(vertices, DVec3::NEG_Y);
            let step = RodStep { drag: [drag, along], wind: DVec3::X * wind, ..step(1.0 / rate, NO_BENDING) };
            let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
            run(&step, &rest, &mut rod, 8.0);
            let at = tip(&rod);
            let angle = at.x.atan2(-at.y).to_degrees();
            let last = tip(&rod);
            run(&step, &rest, &mut rod, 0.1);
            let still = tip(&rod).distance(last) / LENGTH;
            assert!((angle - expected).abs() < 0.01, "{vertices}, {rate}: {angle} instead of {expected}");
            assert!(still < 1e-6, "{vertices}, {rate}: it moves by {still:e}");
        }
    }
}

#[test]
fn hair_never_outruns_the_wind() {
    let rest = line(16, DVec3::NEG_Y);
    for rate in [30.0, 120.0, 1000.0] {
        let calm = step(1.0 / rate, NO_BENDING);
        let step = RodStep { drag: [500.0, 500.0], wind: DVec3::X * 2.0, gravity: DVec3::ZERO, ..calm };
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        let mut fastest = 0.0_f64;
        for _ in 0..(0.5 * rate) as usize {
            direct(&step, &rest, &mut rod);
            fastest = rod.velocities.iter().map(|velocity| velocity.x).fold(fastest, f64::max);
        }
        assert!(fastest < 2.05 && fastest > 0.5, "1 / {rate} s: {fastest} m/s");
    }
}

#[test]
fn the_pull_is_a_spring_of_its_frequency() {
    // Without gravity and bending, and with small swings, each vertex swings at the frequency of the pull.
    let rest = line(32, DVec3::NEG_Y);
    let frequency = 3.0_f64;
    let step = RodStep { pull: (TAU * frequency).powi(2), gravity: DVec3::ZERO, ..step(1.0 / 960.0, NO_BENDING) };
    let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
    bend(&rest, &mut rod, |share| 1e-3 * LENGTH * share);
    let mut crossings = Vec::new();
    for i in 0..2000 {
        let before = tip(&rod).x;
        direct(&step, &rest, &mut rod);
        let after = tip(&rod).x;
        if (before > 0.0) != (after > 0.0) {
            crossings.push(f64::from(i) + before / (before - after));
        }
    }
    let last = crossings.len() - 1;
    let found = last as f64 / 2.0 / ((crossings[last] - crossings[0]) / 960.0);
    println!("a pull of {frequency} Hz swings at {found:.4} Hz");
    assert!((found / frequency - 1.0).abs() < 0.002, "{found}");
}

#[test]
fn internal_damping_takes_away_what_it_says() {
    // A mode of frequency omega, damped by moments that lag by tau, has the damping ratio omega tau / 2.
    let rest = line(16, DVec3::X);
    let tau = 1e-3;
    let calm = RodStep { gravity: DVec3::ZERO, damping: tau, ..step(1.0 / 3840.0, 0.5) };
    let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
    // Let go of what a weight bent.
    run(&RodStep { gravity: DVec3::NEG_Y, drag: [100.0; 2], ..calm }, &rest, &mut rod, 0.5);
    let mut values = Vec::new();
    for _ in 0..(0.6 / calm.length) as usize {
        direct(&calm, &rest, &mut rod);
        values.push(tip(&rod).y);
    }
    // The first mode is left when those above it have died down.
    let peaks: Vec<(usize, f64)> = (values.len() / 4..values.len() - 1)
        .filter(|&i| values[i] > values[i - 1] && values[i] >= values[i + 1] && values[i] > 0.0)
        .map(|i| (i, values[i]))
        .collect();
    let (first, last) = (peaks[0], peaks[peaks.len() - 1]);
    let periods = (peaks.len() - 1) as f64;
    let omega = TAU * periods / ((last.0 - first.0) as f64 * calm.length);
    let ratio = (first.1 / last.1).ln() / (TAU * periods);
    println!("mode at {:.2} Hz: damping ratio {ratio:.4}, expected {:.4}", omega / TAU, omega * tau / 2.0);
    assert!((ratio / (omega * tau / 2.0) - 1.0).abs() < 0.05, "{ratio}");
    // Clamped and free: 3.516 sqrt(B) / L^2.
    let expected = 3.516 * calm.bending.sqrt() / LENGTH.powi(2);
    assert!((omega / expected - 1.0).abs() < 0.02, "{omega} {expected}");
}

/// Strands of many shapes from one root: at angles from upright to hanging, an arc, a helix.
fn shapes() -> Vec<(&'static str, RodRest, f64)> {
    let arc = |i: usize| {
        let t = 2.5 * i as f64 / 31.0;
        DVec3::new(0.08 * (1.0 - t.cos()), 0.08 * t.sin(), 0.0)
    };
    let helix = |i: usize| {
        let t = 12.0 * i as f64 / 63.0;
        DVec3::new(0.01 * t.sin(), -0.008 * t, 0.01 * t.cos())
    };
    vec![
        ("upright", line(32, DVec3::Y), 0.2),
        ("upright and soft", line(32, DVec3::Y), 0.03),
        ("leaning", line(32, DVec3::new(1.0, 1.0, 0.0)), 0.03),
        ("horizontal", line(16, DVec3::X), 0.03),
        ("hanging", line(64, DVec3::NEG_Y), 0.02),
        ("arc", RodRest::new(&(0..32).map(arc).collect::<Vec<_>>(), 1), 0.05),
        ("helix", RodRest::new(&(0..64).map(helix).collect::<Vec<_>>(), 1), 0.05),
    ]
}

#[test]
fn the_pose_of_the_file_is_the_rest_under_gravity() {
    for (name, mut rest, bending_length) in shapes() {
        let still = step(SUB_STEP, bending_length);
        assert!(rest.stand(&still, 1.0), "{name} can stand");
        let raised = rest.stiffening.cbrt();
        let groom = rest.positions.clone();
        let length: f64 = rest.lengths.iter().sum();
        let off = |rod: &Rod| {
            let pairs = rod.positions.iter().zip(&groom);
            pairs.map(|(one, other)| one.distance(*other)).fold(0.0, f64::max) / length
        };
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        run(&still, &rest, &mut rod, 5.0);
        let rested = off(&rod);
        // After a gust it comes back.
        let air = RodStep { drag: [20.0; 2], ..still };
        run(&RodStep { wind: DVec3::new(0.1, 0.0, 0.05), ..air }, &rest, &mut rod, 1.0);
        let blown = off(&rod);
        run(&air, &rest, &mut rod, 15.0);
        let back = off(&rod);
        println!("{name}: bending length x {raised:.2}; off by {rested:.1e}, blown {blown:.1e}, back {back:.1e}");
        assert!(rested < 1e-6 && blown > 1e-4 && back < 5e-3, "{name}: {rested:e} {blown:e} {back:e}");
    }
}

/// A strand of long hair, in micrometres: joints in its middle have to want more than twice the bend that they have.
#[rustfmt::skip]
const STRAIGHTENED: [[i32; 3]; 32] = [
    [0, 0, 0], [-15242, -3247, -6589], [-28160, -12606, -12267], [-37885, -25750, -16660],
    [-44753, -40843, -19832], [-49506, -56809, -21946], [-52874, -73109, -23164], [-55397, -89492, -23686],
    [-57381, -105853, -23821], [-58916, -122143, -23953], [-59958, -138338, -24440], [-60443, -154422, -25463],
    [-60076, -170382, -26491], [-58988, -186236, -27092], [-57602, -201936, -26873], [-56390, -217427, -25480],
    [-55873, -232701, -22638], [-55872, -247827, -19157], [-55982, -262319, -14113], [-55908, -276605, -8909],
    [-55444, -289783, -4043], [-54275, -303898, 51], [-52443, -319075, 2218], [-50220, -334148, 2898],
    [-48014, -349028, 2992], [-46114, -363791, 3252], [-44981, -378645, 4172], [-44744, -393645, 5863],
    [-45283, -408797, 8087], [-46321, -424118, 10350], [-47472, -439623, 12062], [-48326, -455335, 12730],
];

#[test]
fn a_strand_that_its_weight_has_straightened_stays() {
    let places = STRAIGHTENED.map(|point| DVec3::from_array(point.map(|x| 1e-6 * f64::from(x))));
    for (rate, rounds) in [(60.0, 2), (120.0, 1), (120.0, 2), (120.0, 16), (240.0, 2)] {
        let mut rest = RodRest::new(&places, 1);
        let still = RodStep { rounds, drag: [20.0, 10.0], ..step(1.0 / rate, 0.05) };
        assert!(rest.stand(&still, 1.0));
        let groom = rest.positions.clone();
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        run(&RodStep { wind: DVec3::new(1e-4, 0.0, 1e-4), ..still }, &rest, &mut rod, 0.1);
        run(&still, &rest, &mut rod, 5.0);
        let off = rod.positions.iter().zip(&groom).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
        assert!(off < 1e-6, "1 / {rate} s, {rounds} rounds: it has moved by {off:e}");
    }
}

#[test]
fn a_part_of_the_sag_is_a_part_of_gravity() {
    let droop = |share: f64| {
        let mut rest = line(32, DVec3::X);
        let step = step(1.0 / 60.0, LENGTH / 0.5);
        assert!(rest.stand(&step, share));
        -tip(&settled(&step, &rest, 3.0)).y / LENGTH
    };
    let [none, half, full] = [1.0, 0.5, 0.0].map(droop);
    println!("droop: {none:.1e} of length without sag, {half:.5} with half, {full:.5} with all");
    assert!(none < 1e-6 && (half / full - 0.5).abs() < 0.01, "{none} {half} {full}");
    assert!((full / -elastica::tip(0.5)[1] - 1.0).abs() < 0.02);
}

#[test]
fn edges_keep_their_lengths_whatever_the_head_does() {
    for (name, rest, bending_length) in shapes() {
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        let mut last = DVec3::ZERO;
        for i in 1..=360 {
            let time = f64::from(i) * SUB_STEP;
            // 2 g at 4 Hz, and a teleport.
            let jump = if i > 200 { 100.0 } else { 0.0 };
            let place = DVec3::new(2.0 * G / (TAU * 4.0).powi(2) * (TAU * 4.0 * time).sin() + jump, 0.0, 0.0);
            let root = DQuat::from_rotation_y((7.0 * time).sin());
            let head =
                RodStep { root, root_displacement: place - last, drag: [15.0, 5.0], ..step(SUB_STEP, bending_length) };
            direct(&head, &rest, &mut rod);
            last = place;
            for (edge, length) in rod.positions.windows(2).zip(&rest.lengths) {
                assert!((edge[1].distance(edge[0]) / length - 1.0).abs() < 1e-12, "{name} at {i}");
            }
        }
    }
}

#[test]
fn only_accelerations_of_the_head_are_felt() {
    // Without air, a head at constant speed is a head at rest.
    let rest = line(16, DVec3::new(1.0, -1.0, 0.0));
    let swung = |velocity: DVec3| {
        let step = RodStep { root_displacement: velocity * SUB_STEP, ..step(SUB_STEP, 0.03) };
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        rod.velocities.fill(velocity);
        run(&step, &rest, &mut rod, 1.0);
        rod.positions
    };
    let (still, moving) = (swung(DVec3::ZERO), swung(DVec3::new(3.0, -2.0, 5.0)));
    let apart = still.iter().zip(&moving).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart:e}");
}

#[test]
fn a_turned_world_is_the_same_world() {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.5, -1.2, 2.0);
    for (name, rest, bending_length) in shapes() {
        let here = RodStep { wind: DVec3::new(1.0, 0.5, 0.2), drag: [10.0, 3.0], ..step(SUB_STEP, bending_length) };
        let there = RodStep { gravity: turn * here.gravity, wind: turn * here.wind, root: turn, ..here };
        let [mut one, mut other] = [here, there].map(|step| Rod::at_rest(&rest, step.root));
        run(&here, &rest, &mut one, 0.4);
        run(&there, &rest, &mut other, 0.4);
        for (one, other) in one.positions.iter().zip(&other.positions) {
            assert!((turn * *one).distance(*other) < 1e-7, "{name}");
        }
    }
}

#[test]
fn whatever_happens_it_is_finite_and_comes_to_rest() {
    let wild = |i: u32| {
        let spin = DQuat::from_rotation_z(TAU * 100.0 * f64::from(i) * SUB_STEP + 0.3 * f64::from(i));
        let blow = DVec3::new(300.0 * f64::from(i % 7), -200.0, 1000.0 * f64::from(i % 3));
        let length = [1e-6, 1e-3, SUB_STEP, 0.1, 3600.0][i as usize % 5];
        (spin, blow, length)
    };
    for (name, mut rest, bending_length) in shapes() {
        assert!(rest.stand(&step(SUB_STEP, bending_length), 1.0), "{name}");
        let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
        for i in 0..200 {
            let (root, wind, length) = wild(i);
            let shaken = RodStep {
                root,
                wind,
                drag: [20.0, 5.0],
                root_displacement: wind / 10.0,
                ..step(length, bending_length)
            };
            rod.has_past &= i % 5 != 0;
            direct(&shaken, &rest, &mut rod);
            assert!(rod.positions.iter().all(|place| place.is_finite()), "{name} at {i}");
        }
        let calm = RodStep { drag: [20.0; 2], damping: 2e-3, ..step(SUB_STEP, bending_length) };
        run(&calm, &rest, &mut rod, 0.5);
        let fastest = rod.velocities.iter().map(|velocity| velocity.length()).fold(0.0, f64::max);
        println!("{name}: {fastest:.2} m/s half a second later");
        assert!(fastest < 3.0, "{name}: {fastest} m/s");
        run(&calm, &rest, &mut rod, 20.0);
        let before = rod.positions.clone();
        direct(&calm, &rest, &mut rod);
        let moved = rod.positions.iter().zip(&before).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
        assert!(moved < 1e-6 * LENGTH * PI, "{name}: {moved:e}");
    }
}
