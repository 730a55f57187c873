//! The outside references of the motion of rods, each against another derivation.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DQuat, DVec3};
use tressfx_conformance::rod::kirchhoff::Kirchhoff;
use tressfx_conformance::rod::links::Links;
use tressfx_conformance::rod::ode::integrate;
use tressfx_conformance::rod::{G, balance, chain, elastica, pendulum, threshold};

fn close(what: &str, one: f64, other: f64, share: f64) {
    let error = (one / other - 1.0).abs();
    println!("{what}: {one} and {other}, {error:.1e} apart");
    assert!(error < share, "{what}: {one} and {other}");
}

#[test]
fn the_pendulum_has_the_period_of_the_integral() {
    for amplitude in [0.01, 1.0, FRAC_PI_2, 3.0] {
        let period = pendulum::period(0.2, amplitude);
        close("period", period, pendulum::period_by_quadrature(0.2, amplitude), 1e-12);
        let quarters = [0.0, 0.25, 0.5, 0.75].map(|part| pendulum::angle(0.2, amplitude, part * period));
        for (angle, expected) in quarters.iter().zip([amplitude, 0.0, -amplitude, 0.0]) {
            assert!((angle - expected).abs() < 1e-9, "{quarters:?}");
        }
    }
    close("small swings", pendulum::period(0.2, 1e-4), 2.0 * PI * (0.2 / G).sqrt(), 1e-8);
}

#[test]
fn one_link_is_a_rigid_rod() {
    let mut link = Links::straight(0.2, 0.0, 1, FRAC_PI_2);
    link.run(0.4, 4000);
    let expected = pendulum::angle(pendulum::of_rigid_rod(0.2), FRAC_PI_2, 0.4);
    assert!((link.angles[0] - expected).abs() < 1e-9, "{} {expected}", link.angles[0]);
}

#[test]
fn zeros_of_the_bessel_function_are_those_of_its_expansion() {
    for (number, share) in [(1, 1e-3), (2, 5e-6), (3, 2e-7), (4, 5e-8)] {
        close("zero", chain::zero_of_j0(number), chain::zero_by_expansion(number), share);
    }
}

#[test]
fn many_links_swing_as_a_hanging_chain() {
    for (mode, share) in [(1, 5e-4), (2, 5e-3), (3, 0.02)] {
        let mut links = Links::straight(0.2, 0.0, 64, 0.0);
        let size = 1e-4;
        let place = |i: usize| 0.2 * size * chain::shape(mode, i as f64 / 64.0);
        links.angles = (0..64).map(|i| ((place(i + 1) - place(i)) / links.link).asin()).collect();
        let start = links.places()[63][0];
        let period = 2.0 * PI / chain::frequency(0.2, mode);
        links.run(period, 800);
        close("after a period", links.places()[63][0], start, share);
    }
}

#[test]
fn the_heavy_elastica_is_known_where_it_is_stiff_and_where_it_is_soft() {
    close("droop", -elastica::tip(0.1)[1], elastica::small_droop(0.1), 1e-5);
    close("droop", -elastica::tip(0.3)[1], elastica::small_droop(0.3), 1e-3);
    close("reach", elastica::tip(20.0)[0], elastica::soft_reach(20.0), 0.01);
    close("reach", elastica::tip(30.0)[0], elastica::soft_reach(30.0), 0.006);
    let real = [(0.02, 0.008), (0.05, 0.13), (0.1, 0.65), (0.2, 0.92)];
    for (length, droop) in real {
        let tip = elastica::tip(length / (1.2e-3_f64 / G).cbrt());
        assert!((tip[1] + droop).abs() < 0.02, "{length} m: {tip:?}");
    }
}

#[test]
fn the_rod_in_space_bends_as_that_in_a_plane() {
    for ratio in [0.3, 1.0, 3.0, 5.0] {
        let rod = Kirchhoff::straight(ratio, 1.0, -DVec3::Y);
        let (_, tip) = rod.loaded(DQuat::IDENTITY, 10).expect("it is found");
        let [along, up] = elastica::tip(ratio);
        assert!(tip.distance(DVec3::new(0.0, ratio * up, ratio * along)) < 1e-8, "{ratio}: {tip} {along} {up}");
    }
}

