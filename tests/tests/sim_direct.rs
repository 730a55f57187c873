//! The kernel of the `Direct` solver: against its f64 function, against what thin rods are known to do, and in trouble.

mod support;

use glam::{Quat, Vec3, Vec4};
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_conformance::rod::elastica;
use tressfx_conformance::sim::{Motion, REAL, Rig, builtin, lengths, random_strands, real, strand_errors};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::Pose;
use tressfx_sim::{ClockParams, SectionDesc, SimParams, Solver, StepInput, metrics, reference};

use support::gpu;

fn rig(strands: &Strands, params: &SimParams) -> Option<Rig> {
    Some(Rig::with_solver(gpu()?, strands.clone(), params.clone(), Solver::Direct))
}

/// Frames on the GPU and in f64; gives the errors of strands, and the simulation on the GPU.
fn both(strands: &Strands, params: &SimParams, motion: &Motion, frames: u32) -> Option<(Vec<f64>, Rig)> {
    let mut rig = rig(strands, params)?;
    let desc = SectionDesc::new(strands, params.clone()).with_solver(Solver::Direct);
    let mut reference = reference::Simulation::new(&[desc]).unwrap();
    rig.play(motion, f64::from(frames) / 60.0, 60);
    reference.step(&motion.input(0.0, 0.0)).unwrap();
    for frame in 1..=frames {
        reference.step(&motion.input(f64::from(frame) / 60.0, 1.0 / 60.0)).unwrap();
    }
    assert_eq!((rig.non_finite(), reference.non_finite()), (0, 0));
    let errors = strand_errors(strands, &rig.positions(0), &reference.positions(0));
    Some((errors, rig))
}

fn against_reference(name: &str, strands: &Strands, params: &SimParams, allowed: f64) {
    let Some((errors, mut rig)) = both(strands, params, &Motion::wild(strands), 30) else { return };
    let at = |share: usize| errors[(errors.len() - 1) * share / 100];
    let edges = metrics::edge_error(strands, &rig.positions(0)).max;
    println!("{name}: {:.1e} (median) {:.1e} (99%) {:.1e} (largest), edges {edges:.1e}", at(50), at(99), at(100));
    assert!(at(99) < allowed && edges < 2e-5, "{name}: {:e} (99%), edges {edges:e}", at(99));
}

#[test]
fn the_kernel_does_what_its_f64_function_does() {
    let damped = SimParams { internal_damping: 2e-3, pull_frequency: 1.0, ..SimParams::default() };
    for vertices in [2, 3, 16, 64] {
        let strands = random_strands(65, vertices, 1, 3);
        against_reference(&format!("random, {vertices}"), &strands, &SimParams::default(), 2e-4);
        against_reference(&format!("random, {vertices}, damped"), &strands, &damped, 2e-4);
    }
    for name in ["long", "curly"] {
        against_reference(name, &builtin(name, 100), &SimParams::default(), 2e-4);
    }
}

/// Strands that are all alike, pinned at their first vertex: as many as `points` gives from the origin.
fn strand_of(points: Vec<Vec3>, pinned: &[usize]) -> Strands {
    let inverse_masses = (0..points.len()).map(|i| if pinned.contains(&i) { 0.0 } else { 1.0 }).collect();
    strand_with(points, inverse_masses)
}

fn strand_with(points: Vec<Vec3>, inverse_masses: Vec<f32>) -> Strands {
    let count = points.len() as u32;
    let asset = HairAsset::new("line", AssetFormat::Builtin, points.iter().map(Vec3::to_array).collect(), vec![count]);
    let asset = HairAsset { inverse_mass: Some(inverse_masses), ..asset };
    let options = StrandOptions {
        follows: Some(0),
        metres_per_unit: Some(1.0),
        vertices: Some(count),
        ..StrandOptions::default()
    };
    Strands::new(&asset, &options).unwrap()
}

