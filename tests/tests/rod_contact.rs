//! The f64 function of the `Direct` solver against capsules: on slopes, at rest, held at both ends, and hit by what is fast.

use glam::{DQuat, DVec2, DVec3};
use tressfx_conformance::rod::ode::root;
use tressfx_conformance::rod::strand::{LENGTH, line, step, tip};
use tressfx_conformance::rod::{G, balance};
use tressfx_sim::reference::direct::{Obstacle, Rod, RodRest, RodStep, TipHold, direct};

const SUB_STEP: f64 = 1.0 / 120.0;

/// A capsule of one radius that has come to where it is by a displacement.
fn capsule(ends: [DVec3; 2], radius: f64, displacement: DVec3) -> Obstacle {
    Obstacle { ends, radii: [radius; 2], rotation: DQuat::IDENTITY, translation: displacement }
}

/// A long cylinder along z.
fn bar(at: DVec3, radius: f64, displacement: DVec3) -> [Obstacle; 1] {
    [capsule([at - DVec3::Z, at + DVec3::Z], radius, displacement)]
}

/// A strand that lies along a great cylinder, whose surface is a slope there. After two seconds: how fast the tip goes, m/s, and how far
/// down it has got, m.
fn on_slope(degrees: f64, friction: f64, rate: f64, vertices: usize) -> [f64; 2] {
    let radius = 5.0;
    let ground = [capsule([DVec3::new(-1.0, -radius, 0.0), DVec3::new(1.0, -radius, 0.0)], radius, DVec3::ZERO)];
    let rest = line(vertices, DVec3::X);
    let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
    let slope = degrees.to_radians();
    let gravity = G * DVec3::new(0.0, -slope.cos(), slope.sin());
    let step = RodStep { gravity, friction, obstacles: &ground, drag: [1.0, 0.5], ..step(1.0 / rate, 0.01) };
    let mut speed = 0.0;
    for _ in 0..(2.0 * rate) as usize {
        let last = tip(&rod);
        direct(&step, &rest, &mut rod);
        speed = tip(&rod).distance(last) * rate;
    }
    [speed, tip(&rod).z]
}

#[test]
fn a_strand_stays_on_a_slope_until_friction_yields() {
    // tan(20 degrees) is 0.36, tan(25 degrees) 0.47.
    let friction = 0.4;
    for (degrees, sticks) in [(20.0_f64, true), (25.0, false)] {
        assert_eq!(balance::sliding_acceleration(degrees.to_radians(), friction) == 0.0, sticks);
        for vertices in [2, 8, 32] {
            for rate in [60.0, 120.0, 240.0, 1000.0] {
                let [speed, down] = on_slope(degrees, friction, rate, vertices);
                println!("{degrees} degrees, {vertices} vertices, {rate}/s: {speed:.1e} m/s, {down:.1e} m down");
                match sticks {
                    true => assert!(speed < 1e-6 && down < 3e-3, "{degrees} {vertices} {rate}: {speed:e} {down:e}"),
                    false => assert!(down > 0.1, "{degrees} {vertices} {rate}: {down:e}"),
                }
            }
        }
    }
}

#[test]
fn a_strand_comes_to_rest_on_a_bar() {
    for radius in [0.005, 0.02, 0.1] {
        for vertices in [8, 32, 64] {
            let at = DVec3::new(0.1, -radius - 0.002, 0.0);
            let bar = bar(at, radius, DVec3::ZERO);
            let rest = line(vertices, DVec3::X);
            let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
            let step = RodStep { obstacles: &bar, friction: 0.3, drag: [20.0, 10.0], ..step(SUB_STEP, 0.02) };
            let mut fastest = 0.0_f64;
            for i in 0..600 {
                let before = rod.positions.clone();
                direct(&step, &rest, &mut rod);
                if i > 480 {
                    let moves = rod.positions.iter().zip(&before).map(|(one, other)| one.distance(*other));
                    fastest = moves.fold(fastest, f64::max);
                }
            }
            let depth = |place: &DVec3| radius - (*place - at).truncate().length();
            let deepest = rod.positions.iter().map(depth).fold(0.0, f64::max);
            let moves = fastest / LENGTH;
            println!("radius {radius}, {vertices} vertices: {moves:.1e} of length a sub-step, {deepest:.1e} m deep");
            // It lies on the bar, and both its sides hang down.
            assert!(moves < 1e-6 && deepest < 2e-4, "{radius}, {vertices}: {moves:e} {deepest:e}");
            assert!(tip(&rod).y < -0.03 && tip(&rod).x > 0.1, "{radius}, {vertices}: {}", tip(&rod));
        }
    }
}

