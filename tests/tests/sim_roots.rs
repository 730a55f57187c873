//! Roots that have transforms of their own.

mod support;

use glam::{Quat, Vec3, Vec4};
use support::gpu;
use tressfx_conformance::sim::{Motion, Rig, random_strands, strand_errors, wide};
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::{SectionDesc, SimError, SimParams, Solver, StepInput, reference};

fn strands() -> Strands {
    random_strands(40, 16, 1, 21)
}

fn own_roots(params: SimParams) -> Option<Rig> {
    Some(Rig::with_own_roots(gpu()?, strands(), params))
}

/// A frame with these roots.
fn frame(rig: &mut Rig, dt: f64, head: Pose, roots: &[Pose]) {
    rig.run(|sim, list| {
        sim.set_roots(list, 0, roots).expect("the roots are fine");
        sim.step(list, &StepInput::new(dt, head)).expect("the input is fine");
    });
}

/// The time of a frame, and how long it is.
fn times(frames: u32, fps: u32) -> impl Iterator<Item = (f64, f64)> {
    (0..=frames)
        .map(move |frame| (f64::from(frame) / f64::from(fps), if frame == 0 { 0.0 } else { 1.0 / f64::from(fps) }))
}

fn furthest(one: &[Vec4], other: &[Vec4]) -> f32 {
    one.iter().zip(other).map(|(one, other)| one.truncate().distance(other.truncate())).fold(0.0, f32::max)
}

#[test]
fn roots_that_ride_on_the_head_move_as_the_head() {
    let Some(mut own) = own_roots(SimParams::default()) else { return };
    let mut head = Rig::new(gpu().unwrap(), vec![(strands(), SimParams::default())], &[]);
    let motion = Motion::wild(&strands());
    own.play(&motion, 0.5, 60);
    head.play(&motion, 0.5, 60);
    let apart = furthest(&own.positions(0), &head.positions(0));
    println!("{apart:e} m");
    assert!(apart < 2e-6, "{apart:e} m");
}

#[test]
fn equal_transforms_of_all_roots_are_a_head() {
    // At 120 frames a second each has one sub-step. At fewer, roots go along the curve that the head takes; quaternions are not on quite the
    // curve that rotation vectors are on.
    for (fps, allowed) in [(120, 2e-6), (144, 1e-5), (60, 1e-5), (30, 1e-4)] {
        let Some(mut own) = own_roots(SimParams::default()) else { return };
        let mut head = Rig::new(gpu().unwrap(), vec![(strands(), SimParams::default())], &[]);
        let motion = Motion { wind: None, ..Motion::wild(&strands()) };
        for (seconds, dt) in times(fps / 2, fps) {
            let pose = motion.head(seconds);
            head.frame(&StepInput::new(dt, pose));
            frame(&mut own, dt, Pose::IDENTITY, &[pose; 40]);
        }
        let apart = furthest(&own.world(0), &head.world(0));
        println!("{fps} frames a second: {apart:e} m");
        assert!(apart < allowed, "{fps} frames a second: {apart:e} m");
    }
}

/// A scalp that turns about the vertical axis, the higher the further.
fn twisted(strands: &Strands, seconds: f64) -> Vec<Pose> {
    let roots = strands.rest.chunks(strands.vertices as usize).map(|strand| strand[0]);
    let angle = |root: Vec4| 6.0 * root.y * (2.0 * seconds).sin() as f32;
    roots.map(|root| Pose { rotation: Quat::from_rotation_y(angle(root)), translation: Vec3::Y * 0.01 }).collect()
}

#[test]
fn rigid_hair_follows_the_roots_of_a_twisting_scalp() {
    let rigid =
        SimParams { gravity: Vec3::ZERO, global_stiffness: 1.0, global_range: 1.0, shock: 1.0, ..SimParams::default() };
    let Some(mut rig) = own_roots(rigid) else { return };
    let motion = Motion::turning(&strands());
    let mut roots = Vec::new();
    for (seconds, dt) in times(60, 60) {
        roots = twisted(&strands(), seconds);
        frame(&mut rig, dt, motion.head(seconds), &roots);
    }
    let (positions, strands, head) = (rig.world(0), strands(), motion.head(0.5 * 2.0));
    let angles = roots.iter().map(|root| root.rotation.to_axis_angle().1);
    assert!(angles.fold(0.0, f32::max) > 0.3, "the scalp is twisted");
    // Guides, then follow strands: both turn with the root of the guide.
    for (strand, points) in positions.chunks(16).enumerate() {
        let root = roots[strand % 40];
        for (vertex, point) in points.iter().enumerate() {
            // Away from the root the pull is not full, and the turn of each sub-step leaves hair a little behind.
            let allowed = if vertex == 0 { 2e-6 } else { 5e-3 };
            let rest = strands.rest_of_all()[strand * 16 + vertex].truncate();
            let expected = head.transform(root.transform(rest));
            let off = point.truncate().distance(expected);
            let spreads = strand >= 40 && vertex > 0;
            assert!(off < allowed || spreads, "strand {strand} vertex {vertex}: {off} m off");
        }
    }
}