#[test]
fn tips_are_where_the_heavy_elastica_has_them() {
    let length = 0.2;
    for (vertices, allowed) in [(8_u16, 0.03), (16, 0.015), (32, 0.0075), (64, 0.005)] {
        for ratio in [0.3, 1.0, 3.0, 6.0, 10.0, 30.0] {
            let at = |i: u16| Vec3::X * (length * f32::from(i) / f32::from(vertices - 1));
            let strands = strand_of((0..vertices).map(at).collect(), &[0]);
            let bending_length = length / ratio as f32;
            let params = SimParams { sag_free: 0.0, air_drag_along: 1.0, bending_length, ..SimParams::default() };
            let Some(mut rig) = rig(&strands, &params) else { return };
            rig.play(&Motion::still(&strands), 5.0, 60);
            let (world, last) = (rig.world(0), usize::from(vertices) - 1);
            let tip = (world[last] - world[0]).truncate().as_dvec3() / f64::from(length);
            let [along, up] = elastica::tip(ratio);
            let error = (tip.x - along).hypot(tip.y - up);
            println!("{vertices} vertices, L / Lb = {ratio}: off by {:.2} % of length", 100.0 * error);
            assert!(error < allowed, "{vertices}, {ratio}: {tip} instead of {along} {up}");
        }
    }
}

#[test]
fn grooms_rest_in_the_pose_of_their_file() {
    for name in ["straight", "curly", "wavy", "long", "mohawk"] {
        let strands = match name {
            "mohawk" => match real(REAL[0]) {
                Some(strands) => strands,
                None => continue,
            },
            name => builtin(name, 100),
        };
        let Some(mut rig) = rig(&strands, &SimParams::default()) else { return };
        let standing = rig.sim.standing(0).expect("rods stand");
        rig.play(&Motion::still(&strands), 5.0, 60);
        let (before, rest) = (rig.positions(0), rig.rest(0));
        rig.frame(&Motion::still(&strands).input(0.0, 1.0 / 60.0));
        let after = rig.positions(0);
        let vertices = strands.vertices as usize;
        let mut off: Vec<f32> = Vec::new();
        let mut moves: Vec<f32> = Vec::new();
        for (strand, length) in lengths(&strands).into_iter().enumerate() {
            // f32 does not know where the edges of shorter ones point.
            if length > 1e-4 / f64::from(strands.metres_per_unit) {
                let range = strand * vertices..(strand + 1) * vertices;
                let tip = range.end - 1;
                off.push(before[tip].truncate().distance(rest[tip].truncate()) / length as f32);
                // Four roundings of a coordinate do not count.
                let step = |i: usize| {
                    let rounding = 2.0 * f32::EPSILON * before[i].truncate().abs().max_element();
                    (before[i].truncate().distance(after[i].truncate()) - rounding).max(0.0)
                };
                moves.push(range.map(step).fold(0.0, f32::max) / length as f32);
            }
        }
        off.sort_by(f32::total_cmp);
        let (median, most) = (off[off.len() / 2], off[off.len() - 1]);
        let moved = moves.iter().copied().fold(0.0, f32::max);
        println!("{name}: {standing:?}; tips off by {median:.1e} (median), {most:.1e}; moves by {moved:.1e} a frame");
        assert!(most < 5e-3 && moved < 1e-6, "{name}: {most:e} {moved:e}");
        assert_eq!(rig.non_finite(), 0);
    }
}

#[test]
fn both_backends_agree_to_the_bit() {
    let strands = random_strands(65, 24, 2, 9);
    let params = SimParams { internal_damping: 1e-3, ..SimParams::default() };
    let Some(gpu) = gpu() else { return };
    let mut one = Rig::with_solver(gpu, strands.clone(), params.clone(), Solver::Direct);
    let vulkan = {
        let _alone = tressfx_backend_vulkan::lock_loader();
        VulkanBackend::headless().expect("a Vulkan device")
    };
    let mut other = Rig::with_solver(Box::new(vulkan), strands.clone(), params, Solver::Direct);
    let motion = Motion::wild(&strands);
    one.play(&motion, 0.5, 60);
    other.play(&motion, 0.5, 60);
    assert_eq!(one.positions(0), other.positions(0));
}

/// The solver has masses of its own; those of the file go on with the positions, whatever they are.
#[test]
fn inverse_masses_go_with_positions() {
    let points = || (0..8).map(|i| 0.02 * i as f32 * Vec3::new(0.6, -0.8, 0.0)).collect();
    for inverse_masses in [[0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0], [0.0, 0.7, 2.0, 1e-3, 1.0, 0.3, 5.0, 0.0]] {
        let strands = strand_with(points(), inverse_masses.to_vec());
        let Some(mut rig) = rig(&strands, &SimParams::default()) else { return };
        rig.play(&Motion::wild(&strands), 0.2, 60);
        let found: Vec<f32> = rig.positions(0).iter().map(|position| position.w).collect();
        assert_eq!(found, inverse_masses);
    }
}

