//! What hair against hair does: hair keeps its volume, curls do not collapse into a sheet, friction takes relative motion alone, and nothing shakes at any
//! sub-step or frame rate.

#[path = "support/volume.rs"]
mod made;
mod support;

use glam::{Vec3, Vec4};
use made::{LENGTH, VERTICES, block, curly_block, rig, strands};
use tressfx_conformance::sim::{Motion, Rig};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::{ClockParams, SimParams, Solver, StepInput, VolumeParams};

/// Soft hair that gravity may take, of either solver.
fn soft() -> SimParams {
    let tressfx = SimParams { global_stiffness: 0.0, local_stiffness: 0.3, ..SimParams::default() };
    SimParams { sag_free: 0.0, bending_length: 0.03, ..tressfx }
}

/// On a grid with cells of 2 cm.
fn coarse() -> VolumeParams {
    VolumeParams { cells: 24, ..VolumeParams::default() }
}

/// The same grid without any force.
fn none() -> VolumeParams {
    VolumeParams { sound_speed: 0.0, friction: 0.0, ..coarse() }
}

/// The mean of a number of the free halves of strands.
fn mean(positions: &[Vec4], of: impl Fn(Vec3) -> f32) -> f32 {
    let half = usize::from(VERTICES) / 2;
    let free: Vec<f32> = positions
        .chunks(usize::from(VERTICES))
        .flat_map(|strand| strand[half..].iter().map(|point| of(point.truncate())))
        .collect();
    free.iter().sum::<f32>() / free.len() as f32
}

/// The farthest that any vertex moves in one more sub-step, m.
fn unrest(rig: &mut Rig, dt: f64) -> f32 {
    let before = rig.positions(0);
    rig.frame(&StepInput::new(dt, Pose::IDENTITY));
    let after = rig.positions(0);
    before.iter().zip(&after).map(|(a, b)| a.truncate().distance(b.truncate())).fold(0.0, f32::max)
}

/// The mean distance of the free halves from their mean, along an axis.
fn thickness(positions: &[Vec4], axis: usize) -> f32 {
    let middle = mean(positions, |point| point[axis]);
    mean(positions, |point| (point[axis] - middle).abs())
}

#[test]
fn a_block_of_strands_that_falls_together_keeps_its_thickness() {
    let floor = Capsule { a: Vec3::new(0.1, -1.0, -1.0), b: Vec3::new(0.1, -1.0, 1.0), radius_a: 1.0, radius_b: 1.0 };
    let strands = block();
    // It hangs down from its wall, where it was thick along y, or lies on a floor.
    let cases = [(Solver::Direct, false, 1.0), (Solver::TressFx, false, 1.0), (Solver::Direct, true, 0.5)];
    for (solver, lies, rest_density) in cases {
        let mut found = [0.0; 2];
        for (found, volume) in found.iter_mut().zip([none(), VolumeParams { rest_density, ..coarse() }]) {
            let Some(mut rig) = rig(&strands, soft(), solver, &volume) else { return };
            rig.capsules = if lies { vec![floor] } else { vec![] };
            rig.play(&Motion::still(&strands), 1.5, 60);
            *found = thickness(&rig.world(0), usize::from(lies));
            assert_eq!(rig.non_finite(), 0);
        }
        let rest = thickness(&strands.rest, 1);
        println!("{solver:?}, lies: {lies}: {rest:.4} m at rest, {found:.4?} without and with");
        let least = if lies { 2.0 } else { 5.0 };
        assert!(found[1] > least * found[0] && found[1] < 2.0 * rest, "{solver:?}, {lies}: {found:?} of {rest}");
    }
}

#[test]
fn curls_do_not_collapse_into_a_sheet() {
    let strands = curly_block(0.01);
    let volume_of = |positions: &[Vec4]| [0, 1, 2].map(|axis| thickness(positions, axis)).iter().product::<f32>();
    let mut found = [(0.0, 0.0); 2];
    for (found, volume) in found.iter_mut().zip([none(), coarse()]) {
        let params = SimParams { bending_length: 0.05, ..soft() };
        let Some(mut rig) = rig(&strands, params, Solver::Direct, &volume) else { return };
        rig.play(&Motion::still(&strands), 1.5, 60);
        let world = rig.world(0);
        *found = (thickness(&world, 0), volume_of(&world));
    }
    let rest = (thickness(&strands.rest, 1), volume_of(&strands.rest));
    println!("curls: thickness in m and volume in m^3 {rest:?} at rest, {found:?} without and with");
    let [without, with] = found;
    assert!(with.0 > 1.5 * without.0 && with.1 > 1.5 * without.1, "{found:?} of {rest:?}");
}