/// Whether a bar that comes at a speed, hits a hanging strand and goes on for 5 cm goes through it: whether its axis crosses an edge. Where it is so far from the root that
/// a strand drawn straight from there to its surface would be too short, the strand has slid off.
fn goes_through(radius: f64, speed: f64, vertices: usize, [height, start, lean]: [f64; 3]) -> bool {
    let rest = line(vertices, DVec3::new(0.0, -1.0, lean));
    let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
    let at = |time: f64| DVec3::new(speed * time - radius - start, -height * LENGTH, 0.0);
    // On which side of an edge the axis is, where it is beside it.
    let side = |rod: &Rod, at: DVec3, edge: usize| {
        let [u, v, at] = [rod.positions[edge], rod.positions[edge + 1], at].map(DVec3::truncate);
        let (along, to): (DVec2, DVec2) = (v - u, at - u);
        let beside = (0.0..=1.0).contains(&(along.dot(to) / along.length_squared()));
        beside.then(|| along.perp_dot(to) > 0.0)
    };
    for i in 0..((start + radius + 0.05) / (speed * SUB_STEP)).ceil() as usize {
        let [before, now] = [i, i + 1].map(|i| at(i as f64 * SUB_STEP));
        let bar = bar(now, radius, now - before);
        let step = RodStep { obstacles: &bar, friction: 0.3, drag: [20.0, 10.0], ..step(SUB_STEP, 0.03) };
        let sides: Vec<_> = (0..vertices - 1).map(|edge| side(&rod, before, edge)).collect();
        direct(&step, &rest, &mut rod);
        let crosses = |(edge, was): (usize, Option<bool>)| was.is_some_and(|was| side(&rod, now, edge) == Some(!was));
        if sides.into_iter().enumerate().any(crosses) {
            let reach = (now.length_squared() - radius * radius).max(0.0).sqrt();
            return reach < LENGTH;
        }
    }
    false
}

#[test]
fn fast_bars_do_not_go_through() {
    // Cases that lie evenly beside each other, and never come again.
    let part = |i: i32, of: f64| (f64::from(i) * of).fract();
    let [height, start, lean] = [0.618_033_988_75, 0.414_213_562_37, 0.732_050_807_57];
    let case = |i: i32| [0.3 + 0.6 * part(i, height), 0.002 + 0.1 * part(i, start), 0.3 * part(i, lean)];
    for radius in [0.0025, 0.005, 0.01, 0.03] {
        // The fastest are over soonest.
        for (speed, cases) in [(1.0, 100), (3.0, 100), (10.0, 1000)] {
            for vertices in [16, 32, 64] {
                let is_through = |i: &i32| goes_through(radius, speed, vertices, case(*i));
                let through = (0..cases).filter(is_through).count();
                println!("radius {radius} m, {speed} m/s, {vertices} vertices: {through} of {cases} go through");
                let most = match (radius, speed) {
                    (0.01, 10.0) => 0,
                    (0.0025..0.02, 10.0) if vertices > 16 => 0,
                    // It drags a strand by half of its length, which then whips around it.
                    (0.0025, 3.0) => 5,
                    _ => 1,
                };
                assert!(through <= most, "{radius}, {speed}, {vertices}: {through}");
            }
        }
    }
}

/// An arc that hangs between two points, whose distance is this share of its length.
fn sagging(share: f64) -> RodRest {
    let half = root(|half: f64| half.sin() / half - share, 1e-3, 3.0);
    let at = |i: usize| {
        let t = half * (2.0 * i as f64 / 31.0 - 1.0);
        LENGTH / (2.0 * half) * DVec3::new(t.sin(), -t.cos(), 0.0)
    };
    RodRest::new(&(0..32).map(at).collect::<Vec<_>>(), 0)
}

#[test]
fn a_strand_that_is_held_at_both_ends_is_pushed_aside() {
    for radius in [0.005, 0.02] {
        for share in [0.5, 0.9, 0.99] {
            let rest = sagging(share);
            let place = rest.positions[31];
            let mut rod = Rod::at_rest(&rest, DQuat::IDENTITY);
            // Across the plane of the arc, up to four fifths of what the length allows in the middle.
            let reach = 0.5 * LENGTH * (1.0 - share * share).sqrt();
            let (start, end) = (-radius - 0.01, 0.8 * reach - radius);
            let at = |i: i32| {
                let z = start + (end - start) * (f64::from(i.max(0)) / 240.0).min(1.0);
                DVec3::new(0.5 * place.x, 0.0, z)
            };
            let (mut off, mut moves) = (0.0_f64, 0.0_f64);
            for i in 0..600 {
                let (before, now) = (at(i - 1), at(i));
                let bar = [capsule([now - DVec3::Y, now + DVec3::Y], radius, now - before)];
                let tip_hold = Some(TipHold { place, frame: None });
                let air = RodStep { drag: [10.0, 5.0], friction: 0.3, ..step(SUB_STEP, 0.03) };
                let held = RodStep { tip: tip_hold, obstacles: &bar, ..air };
                let before = rod.positions.clone();
                direct(&held, &rest, &mut rod);
                off = off.max(tip(&rod).distance(place));
                for (edge, length) in rod.positions.windows(2).zip(&rest.lengths) {
                    assert!((edge[1].distance(edge[0]) / length - 1.0).abs() < 1e-12, "{radius}, {share}");
                }
                if i > 540 {
                    let each = rod.positions.iter().zip(&before).map(|(one, other)| one.distance(*other));
                    moves = each.fold(moves, f64::max);
                }
            }
            let now = at(600);
            let depth = |place: &DVec3| radius - DVec2::new(place.x - now.x, place.z - now.z).length();
            let deepest = rod.positions.iter().map(depth).fold(0.0, f64::max);
            println!(
                "radius {radius}, ends {share} of length apart: tip off by {off:.1e} m, {deepest:.1e} m deep, moves {moves:.1e} m"
            );
            assert!(off < 1e-3 && deepest < 5e-4 && moves < 1e-6, "{radius}, {share}: {off:e} {deepest:e} {moves:e}");
        }
    }
}