#[test]
fn a_twisting_scalp_matches_the_reference() {
    let Some(mut rig) = own_roots(SimParams::default()) else { return };
    let strands = strands();
    let motion = Motion::turning(&strands);
    let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::TressFx).with_own_roots();
    let mut reference = reference::Simulation::new(&[desc]).unwrap();
    for (seconds, dt) in times(30, 60) {
        let (head, roots) = (motion.head(seconds), twisted(&strands, seconds));
        frame(&mut rig, dt, head, &roots);
        reference.set_roots(0, &roots);
        reference.step(&StepInput::new(dt, head)).unwrap();
    }
    let errors = strand_errors(&strands, &rig.positions(0), &reference.positions(0));
    let (median, largest) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    println!("after 60 sub-steps {median:.1e} (median), {largest:.1e} (largest) of strand length");
    assert!(largest < 1e-3, "{largest:e}");
    let (points, tangents) = (wide(&rig.positions(0)), rig.tangents(0));
    for (tangent, expected) in tangents.iter().zip(points.chunks(16).flat_map(reference::tangents)) {
        assert!(tangent.truncate().as_dvec3().distance(expected) < 1e-4, "{tangent}, not {expected}");
    }
}

/// Frames of one and a half sub-steps: every second one ends amid a sub-step.
const ODD: f64 = 1.5 / 120.0;

#[test]
fn a_root_that_jumps_goes_little_astray() {
    let strands = strands();
    let Some(mut rig) = own_roots(SimParams::default()) else { return };
    let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::TressFx).with_own_roots();
    let mut reference = reference::Simulation::new(&[desc]).unwrap();
    let centre = rig.sim.center();
    let mut worst = 0.0_f32;
    for step in 0..24_u8 {
        // A jump of 100 m and half a turn, and a millimetre more in each frame behind it.
        let jumped = if step < 8 { 0.0 } else { 100.0 + 0.001 * f32::from(step) };
        let turn = if step < 8 { 0.0 } else { 3.0 + 0.01 * f32::from(step) };
        let pose = Pose { rotation: Quat::from_rotation_y(turn), translation: Vec3::X * jumped };
        let dt = if step == 0 { 0.0 } else { ODD };
        frame(&mut rig, dt, Pose::IDENTITY, &[pose; 40]);
        reference.set_roots(0, &[pose; 40]);
        reference.step(&StepInput::new(dt, Pose::IDENTITY)).unwrap();
        let (positions, expected) = (rig.positions(0), reference.positions(0));
        for guide in 0..40 {
            let root = positions[guide * 16].truncate();
            let apart = root.as_dvec3().distance(expected[guide * 16]);
            assert!(apart < 1e-4, "frame {step}, guide {guide}: {apart} m from the f64 function");
            let rest = strands.rest[guide * 16].truncate();
            let goal = pose.transform(rest) - centre;
            worst = if step > 8 { worst.max(root.distance(goal)) } else { worst };
        }
    }
    // Within a frame 1,000 m/s^2 lead 2 cm away from the line, and a quarter of a quaternion turns a root at most so far about the centre.
    println!("{worst} m");
    assert!(worst < 0.02 + 0.001 + 0.6 * 0.2, "{worst} m");
}

#[test]
fn roots_that_do_not_fit_are_refused() {
    let Some(mut rig) = own_roots(SimParams::default()) else { return };
    let none = Pose { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..Pose::IDENTITY };
    let mut error = |section, poses: &[Pose]| rig.run(|sim, list| sim.set_roots(list, section, poses)).unwrap_err();
    assert_eq!(error(1, &[]), SimError::NoSection { index: 1, count: 1 });
    assert_eq!(error(0, &[Pose::IDENTITY; 3]), SimError::RootCount { given: 3, expected: 40 });
    assert_eq!(error(0, &[none; 40]), SimError::NoRotation { name: "root.rotation", length: 0.0 });
    let mut head = Rig::new(gpu().unwrap(), vec![(strands(), SimParams::default())], &[]);
    let error = head.run(|sim, list| sim.set_roots(list, 0, &[Pose::IDENTITY; 40])).unwrap_err();
    assert_eq!(error, SimError::RootCount { given: 40, expected: 0 });
}