/// Strands from one line, 2.5 mm apart, that lean to the sides by these angles, in turns.
fn leaning(angles: [f32; 2]) -> Strands {
    let strand = |i: u16| {
        let root = Vec3::Z * 0.0025 * f32::from(i);
        let (sin, cos) = angles[usize::from(i % 2)].sin_cos();
        let at = |v: u16| root + Vec3::new(sin, -cos, 0.0) * LENGTH * f32::from(v) / f32::from(VERTICES - 1);
        (0..VERTICES).map(at).collect()
    };
    strands(&(0..80).map(strand).collect::<Vec<Vec<Vec3>>>())
}

/// The largest mean distance to the side of the strands of either kind, over the second second.
fn swing(strands: &Strands, friction: f32) -> Option<f32> {
    let params = SimParams { air_drag: 0.0, bending_length: 0.01, ..soft() };
    let volume = VolumeParams { friction, ..none() };
    let mut rig = rig(strands, params, Solver::Direct, &volume)?;
    let motion = Motion::still(strands);
    rig.play(&motion, 1.0, 60);
    let mut largest = 0.0_f32;
    for _ in 0..60 {
        rig.frame(&StepInput::new(1.0 / 60.0, Pose::IDENTITY));
        let world = rig.world(0);
        let kind: Vec<Vec4> = world.chunks(usize::from(VERTICES)).step_by(2).flatten().copied().collect();
        largest = largest.max(mean(&kind, |point| point.x).abs());
    }
    Some(largest)
}

#[test]
fn friction_takes_the_motion_of_bundles_that_cross_and_not_what_they_have_in_common() {
    let (crossing, together) = (leaning([0.5, -0.5]), leaning([0.5, 0.5]));
    let swings = [(&crossing, 0.0), (&crossing, 10.0), (&together, 0.0), (&together, 10.0)];
    let found: Vec<_> = swings.iter().filter_map(|(strands, friction)| swing(strands, *friction)).collect();
    let [crossing, rubbing, together, in_common] = found[..] else { return };
    println!(
        "crossing {crossing:.3} m, with friction {rubbing:.3}; together {together:.3} m, with friction {in_common:.3}"
    );
    assert!(crossing > 0.04 && rubbing < 0.5 * crossing, "{crossing} {rubbing}");
    assert!(in_common > 0.85 * together, "{together} {in_common}");
}

#[test]
fn nothing_shakes_at_any_sub_step_and_stiffness() {
    let strands = block();
    let hard = VolumeParams { sound_speed: 100.0, friction: 1000.0, ..coarse() };
    let soft_and_hard = [(Solver::Direct, coarse()), (Solver::Direct, hard.clone()), (Solver::TressFx, hard)];
    for (solver, volume) in soft_and_hard {
        for sub_step in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 144.0] {
            let Some(mut rig) = rig(&strands, soft(), solver, &volume) else { return };
            rig.sim.set_clock_params(ClockParams { sub_step, ..ClockParams::default() }).unwrap();
            rig.play(&Motion::still(&strands), 2.0, 30);
            let speed = unrest(&mut rig, sub_step) as f64 / sub_step;
            println!("{solver:?}, {sub_step:.4} s, {} m/s: {speed:.4} m/s", volume.sound_speed);
            assert_eq!(rig.non_finite(), 0);
            assert!(speed < 0.03, "{solver:?}, {sub_step}, {}: {speed} m/s", volume.sound_speed);
        }
    }
}

#[test]
fn frame_rates_end_in_the_same_place() {
    let strands = block();
    let end = |fps: u32| {
        let mut rig = rig(&strands, soft(), Solver::Direct, &coarse())?;
        rig.play(&Motion::still(&strands), 1.0, fps);
        Some(rig.positions(0))
    };
    let Some(expected) = end(60) else { return };
    // The head stands still: the same sub-steps, cut into other frames.
    for fps in [30, 144] {
        assert!(end(fps) == Some(expected.clone()), "{fps}");
    }
}