/// Without it kernels keep no strains: what joints have long been bent by must not count as their rate.
#[test]
fn damping_that_is_turned_on_moves_nothing_that_rests() {
    let strands = builtin("long", 100);
    let Some(mut rig) = rig(&strands, &SimParams::default()) else { return };
    let still = Motion::still(&strands);
    rig.play(&still, 1.0, 60);
    let before = rig.positions(0);
    let damped = SimParams { internal_damping: 0.05, ..SimParams::default() };
    rig.sim.set_params(&mut *rig.backend, 0, damped).unwrap();
    for _ in 0..4 {
        rig.frame(&still.input(1.0, 1.0 / 60.0));
    }
    let moved = |(now, before): (&Vec4, &Vec4)| now.truncate().distance(before.truncate());
    let most = rig.positions(0).iter().zip(&before).map(moved).fold(0.0, f32::max);
    let longest = lengths(&strands).into_iter().fold(0.0, f64::max) as f32;
    println!("damping turned on moves hair at rest by {:.1e} of the longest strand", most / longest);
    assert!(most < 1e-5 * longest, "{most} of {longest}");
}

#[test]
fn a_pinned_tip_is_held() {
    let arc = |i: u16| {
        let t = 1.2 * (2.0 * f32::from(i) / 31.0 - 1.0);
        0.1 * Vec3::new(t.sin(), -t.cos(), 0.0)
    };
    let strands = strand_of((0..32).map(arc).collect(), &[0, 31]);
    let Some((errors, mut rig)) = both(&strands, &SimParams::default(), &Motion::turning(&strands), 60) else { return };
    let edges = metrics::edge_error(&strands, &rig.positions(0)).max;
    let head = Motion::turning(&strands).head(1.0);
    let held = rig.world(0)[31].truncate().distance(head.transform(strands.rest[31].truncate()));
    println!("a pinned tip: off by {held:.1e} m, edges {edges:.1e}, {:.1e} from f64", errors[0]);
    assert!(held < 1e-3 && edges < 2e-5 && errors[0] < 1e-3);
}

#[test]
fn whatever_happens_it_is_finite_and_comes_to_rest() {
    for strands in [random_strands(65, 16, 1, 5), random_strands(3, 256, 0, 6), random_strands(65, 2, 0, 7)] {
        let Some(mut rig) = rig(&strands, &SimParams::default()) else { return };
        let motion = Motion::wild(&strands);
        for frame in 0..120_u16 {
            let time = f64::from(frame) / 60.0;
            let jump = if frame % 20 > 10 { 100.0 } else { 0.0 };
            let spin = Quat::from_rotation_z(std::f32::consts::TAU * 100.0 * time as f32 + 0.7 * f32::from(frame));
            let dt = [1.0 / 60.0, 0.0, -1.0, 86400.0, 1e-4][usize::from(frame) % 5];
            let head = Pose { rotation: spin, translation: Vec3::new(jump, 0.0, 0.1 * f32::from(frame)) };
            rig.frame(&StepInput { head, ..motion.input(time, dt) });
        }
        let head = Pose { rotation: Quat::IDENTITY, translation: Vec3::ZERO };
        for _ in 0..30 {
            rig.frame(&StepInput::new(1.0 / 60.0, head));
        }
        let before = rig.positions(0);
        rig.frame(&StepInput::new(1.0 / 60.0, head));
        let after = rig.positions(0);
        let fastest = before.iter().zip(&after).map(|(one, other)| one.distance(*other) * 60.0).fold(0.0, f32::max);
        println!("{} vertices: {fastest:.2} m/s half a second later", strands.vertices);
        assert!(after.iter().all(|place| place.is_finite()) && fastest < 1.0, "{fastest} m/s");
        assert_eq!(rig.non_finite(), 0);
    }
}

