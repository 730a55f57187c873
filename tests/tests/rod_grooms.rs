//! The `Direct` solver on grooms that are shaken with 2 g at 4 Hz in the air of a single hair: f64 and the kernel.

mod support;

use std::f64::consts::TAU;

use glam::{DVec3, Quat, Vec3};
use tressfx_asset::builtin::Builtin;
use tressfx_conformance::rod::G;
use tressfx_conformance::sim::{REAL, Rig, lengths, real_part, strands_of, wide};
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::reference::Simulation;
use tressfx_sim::{ClockParams, Preset, SectionDesc, SimParams, Solver, StepInput};

use support::gpu;

/// A bend counts as one from this angle on, rad.
const BEND: f64 = 0.1;
/// So many alternating bends in a row are a zigzag.
const ZIGZAG: usize = 6;

/// The grooms of a name; `None`, visibly, where TRESSFX_ASSETS is not set. Of the mohawk an even sample.
fn groom(name: &str, count: u32) -> Option<Strands> {
    if name != "mohawk" {
        let builtin = Builtin { strands: count, ..name.parse().expect("a built-in groom") };
        return Some(strands_of(builtin.asset(), 0));
    }
    real_part(REAL[0], count)
}

/// A frame that ends at a time, until the shake ends after a second.
fn shaken(strands: &Strands, seconds: f64, dt: f64) -> StepInput<'static> {
    let swing = TAU * 4.0;
    let aside = 2.0 * G / (swing * swing) * (1.0 - (swing * seconds.min(1.0)).cos());
    let translation = Vec3::X * (aside / f64::from(strands.metres_per_unit)) as f32;
    StepInput::new(dt, Pose { rotation: Quat::IDENTITY, translation })
}

/// Tips from their roots over the lengths of their strands, at each sixth of a second.
fn tips(strands: &Strands, sub_steps: f64, fps: u32) -> Vec<DVec3> {
    tips_along(strands, sub_steps, fps, 1)
}

/// The same with so many poses of the head in a frame.
fn tips_along(strands: &Strands, sub_steps: f64, fps: u32, poses: u32) -> Vec<DVec3> {
    let desc = SectionDesc::new(strands, SimParams::default()).with_solver(Solver::Direct);
    let mut simulation = Simulation::new(&[desc]).unwrap();
    simulation.set_clock_params(ClockParams { sub_step: 1.0 / sub_steps, ..ClockParams::default() }).unwrap();
    simulation.step(&shaken(strands, 0.0, 0.0)).unwrap();
    let (vertices, dt) = (strands.vertices as usize, 1.0 / f64::from(fps));
    let mut tips = Vec::new();
    for frame in 1..=fps {
        let before = |pose: u32| f64::from(frame) * dt - f64::from(pose) * dt / f64::from(poses);
        let path: Vec<_> = (1..poses).rev().map(|pose| shaken(strands, before(pose), dt).head).collect();
        simulation.step(&shaken(strands, before(0), dt).with_path(&path)).unwrap();
        if frame % (fps / 6) == 0 {
            let positions = simulation.positions(0);
            let strand = positions.chunks(vertices).zip(lengths(strands));
            tips.extend(strand.map(|(strand, length)| (strand[vertices - 1] - strand[0]) / length));
        }
    }
    tips
}

fn rms(one: &[DVec3], other: &[DVec3]) -> f64 {
    let sum: f64 = one.iter().zip(other).map(|(one, other)| one.distance_squared(*other)).sum();
    (sum / one.len() as f64).sqrt()
}

#[test]
fn shaken_grooms_move_as_they_do_in_short_sub_steps() {
    for name in ["straight", "curly", "wavy", "mohawk"] {
        let Some(strands) = groom(name, 6) else { continue };
        let (exact, coarser) = (tips(&strands, 1920.0, 60), tips(&strands, 960.0, 60));
        let usual = tips(&strands, 120.0, 60);
        let (error, converged) = (rms(&usual, &exact), rms(&coarser, &exact));
        println!("{name}: RMS of tips {error:.5} of length; the reference has converged to {converged:.5}");
        assert!(error < 0.05 && converged < 0.2 * error, "{name}: {error} {converged}");
    }
}

#[test]
fn frame_rates_hardly_matter() {
    // At 30 frames a second the head is known at every eighth of a swing, and short strands of the mohawk, which swing about 20 times a second by
    // themselves, answer to what is made up in between. Where the frame says where the head was in its middle, nothing is.
    for (name, allowed) in [("straight", 0.01), ("curly", 0.01), ("wavy", 0.01), ("mohawk", 0.02)] {
        let Some(strands) = groom(name, 12) else { continue };
        let usual = tips(&strands, 120.0, 60);
        let [slow, fast] = [30, 144].map(|fps| rms(&tips(&strands, 120.0, fps), &usual));
        let known = rms(&tips_along(&strands, 120.0, 30, 2), &usual);
        println!(
            "{name}: {slow:.5} of length from 30 to 60 frames a second, {known:.1e} with two poses a frame, {fast:.5} from 144"
        );
        assert!(slow < allowed && known < 1e-5 && fast < 0.01, "{name}: {slow} {known:e} {fast}");
    }
}

