//! Colliders that are given with each frame: poses of their own, friction, and which sections see them.

mod support;

use glam::{Quat, Vec3, Vec4};
use support::{rig, rig_of_sections};
use tressfx_conformance::sim::{Motion, Rig, random_strands, strands_of};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::{Collider, HairSim, SectionDesc, SimError, SimParams, StepInput};

const DT: f64 = 1.0 / 60.0;

fn ball(at: Vec3, radius: f32) -> Capsule {
    Capsule { a: at, b: at, radius_a: radius, radius_b: radius }
}

fn at(translation: Vec3) -> Pose {
    Pose { translation, ..Pose::IDENTITY }
}

/// Straight strands that hang from a row of roots, in metres.
fn curtain() -> Strands {
    let points = (0..20)
        .flat_map(|strand| (0..12).map(move |vertex| [0.01 * (strand as f32 - 9.5), -0.02 * vertex as f32, 0.0]));
    strands_of(HairAsset::new("curtain", AssetFormat::Builtin, points.collect(), vec![12; 20]), 0)
}

fn limp() -> SimParams {
    SimParams { global_stiffness: 0.0, local_stiffness: 0.0, ..SimParams::default() }
}

/// A frame in which a collider goes from one place to another, on a head at rest.
fn frame(rig: &mut Rig, capsule: Capsule, from: Pose, to: Pose) {
    rig.frame(&StepInput::new(DT, Pose::IDENTITY).with_colliders(&[Collider::free(capsule, from, to)]));
}

/// Room for one collider, which every frame brings itself.
fn with_room(strands: Strands, params: SimParams) -> Option<Rig> {
    let mut rig = rig(strands, params, &[ball(Vec3::ZERO, 0.0)])?;
    rig.capsules.clear();
    rig.frame(&StepInput::new(0.0, Pose::IDENTITY));
    Some(rig)
}

#[test]
fn a_collider_that_moves_by_itself_takes_hair_along() {
    let Some(mut rig) = with_room(curtain(), limp()) else { return };
    let place = |frame: u32| at(Vec3::new(0.0, -0.1, -0.1 + 0.005 * frame as f32));
    for index in 0..30 {
        frame(&mut rig, ball(Vec3::ZERO, 0.05), place(index), place(index + 1));
    }
    let (positions, center) = (rig.world(0), place(30).translation);
    let deepest = positions.iter().map(|point| point.truncate().distance(center) - 0.05).fold(f32::INFINITY, f32::min);
    let furthest = positions.iter().map(|point| point.z).fold(0.0, f32::max);
    println!("deepest {deepest:e} m, furthest {furthest} m");
    assert!(deepest > -1e-5, "{deepest}");
    assert!(furthest > 0.05, "the curtain is pushed aside: {furthest}");
}

/// How far a curtain goes along a bar that it lies on, where it touches it, while the bar moves along its axis.
fn dragged(friction: f32, speed: f32) -> Option<f32> {
    let mut rig = with_room(curtain(), SimParams { friction, ..limp() })?;
    let bar = Capsule { a: Vec3::X * -3.0, b: Vec3::X * 3.0, radius_a: 0.06, radius_b: 0.06 };
    let place = |seconds: f64| at(Vec3::new(speed * seconds as f32, -0.12, -0.03));
    for index in 0..30 {
        frame(&mut rig, bar, place(f64::from(index) * DT), place(f64::from(index + 1) * DT));
    }
    let (rest, now) = (rig.strands[0].rest.clone(), rig.world(0));
    Some(now.chunks(12).zip(rest.chunks(12)).map(|(now, rest)| now[6].x - rest[6].x).sum::<f32>() / 20.0)
}

#[test]
fn friction_is_against_the_motion_of_the_collider() {
    let Some(forth) = dragged(0.4, 0.5) else { return };
    let [back, ice, still] =
        [(0.4, -0.5), (0.0, 0.5), (0.4, 0.0)].map(|(friction, speed)| dragged(friction, speed).unwrap());
    println!("{forth} m forth, {back} m back, {ice} m on ice, {still} m on a bar at rest");
    assert!(forth > 5e-3 && back < -5e-3, "{forth} {back}");
    assert!(ice.abs() < 1e-4 && still.abs() < 1e-4, "{ice} {still}");
}

/// Hair that lies on a head in even motion, with shock 1: as on a head at rest, since nothing slides.
#[test]
fn an_even_head_does_not_rub_its_hair() {
    let params = SimParams { shock: 1.0, friction: 1.0, ..limp() };
    let run = |speed: f32| -> Option<Vec<Vec4>> {
        let head = ball(Vec3::ZERO, 0.0995);
        let mut rig = rig(random_strands(60, 16, 0, 8), params.clone(), &[head])?;
        for frame in 0..60 {
            let pose = at(Vec3::X * (speed * (f64::from(frame) * DT) as f32));
            rig.frame(&StepInput::new(if frame == 0 { 0.0 } else { DT }, pose));
        }
        Some(rig.positions(0))
    };
    let (Some(still), Some(moving)) = (run(0.0), run(5.0)) else { return };
    let mut apart: Vec<f32> = still.iter().zip(&moving).map(|(one, other)| one.distance(*other)).collect();
    apart.sort_by(f32::total_cmp);
    let (most, largest) = (apart[apart.len() * 9 / 10], apart[apart.len() - 1]);
    println!("{most:e} m (90 %), {largest:e} m (largest)");
    assert!(most < 1e-4, "{most:e} m");
}