#[test]
fn strands_that_nobody_would_make_stay_finite() {
    let of = |place: fn(f32) -> Vec3| (0..12_u16).map(|i| place(f32::from(i))).collect::<Vec<_>>();
    let hostile = [
        ("one point", of(|_| Vec3::Y)),
        ("points in pairs", of(|i| Vec3::X * (0.02 * (i / 2.0).floor()))),
        ("hairpins", of(|i| Vec3::new(0.05 * (i % 2.0), 1e-4 * i, 0.0))),
        ("back on itself", of(|i| Vec3::X * (0.05 * (i % 2.0)))),
        ("tiny", of(|i| Vec3::new(1e-6 * i, 1e-6 * (i * 0.7).sin(), 0.0))),
        ("huge", of(|i| Vec3::new(0.0, 30.0 * i, 5.0 * (i * 0.7).sin()))),
        ("uneven", of(|i| Vec3::new(0.001 * 2.0_f32.powf(i * 0.7), 0.0, 1e-7 * i))),
    ];
    for (name, points) in hostile {
        let strands = strand_of(points, &[0]);
        for sag_free in [0.0, 1.0] {
            let params = SimParams { sag_free, ..SimParams::default() };
            let Some(mut rig) = rig(&strands, &params) else { return };
            rig.play(&Motion::wild(&strands), 1.0, 60);
            let positions = rig.positions(0);
            let edges = metrics::edge_error(&strands, &positions).max;
            println!("{name}: {:?}, edges {edges:.1e}, {} resets", rig.sim.standing(0), rig.non_finite());
            assert!(positions.iter().all(|place| place.is_finite()), "{name}");
            assert!(rig.non_finite() == 0 && edges < 2e-5, "{name}: {edges:e}");
        }
    }
}

#[test]
fn any_sub_step_gives_the_same_rest() {
    let strands = builtin("curly", 20);
    let rested = |sub_step: f64| {
        let params = SimParams { sag_free: 0.0, ..SimParams::default() };
        let mut rig = rig(&strands, &params)?;
        let mut list = PassList::new();
        rig.sim.set_clock_params(ClockParams { sub_step, ..ClockParams::default() }).unwrap();
        rig.backend.run(&list).unwrap();
        list.clear_commands();
        rig.play(&Motion::still(&strands), 4.0, 60);
        Some(rig.positions(0))
    };
    let [Some(one), Some(other)] = [1.0 / 60.0, 1.0 / 480.0].map(rested) else { return };
    let apart = one.iter().zip(&other).map(|(one, other)| one.distance(*other)).fold(0.0, f32::max);
    let longest = lengths(&strands).into_iter().fold(0.0, f64::max) as f32;
    println!("sags by the same to {:.1e} of length", apart / longest);
    assert!(apart < 1e-3 * longest, "{apart}");
}

/// Where a sub-step moves edges by little more than their directions are rounded by.
#[test]
fn the_shortest_sub_steps_are_true_too() {
    let points = (0..16).map(|i| 0.2 / 15.0 * i as f32 * Vec3::new(0.6, 0.0, 0.8)).collect();
    let strands = strand_of(points, &[0]);
    let params = SimParams { bending_length: 0.01, air_drag: 0.0, sag_free: 0.0, ..SimParams::default() };
    // What is left of an edge is stored in 16 bits a number, of which a share of the weight is lost where all motion is that of one round.
    for (sub_step, seconds, allowed) in [(1e-3, 0.1, 1e-4), (1e-4, 0.1, 1e-3), (1e-5, 0.02, 2e-3)] {
        let Some(mut rig) = rig(&strands, &params) else { return };
        let desc = SectionDesc::new(&strands, params.clone()).with_solver(Solver::Direct);
        let mut reference = reference::Simulation::new(&[desc]).unwrap();
        let clock = ClockParams { sub_step, ..ClockParams::default() };
        rig.run(|sim, _| sim.set_clock_params(clock)).unwrap();
        reference.set_clock_params(clock).unwrap();
        let motion = Motion::still(&strands);
        for frame in 0..=(seconds * 100.0_f64).round() as u32 {
            let input = motion.input(0.0, if frame == 0 { 0.0 } else { 0.01 });
            rig.frame(&input);
            reference.step(&input).unwrap();
        }
        let error = strand_errors(&strands, &rig.positions(0), &reference.positions(0))[0];
        let fallen = 4.905 * seconds * seconds / 0.2;
        println!("{sub_step:e} s: off by {error:.1e} of length, fallen by up to {fallen:.1e}");
        assert!(error < allowed * fallen, "{sub_step:e} s: {error:e} of length");
    }
}