/// Tips in the third second of a shake that does not end, 30 times in it; the head moves, or all roots do.
fn steady_tips(strands: &Strands, fps: u32, own_roots: bool) -> Vec<DVec3> {
    let desc = SectionDesc::new(strands, SimParams::default()).with_solver(Solver::Direct);
    let mut simulation = Simulation::new(&[if own_roots { desc.with_own_roots() } else { desc }]).unwrap();
    let (vertices, dt) = (strands.vertices as usize, 1.0 / f64::from(fps));
    let mut tips = Vec::new();
    for frame in 0..=3 * fps {
        // A whole second has whole swings.
        let seconds = f64::from(frame % fps) * dt;
        let input = shaken(strands, seconds, if frame == 0 { 0.0 } else { dt });
        if own_roots {
            simulation.set_roots(0, &vec![input.head; strands.guides as usize]);
        }
        let head = if own_roots { Pose::IDENTITY } else { input.head };
        simulation.step(&StepInput { head, ..input }).unwrap();
        if frame > 2 * fps && frame % (fps / 30) == 0 {
            let positions = simulation.positions(0);
            let strand = positions.chunks(vertices).zip(lengths(strands));
            tips.extend(strand.map(|(strand, length)| (strand[vertices - 1] - strand[0]) / length));
        }
    }
    tips
}

#[test]
fn roots_that_are_shaken_by_a_body_are_as_true_as_those_on_a_head() {
    for name in ["straight", "curly", "wavy", "mohawk"] {
        let Some(strands) = groom(name, 12) else { continue };
        // All that is simulated is known.
        let exact = steady_tips(&strands, 120, false);
        for (fps, allowed) in [(30, 0.025), (60, 0.005)] {
            let [head, roots] = [false, true].map(|own_roots| rms(&steady_tips(&strands, fps, own_roots), &exact));
            println!("{name}, {fps} frames a second: {head:.5} of length on a head, {roots:.5} on a body");
            assert!(roots < allowed && (roots - head).abs() < 0.1 * head, "{name}, {fps}: {head} {roots}");
        }
    }
}

/// A frame of a head that is pushed to and fro and turned for a fifth of a second, and then stands still.
fn pushed(strands: &Strands, frame: u32) -> StepInput<'static> {
    let swing = (TAU * f64::from(frame.min(12)) / 12.0).sin() as f32;
    let translation = Vec3::X * (0.01 * swing / strands.metres_per_unit);
    let head = Pose { rotation: Quat::from_rotation_y(0.2 * swing), translation };
    StepInput::new(if frame == 0 { 0.0 } else { 1.0 / 60.0 }, head)
}

/// Frames of a push and of four seconds behind it.
const PUSHED: u32 = 252;
/// What hair still moves by then in two frames, as a share of its length, at most.
const CALM: f64 = 4e-5;

/// The most that a vertex moves by, as a share of the length of its strand.
fn most_moved(strands: &Strands, before: &[DVec3], after: &[DVec3]) -> f64 {
    let vertices = strands.vertices as usize;
    let strand = before.chunks(vertices).zip(after.chunks(vertices)).zip(lengths(strands));
    let moved = |((before, after), length): ((&[DVec3], &[DVec3]), f64)| {
        before.iter().zip(after).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max) / length
    };
    strand.map(moved).fold(0.0, f64::max)
}

/// Soft hair, that is: gel and spray swing for seconds. Where a guess went on with what a round had overshot, strands of all of these grooms but the curls swung by 1e-4 to 2e-3
/// of their length a frame for ever, at 30 or 60 sub-steps a second: a long sub-step is nearly all stiffness, and a round may overshoot by a third there.
#[test]
fn hair_comes_to_rest_whatever_its_material_and_sub_step() {
    let mut most = 0.0_f64;
    let materials = ["baby", "wet", "fine", "coarse"].map(|name| name.parse::<Preset>().unwrap());
    for name in ["long", "straight", "wavy", "curly"] {
        let strands = groom(name, 40).expect("a built-in groom");
        for material in materials {
            for rate in [30.0, 60.0, 120.0] {
                let desc = SectionDesc::new(&strands, material.on(SimParams::default())).with_solver(Solver::Direct);
                let mut simulation = Simulation::new(&[desc]).unwrap();
                simulation.set_clock_params(ClockParams { sub_step: 1.0 / rate, ..ClockParams::default() }).unwrap();
                let mut go = |frames: std::ops::Range<u32>| {
                    frames.for_each(|frame| simulation.step(&pushed(&strands, frame)).map(|_| ()).unwrap());
                    simulation.positions(0).to_vec()
                };
                // A long sub-step takes two frames.
                let (before, after) = (go(0..PUSHED), go(PUSHED..PUSHED + 2));
                let moved = most_moved(&strands, &before, &after);
                most = most.max(moved);
                assert!(moved < CALM, "{name}, {}, 1/{rate} s: {moved:e}", material.name);
            }
        }
    }
    println!("{most:.1e} of length in two frames at most");
}

