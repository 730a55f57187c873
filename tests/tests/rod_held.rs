//! The f64 function of the `Direct` solver with both ends held, and on a shaken head.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use tressfx_conformance::rod::ode::root;
use tressfx_conformance::rod::strand::{LENGTH, line, step, tip};
use tressfx_conformance::rod::{G, experiment};
use tressfx_sim::reference::direct::{Rod, RodRest, RodStep, TipHold, direct};

const SUB_STEP: f64 = 1.0 / 120.0;

/// An arc that hangs between two points, whose distance is this share of its length.
fn sagging(vertices: usize, share: f64) -> RodRest {
    let half = root(|half| half.sin() / half - share, 1e-3, 3.0);
    let radius = LENGTH / (2.0 * half);
    let at = |i: usize| {
        let t = half * (2.0 * i as f64 / (vertices - 1) as f64 - 1.0);
        radius * DVec3::new(t.sin(), -t.cos(), 0.0)
    };
    RodRest::new(&(0..vertices).map(at).collect::<Vec<_>>(), 0)
}

#[test]
fn a_held_tip_stays_where_it_is_held() {
    for vertices in [8, 32, 64] {
        for share in [0.5, 0.9, 0.9999] {
            let rest = sagging(vertices, share);
            let place = rest.positions[vertices - 1];
            let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
            let mut worst = 0.0_f64;
            for i in 0..480 {
                let shaken = if i < 240 { 0.0 } else { 0.002 * (f64::from(i - 240) * SUB_STEP * TAU * 4.0).cos() };
                let held = RodStep {
                    tip: Some(TipHold { place, frame: None }),
                    root_displacement: DVec3::Y * shaken,
                    drag: [10.0, 5.0],
                    ..step(SUB_STEP, 0.03)
                };
                direct(&held, &rest, &mut rod);
                worst = worst.max(tip(&rod).distance(place));
                for (edge, length) in rod.positions.windows(2).zip(&rest.lengths) {
                    assert!((edge[1].distance(edge[0]) / length - 1.0).abs() < 1e-12, "{vertices}, {share}");
                }
            }
            println!("{vertices} vertices, held at {share} of length: off by at most {:.3} mm", 1e3 * worst);
            assert!(worst < 1e-3, "{vertices}, {share}: {worst} m");
        }
    }
}

#[test]
fn a_twisted_ring_leaves_its_plane_where_michell_says() {
    // Above the threshold it coils up, passes through itself and has two turns less.
    for vertices in [48, 96] {
        let (below, above) = (experiment::twist_of_a_ring(vertices, 0.95), experiment::twist_of_a_ring(vertices, 1.05));
        println!("{vertices} vertices: twist {below:.3} below the threshold and {above:.3} above it");
        assert!(below > 0.97 && above < 0.3, "{vertices}: {below} {above}");
    }
}

#[test]
fn a_shaken_strand_moves_as_it_does_in_short_sub_steps() {
    // 2 g at 4 Hz, in the air of a single hair.
    let helix = |i: usize| {
        let t = 24.0 * i as f64 / 47.0;
        DVec3::new(0.01 * t.sin(), -0.008 * t, 0.01 * t.cos())
    };
    let grooms =
        [("hanging", line(32, DVec3::NEG_Y)), ("curly", RodRest::new(&(0..48).map(helix).collect::<Vec<_>>(), 0))];
    for (name, mut rest) in grooms {
        assert!(rest.stand(&step(SUB_STEP, 0.05), 1.0), "{name}");
        let length: f64 = rest.lengths.iter().sum();
        let shaken = |per_frame: u32| {
            let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
            let (mut last, mut tips) = (0.0, Vec::new());
            for i in 1..=120 * per_frame {
                let time = f64::from(i) / (60.0 * f64::from(per_frame));
                let place = 2.0 * G / (TAU * 4.0).powi(2) * (1.0 - (TAU * 4.0 * time).cos());
                let head = RodStep {
                    root_displacement: DVec3::X * (place - last),
                    drag: [20.0, 10.0],
                    ..step(1.0 / (60.0 * f64::from(per_frame)), 0.05)
                };
                direct(&head, &rest, &mut rod);
                last = place;
                if i % per_frame == 0 {
                    tips.push(tip(&rod));
                }
            }
            tips
        };
        let exact = shaken(32);
        let error = |per_frame: u32| {
            let pairs = shaken(per_frame).into_iter().zip(&exact);
            (pairs.map(|(one, other)| one.distance_squared(*other)).sum::<f64>() / exact.len() as f64).sqrt() / length
        };
        let errors = [1, 2, 4].map(error);
        println!("{name}: RMS of the tip {errors:.5?} of length at 60, 120, 240 sub-steps a second");
        assert!(errors[1] < 0.05 && errors[2] < errors[1], "{name}: {errors:?}");
    }
}