#[test]
fn links_come_to_rest_on_the_elastica() {
    // An undamped rod swings about its equilibrium, which is its mean over many swings.
    let (length, ratio) = (0.2, 0.5_f64);
    let mut links = Links::straight(length, G * (length / ratio).powi(3), 16, FRAC_PI_2);
    let mut sum = 0.0;
    for _ in 0..2000 {
        links.run(0.001, 20);
        sum += links.places()[15][1];
    }
    close("mean of swings", sum / 2000.0, length * elastica::tip(ratio)[1], 0.03);
}

#[test]
fn thresholds_are_those_of_shooting() {
    close("Greenhill", threshold::greenhill_by_shooting(), threshold::greenhill(), 1e-7);
    for ratio in [0.7, 1.0] {
        close("Michell", threshold::michell_by_shooting(ratio), threshold::michell(ratio), 1e-4);
    }
    // At the tip load a quarter of a wave fits in: the angle at the clamp is 0 whatever that at the tip.
    let (bending, length) = (2.0_f64, 3.0);
    let curvature = (threshold::tip_load(bending, length) / bending).sqrt();
    let bent = |_: f64, y: &[f64; 2]| [y[1], -curvature * curvature * y[0]];
    let [clamp, _] = integrate(bent, [1.0, 0.0], [0.0, length], 400);
    assert!(clamp.abs() < 1e-9, "{clamp}");
}

#[test]
fn a_hanging_arc_leaves_its_plane_at_the_threshold() {
    for arc in [8.0, 12.0] {
        let ratio = threshold::bend_twist(arc, 0.77);
        println!("an arc of {arc} radians leaves its plane at {ratio} bending lengths");
        // A thousandth of the weight pulls it out of its plane.
        let aside = |ratio: f64| {
            let rod = threshold::arched(ratio, arc, 0.77);
            let rod = Kirchhoff { gravity: DVec3::new(0.0, 1e-3, -1.0), ..rod };
            let (_, tip) = rod.loaded(threshold::down(), 200).expect("a path without a turn");
            (tip.y / ratio).abs()
        };
        let (before, after) = (aside(0.95 * ratio), aside(1.02 * ratio));
        println!("aside by {before:.1e} below it and {after:.1e} above it");
        assert!(after > 10.0 * before);
    }
}

#[test]
fn a_rod_without_weight_keeps_its_helix() {
    let (radius, pitch) = (0.01_f64, 0.02_f64);
    let rise = pitch / (2.0 * PI);
    let square = radius * radius + rise * rise;
    let natural = DVec3::new(0.0, radius / square, rise / square);
    let rod = Kirchhoff { natural, steps: 4000, ..Kirchhoff::straight(0.3, 1.0, DVec3::ZERO) };
    let root = DQuat::IDENTITY;
    let (_, tip) = rod.loaded(root, 1).expect("it is found");
    let turns = rod.length / square.sqrt();
    let axis = (root * natural).normalize();
    close("along the axis", tip.dot(axis), turns * rise, 1e-8);
    let across = (tip - axis * tip.dot(axis)).length();
    close("across it", across, 2.0 * radius * (turns / 2.0).sin().abs(), 1e-6);
}

#[test]
fn balances_are_those_of_forces() {
    let angle = balance::wind_angle(5.0, 3.0);
    let across = G * angle.sin() - 5.0 * 3.0 * angle.cos();
    assert!(across.abs() < 1e-12);
    let slope = balance::sliding_slope(0.4);
    assert!((slope.to_degrees() - 21.80).abs() < 0.01, "{slope}");
    assert_eq!(balance::sliding_acceleration(slope - 1e-9, 0.4), 0.0);
    close("friction of none", balance::sliding_acceleration(0.3, 0.0), G * 0.3_f64.sin(), 1e-12);
}