/// The joints of a strand that does not sag have torques at rest, which turn with its edges. One of these strands left its rest by some thousandths of its length where rounds
/// knew nothing of that, and swung there, though its pose is stable.
#[test]
fn hair_comes_back_to_the_pose_that_it_stands_in() {
    let strands = groom("long", 100).expect("a built-in groom");
    let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::Direct);
    let mut simulation = Simulation::new(&[desc]).unwrap();
    simulation.step(&pushed(&strands, 0)).unwrap();
    let rest = simulation.positions(0);
    (1..2 * PUSHED).for_each(|frame| simulation.step(&pushed(&strands, frame)).map(|_| ()).unwrap());
    let off = most_moved(&strands, &rest, &simulation.positions(0));
    println!("off by {off:.1e} of length at most");
    assert!(off < 1e-5, "{off:e}");
}

#[test]
fn the_kernel_comes_to_rest_too() {
    let strands = groom("long", 40).expect("a built-in groom");
    for rate in [30.0, 60.0, 120.0] {
        let Some(gpu) = gpu() else { return };
        let mut rig = Rig::with_solver(gpu, strands.clone(), SimParams::default(), Solver::Direct);
        rig.sim.set_clock_params(ClockParams { sub_step: 1.0 / rate, ..ClockParams::default() }).unwrap();
        let mut go = |frames: std::ops::Range<u32>| {
            for frame in frames {
                rig.frame(&pushed(&strands, frame));
            }
            wide(&rig.positions(0))
        };
        let (before, after) = (go(0..PUSHED), go(PUSHED..PUSHED + 2));
        let moved = most_moved(&strands, &before, &after);
        println!("1/{rate} s: {moved:.1e} of length in two frames");
        assert!(moved < CALM && rig.non_finite() == 0, "1/{rate} s: {moved:e}");
    }
}

/// The most bends in a row that each go back on the one before.
fn alternating(strand: &[DVec3]) -> usize {
    let edges: Vec<DVec3> = strand.windows(2).map(|edge| (edge[1] - edge[0]).normalize_or_zero()).collect();
    let bends: Vec<DVec3> = edges.windows(2).map(|pair| pair[0].cross(pair[1])).collect();
    let (mut run, mut most) = (0, 0);
    for pair in bends.windows(2) {
        let [one, other] = [pair[0], pair[1]];
        let is_back =
            one.length().min(other.length()) > BEND.sin() && one.dot(other) < -0.5 * one.length() * other.length();
        run = if is_back { run + 1 } else { 0 };
        most = most.max(run);
    }
    most
}

#[test]
fn zigzags_are_found() {
    let zigzag: Vec<_> = (0..12).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
    let arc: Vec<_> =
        (0..12).map(|i| DVec3::new((0.4 * f64::from(i)).cos(), (0.4 * f64::from(i)).sin(), 0.0)).collect();
    assert_eq!((alternating(&zigzag), alternating(&arc)), (9, 0));
}

#[test]
fn shaken_edges_keep_their_lengths_and_no_strand_zigzags() {
    for name in ["straight", "curly", "wavy", "mohawk"] {
        let Some(strands) = groom(name, 400) else { continue };
        let Some(gpu) = gpu() else { return };
        let mut rig = Rig::with_solver(gpu, strands.clone(), SimParams::default(), Solver::Direct);
        let (vertices, mut worst) = (strands.vertices as usize, 0.0_f64);
        rig.frame(&shaken(&strands, 0.0, 0.0));
        for frame in 1..=120 {
            rig.frame(&shaken(&strands, f64::from(frame) / 60.0, 1.0 / 60.0));
            if frame % 10 == 0 {
                let positions = wide(&rig.positions(0));
                for (strand, rest) in positions.chunks(vertices).zip(strands.rest_lengths.chunks(vertices)) {
                    for (edge, &rest) in strand.windows(2).zip(rest) {
                        // One rounding of a coordinate does not count.
                        let rounding = f64::from(f32::EPSILON) * edge[1].abs().max_element();
                        let off = (edge[1].distance(edge[0]) - f64::from(rest)).abs() - rounding;
                        worst = worst.max(off / f64::from(rest).max(f64::from(f32::MIN_POSITIVE)));
                    }
                }
            }
        }
        let (now, before) = (wide(&rig.positions(0)), wide(&rig.rest(0)));
        let zigzags = now.chunks(vertices).zip(before.chunks(vertices));
        let zigzags =
            zigzags.filter(|(now, before)| alternating(now) >= ZIGZAG && alternating(before) < ZIGZAG).count();
        println!("{name}: edges {worst:.1e}, {zigzags} of {} strands zigzag", strands.guides);
        assert!(worst < 2e-5 && zigzags == 0 && rig.non_finite() == 0, "{name}: {worst:e}, {zigzags}");
    }
}