#[test]
fn a_collider_with_the_poses_of_the_head_is_one_that_moves_with_it() {
    let strands = random_strands(60, 16, 0, 4);
    let post = Capsule { a: Vec3::new(0.0, -0.1, 0.0), b: Vec3::new(0.05, 0.1, 0.0), radius_a: 0.098, radius_b: 0.05 };
    let motion = Motion { shake: 0.02, ..Motion::turning(&strands) };
    let run = |free: bool| {
        let mut rig = with_room(strands.clone(), SimParams::default())?;
        // 120 frames a second: between frames a head goes along a curve, and a collider does not.
        for frame in 1..=60 {
            let [from, to] = [frame - 1, frame].map(|frame| motion.head(f64::from(frame) / 120.0));
            let collider = if free { Collider::free(post, from, to) } else { Collider::with_head(post) };
            rig.frame(&StepInput::new(1.0 / 120.0, to).with_colliders(&[collider]));
        }
        Some(rig.positions(0))
    };
    let (Some(free), Some(with_head)) = (run(true), run(false)) else { return };
    let mut apart: Vec<f32> = free.iter().zip(&with_head).map(|(one, other)| one.distance(*other)).collect();
    apart.sort_by(f32::total_cmp);
    let (most, largest) = (apart[apart.len() * 99 / 100], apart[apart.len() - 1]);
    println!("{most:e} m (99 %), {largest:e} m (largest)");
    assert!(most < 1e-4, "{most:e} m");
}

#[test]
fn sections_and_frames_choose_their_colliders() {
    let sections = || vec![(curtain(), limp()), (curtain(), limp())];
    let block = ball(Vec3::new(0.0, -0.1, 0.02), 0.06);
    let Some(mut rig) = rig_of_sections(sections(), &[block]) else { return };
    rig.capsules.clear();
    let mut deepest = |colliders: &[Collider]| {
        for frame in 0..30 {
            rig.frame(&StepInput::new(if frame == 0 { 0.0 } else { DT }, Pose::IDENTITY).with_colliders(colliders));
        }
        [0, 1].map(|section| {
            let positions = rig.world(section);
            positions.iter().map(|point| block.distance(point.truncate())).fold(f32::INFINITY, f32::min)
        })
    };
    let [one, other] = deepest(&[Collider { except: &[1], ..Collider::with_head(block) }]);
    assert!(one > -1e-5 && other < -0.02, "the first section collides, the second does not: {one} {other}");
    let both = deepest(&[Collider::with_head(block)]);
    assert!(both.iter().all(|depth| *depth > -1e-5), "now both do: {both:?}");
    let none = deepest(&[]);
    assert!(none.iter().all(|depth| *depth < -0.02), "and now none: {none:?}");
}

#[test]
fn colliders_come_and_go_without_new_kernels_and_not_beyond_their_number() {
    let mut backend = NullBackend::default();
    let (strands, mut list) = (curtain(), PassList::new());
    let mut sim = HairSim::new(&mut backend, &mut list, &[SectionDesc::new(&strands, limp())], 2).unwrap();
    let (made, ball) = (backend.shaders.len(), Collider::with_head(ball(Vec3::ZERO, 0.1)));
    for count in [0, 2, 1, 0, 2] {
        let colliders = vec![ball; count];
        sim.step(&mut list, &StepInput::new(DT, Pose::IDENTITY).with_colliders(&colliders)).unwrap();
    }
    assert_eq!(backend.shaders.len(), made);
    let error = sim.step(&mut list, &StepInput::new(DT, Pose::IDENTITY).with_colliders(&[ball; 3])).unwrap_err();
    assert_eq!(error, SimError::TooManyColliders { given: 3, most: 2 });
    let rotation = Quat::from_xyzw(0.0, 2.0, 0.0, 0.0);
    let wrong = Collider::free(ball.shape, Pose::IDENTITY, Pose { rotation, ..Pose::IDENTITY });
    let error = sim.step(&mut list, &StepInput::new(DT, Pose::IDENTITY).with_colliders(&[wrong])).unwrap_err();
    assert_eq!(error, SimError::NoRotation { name: "collider.rotation", length: 2.0 });
    let unsound = Collider::with_head(Capsule { a: Vec3::ZERO, b: Vec3::ZERO, radius_a: -1.0, radius_b: 0.1 });
    let error = sim.step(&mut list, &StepInput::new(DT, Pose::IDENTITY).with_colliders(&[unsound])).unwrap_err();
    assert_eq!(error, SimError::UnsoundCapsule { index: 0 });
}

/// Two sections of one shape run the same kernels.
#[test]
fn sections_share_their_kernels() {
    let compiled = |sections: &[SectionDesc]| {
        let mut backend = NullBackend::default();
        HairSim::new(&mut backend, &mut PassList::new(), sections, 1).unwrap();
        backend.shaders.len()
    };
    let (short, long) = (random_strands(10, 6, 1, 1), random_strands(30, 11, 2, 2));
    let descs = [&short, &long].map(|strands| SectionDesc::new(strands, SimParams::default()));
    let of_one = compiled(&descs[..1]);
    assert_eq!(compiled(&descs), of_one);
}
