//! Frames in which the head is known in between.

mod support;

use glam::{DVec3, Vec3, Vec4};
use tressfx_conformance::sim::{Motion, Rig, random_strands, strand_errors};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::{Collider, HairSim, SectionDesc, SimError, SimParams, Solver, Stage, StepInput, reference};

use support::gpu;

fn strands() -> Strands {
    random_strands(40, 16, 1, 3)
}

/// The head at as many poses of a frame, of which the last one is its end.
fn poses(motion: &Motion, frame: u32, fps: u32, poses: u32) -> Vec<Pose> {
    let at = |pose: u32| motion.head((f64::from(frame) - f64::from(pose) / f64::from(poses)) / f64::from(fps));
    (0..poses).rev().map(at).collect()
}

/// Half a second at a frame rate with so many poses a frame, on the GPU and in f64.
fn moved(fps: u32, count: u32) -> Option<(Vec<Vec4>, Vec<DVec3>)> {
    let (strands, params) = (strands(), SimParams::default());
    let motion = Motion::wild(&strands);
    let ball = Capsule { a: Vec3::Y * -0.1, b: Vec3::Y * -0.12, radius_a: 0.03, radius_b: 0.03 };
    let mut rig = Rig::with_colliders(gpu()?, strands.clone(), params.clone(), Solver::Direct, &[], 1);
    let desc = SectionDesc::new(&strands, params).with_solver(Solver::Direct);
    let mut reference = reference::Simulation::new(&[desc]).unwrap();
    for frame in 0..=fps / 2 {
        let seconds = |frame: u32| f64::from(frame) / f64::from(fps);
        // On its own path, between the frames at even speed.
        let place = |frame: u32| Pose { translation: Vec3::X * (0.2 * seconds(frame) as f32 - 0.1), ..Pose::IDENTITY };
        let collider = [Collider::free(ball, place(frame.saturating_sub(1)), place(frame))];
        let path = poses(&motion, frame, fps, count);
        let (head, path) = path.split_last().unwrap();
        let dt = if frame == 0 { 0.0 } else { seconds(1) };
        let input = StepInput { head: *head, ..motion.input(0.0, dt) }.with_path(path).with_colliders(&collider);
        rig.frame(&input);
        reference.step(&input).unwrap();
    }
    Some((rig.positions(0), reference.positions(0)))
}

#[test]
fn poses_within_a_frame_are_as_good_as_more_frames() {
    let (Some(many), Some(few)) = (moved(60, 1), moved(20, 3)) else { return };
    let apart = strand_errors(&strands(), &few.0, &many.1);
    let reference = many.1.iter().zip(&few.1).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
    println!(
        "20 frames a second with 3 poses, from 60 with one: {:.1e} of length, in f64 {reference:.1e} m",
        apart[apart.len() / 2]
    );
    assert!(reference < 1e-5 && apart[apart.len() * 9 / 10] < 1e-3, "{reference:e} {apart:?}");
    let Some(unknown) = moved(20, 1) else { return };
    let off = many.1.iter().zip(&unknown.1).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
    assert!(off > 30.0 * reference, "{off} m where the poses are not known");
}

#[test]
fn what_ends_a_frame_is_computed_once() {
    let (mut backend, mut list, strands) = (NullBackend::default(), PassList::new(), strands());
    let mut sim =
        HairSim::new(&mut backend, &mut list, &[SectionDesc::new(&strands, SimParams::default())], 0).unwrap();
    let path = [Pose::IDENTITY; 2];
    sim.step(&mut list, &StepInput::new(0.0, Pose::IDENTITY)).unwrap();
    list.clear_commands();
    let report = sim.step(&mut list, &StepInput::new(1.0 / 20.0, Pose::IDENTITY).with_path(&path)).unwrap();
    let expected = [vec![Stage::Direct.label(); 6], vec![Solver::FRAME_END.label()]].concat();
    assert_eq!((report.sub_steps, list.labels().collect::<Vec<_>>()), (6, expected));
    let nowhere = [Pose { translation: Vec3::NAN, ..Pose::IDENTITY }];
    let error = sim.step(&mut list, &StepInput::new(0.1, Pose::IDENTITY).with_path(&nowhere)).unwrap_err();
    assert_eq!(error, SimError::NonFinite { name: "head.translation" });
}
