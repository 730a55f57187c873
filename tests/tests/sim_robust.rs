//! What is left out changes nothing, and what is thrown at the simulation does not break it.

mod support;

use glam::{Quat, Vec3, Vec4, Vec4Swizzles};
use tressfx_conformance::sim::{Motion, REAL, builtin, random_strands, real, strands_of};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::step::Step;
use tressfx_sim::{
    ClockParams, Collider, HairSim, RootTransform, SectionDesc, SimError, SimParams, Solver, Stage, StepInput, Wind,
    metrics,
};

use support::{rig, rig_of_sections};

fn strands() -> Strands {
    random_strands(65, 12, 1, 11)
}

/// The state after half a second of a motion.
fn state(params: SimParams, capsules: &[Capsule], motion: &Motion) -> Option<(Vec<Vec4>, Vec<Vec4>)> {
    let mut rig = rig(strands(), params, capsules)?;
    rig.play(motion, 0.5, 60);
    Some((rig.positions(0), rig.previous(0)))
}

fn labels(params: SimParams, capsules: &[Capsule], strands: &Strands, motion: &Motion) -> Vec<&'static str> {
    let mut backend = NullBackend::default();
    let mut list = PassList::new();
    let colliders = Collider::all_with_head(capsules);
    let sections = [SectionDesc::new(strands, params).with_solver(Solver::TressFx)];
    let mut sim = HairSim::new(&mut backend, &mut list, &sections, colliders.len()).unwrap();
    sim.step(&mut list, &motion.input(0.0, 0.0).with_colliders(&colliders)).unwrap();
    list.clear_commands();
    sim.step(&mut list, &motion.input(1.0 / 120.0, 1.0 / 120.0).with_colliders(&colliders)).unwrap();
    list.labels().collect()
}

/// Whatever acts so little that it changes no bit.
const NEXT_TO_NOTHING: f32 = 1e-30;

#[test]
fn what_has_no_effect_changes_no_bit() {
    let params = SimParams::default();
    let motion = Motion::wild(&strands());
    let zero = SimParams { local_stiffness: 0.0, ..params.clone() };
    let tiny = SimParams { local_stiffness: NEXT_TO_NOTHING, ..params.clone() };
    assert_eq!(state(zero, &[], &motion), state(tiny, &[], &motion), "local shape");
    let zero = SimParams { wind_drag: 0.0, ..params.clone() };
    let tiny = SimParams { wind_drag: NEXT_TO_NOTHING, ..params.clone() };
    assert_eq!(state(zero, &[], &motion), state(tiny, &[], &motion), "wind");
    let far = Capsule { a: Vec3::splat(9.0), b: Vec3::splat(9.5), radius_a: 1.0, radius_b: 0.5 };
    assert_eq!(state(params.clone(), &[], &motion), state(params.clone(), &[far], &motion), "capsules");
    let zero = SimParams { global_stiffness: 0.0, ..params.clone() };
    let tiny = SimParams { global_stiffness: NEXT_TO_NOTHING, ..params };
    assert_eq!(state(zero, &[], &motion), state(tiny, &[], &motion), "global shape");
}

#[test]
fn a_sub_step_is_one_pass_and_a_frame_one_more() {
    let motion = Motion::wild(&strands());
    let capsule = Capsule { a: Vec3::ZERO, b: Vec3::Y, radius_a: 0.1, radius_b: 0.1 };
    for capsules in [&[][..], &[capsule]] {
        let expected = [Stage::TressFx, Stage::Tangents].map(Stage::label);
        assert_eq!(labels(SimParams::default(), capsules, &strands(), &motion), expected);
    }
}

#[test]
fn no_wind_is_a_wind_of_no_speed() {
    let still_air = Motion { wind: Some(Wind::default()), ..Motion::wild(&strands()) };
    let none = Motion { wind: None, ..still_air.clone() };
    assert_eq!(state(SimParams::default(), &[], &still_air), state(SimParams::default(), &[], &none));
}

#[test]
fn guides_do_not_care_for_their_follow_strands() {
    let guides = |follows| {
        let mut rig = rig(random_strands(65, 12, follows, 11), SimParams::default(), &[])?;
        let motion = Motion::wild(&rig.strands[0]);
        rig.play(&motion, 0.3, 60);
        Some(rig.positions(0)[..65 * 12].to_vec())
    };
    let alone = guides(0);
    assert_eq!(alone, guides(3));
}

#[test]
fn a_head_that_has_not_moved_gives_no_shock() {
    let motion = Motion::still(&strands());
    let shocked = |shock: f32| state(SimParams { shock, ..SimParams::default() }, &[], &motion);
    let [Some(without), Some(with)] = [shocked(0.0), shocked(1.0)] else { return };
    assert_eq!(without, with);
}

#[test]
fn a_groom_moves_far_from_the_origin_as_it_does_there() {
    let far = Vec3::new(4096.0, -8192.0, 1024.0);
    let wind = Motion { shake: 0.0, turn: 0.0, ..Motion::wild(&strands()) };
    let turn = |frame: u32| Quat::from_rotation_y(0.3 * (0.2 * frame as f32).sin());
    let run = |translation: Vec3, turns: bool| {
        let mut rig = rig(strands(), SimParams::default(), &[])?;
        for frame in 0..30 {
            let rotation = if turns { turn(frame) } else { Quat::IDENTITY };
            rig.frame(&StepInput { head: Pose { rotation, translation }, ..wind.input(0.0, 1.0 / 60.0) });
        }
        Some(rig.positions(0))
    };
    assert_eq!(run(Vec3::ZERO, false), run(far, false));
    let (Some(here), Some(there)) = (run(Vec3::ZERO, true), run(far, true)) else { return };
    let error = here.iter().zip(&there).map(|(here, there)| here.distance(*there)).fold(0.0, f32::max);
    assert!(error < 1e-6, "a head that turns about a far place: {error:e} m");
}

#[test]
fn sections_of_different_shapes_do_not_disturb_each_other() {
    let sections = || {
        let stiff = SimParams { global_stiffness: 0.6, ..SimParams::default() };
        vec![(random_strands(65, 12, 1, 11), SimParams::default()), (random_strands(40, 31, 2, 12), stiff)]
    };
    let Some(mut both) = rig_of_sections(sections(), &[]) else { return };
    let motion = Motion::wild(&both.strands[0]);
    both.play(&motion, 0.3, 60);
    for (index, (strands, params)) in sections().into_iter().enumerate() {
        let mut alone = rig(strands, params, &[]).unwrap();
        alone.play(&motion, 0.3, 60);
        // Both have a centre of their own, relative to which positions are rounded.
        let pairs = alone.world(0).into_iter().zip(both.world(index));
        let error = pairs.map(|(alone, both)| alone.distance(both)).fold(0.0, f32::max);
        assert!(error < 2e-6, "section {index}: {error:e} m");
    }
}

#[test]
fn vertices_end_outside_of_capsules() {
    let ball = Capsule { a: Vec3::ZERO, b: Vec3::Y * 0.02, radius_a: 0.098, radius_b: 0.09 };
    let post = Capsule { a: Vec3::new(0.2, -0.5, 0.0), b: Vec3::new(0.2, 0.5, 0.0), radius_a: 0.05, radius_b: 0.02 };
    let soft = SimParams { global_stiffness: 0.02, local_stiffness: 0.5, ..SimParams::default() };
    let Some(mut rig) = rig(random_strands(200, 24, 0, 4), soft, &[ball, post]) else { return };
    let motion = Motion::wild(&rig.strands[0]);
    rig.play(&motion, 1.0, 60);
    let (positions, to_head) = (rig.world(0), motion.head(1.0).inverse());
    let depth = |position: &Vec4| {
        let point = to_head.transform(position.truncate());
        ball.distance(point).min(post.distance(point))
    };
    let deepest = positions.iter().filter(|position| position.w > 0.0).map(depth).fold(f32::INFINITY, f32::min);
    let touching = positions.iter().filter(|position| depth(position).abs() < 1e-6).count();
    println!("deepest {deepest:.1e} m, {touching} vertices touch");
    assert!(deepest > -1e-5, "{deepest}");
    assert!(touching > 100, "{touching}");
}

#[test]
fn strands_that_are_pinned_at_both_ends_hang_between_them() {
    let mut strands = random_strands(64, 12, 0, 5);
    strands.rest.chunks_mut(12).for_each(|strand| strand[11].w = 0.0);
    let Some(mut rig) = rig(strands, SimParams::default(), &[]) else { return };
    let motion = Motion::wild(&rig.strands[0]);
    rig.play(&motion, 1.0, 60);
    let (positions, head) = (rig.world(0), motion.head(1.0));
    for (strand, rest) in positions.chunks(12).zip(rig.strands[0].rest.chunks(12)) {
        for vertex in [0, 11] {
            assert!(strand[vertex].truncate().distance(head.transform(rest[vertex].truncate())) < 1e-5);
        }
    }
    assert_eq!((metrics::non_finite(&positions), rig.non_finite()), (0, 0));
}

#[test]
fn friction_drags_along_what_lies_on_a_turning_head() {
    let ball = Capsule { a: Vec3::ZERO, b: Vec3::ZERO, radius_a: 0.099, radius_b: 0.099 };
    // How far, in all, vertices that touch the ball turn with it.
    let dragged = |friction| {
        let limp = SimParams { shock: 0.0, global_stiffness: 0.0, local_stiffness: 0.0, ..SimParams::default() };
        let mut rig = rig(random_strands(100, 16, 0, 8), SimParams { friction, ..limp }, &[ball])?;
        let motion = Motion::still(&rig.strands[0]);
        rig.play(&motion, 1.0, 60);
        let before = rig.world(0);
        let head = |frame: u32| Pose { rotation: Quat::from_rotation_y(0.01 * frame as f32), ..Pose::IDENTITY };
        for frame in 1..=20 {
            rig.frame(&StepInput::new(1.0 / 60.0, head(frame)));
        }
        let pairs = before.iter().zip(rig.world(0)).filter(|(before, _)| ball.distance(before.truncate()) < 1e-6);
        Some(pairs.map(|(before, after)| before.xz().perp_dot(after.xz())).sum::<f32>())
    };
    let Some(ice) = dragged(0.0) else { return };
    let rough = dragged(1.0).unwrap();
    println!("turned by {ice} on ice, by {rough} on what is rough");
    // A turn about y takes x to -z. The roots take hair along on ice too.
    assert!(ice < 0.0 && rough < 1.1 * ice, "what is rough drags hair along with its turn: {rough} {ice}");
}

#[test]
fn a_non_finite_vertex_resets_its_strand_and_is_counted() {
    let Some(mut rig) = rig(strands(), SimParams::default(), &[]) else { return };
    let motion = Motion::wild(&rig.strands[0]);
    rig.play(&motion, 0.2, 60);
    let (buffers, strand_count) = (rig.sim.buffers()[0], 130);
    for (guide, bad) in [(3u64, f32::NAN), (64, f32::INFINITY)] {
        rig.run(|_, list| list.upload(buffers.positions, 16 * (5 * strand_count + guide), &[bad]));
    }
    rig.frame(&motion.input(0.2 + 1.0 / 120.0, 1.0 / 120.0));
    let (positions, previous, world) = (rig.positions(0), rig.previous(0), rig.world(0));
    assert_eq!((metrics::non_finite(&positions), metrics::non_finite(&previous)), (0, 0));
    assert_eq!(rig.non_finite(), 2);
    let head = motion.head(0.2 + 1.0 / 120.0);
    for vertex in 0..12 {
        let rest = head.transform(rig.strands[0].rest[3 * 12 + vertex].truncate());
        assert!(world[3 * 12 + vertex].truncate().distance(rest) < 1e-5);
        assert_eq!(positions[3 * 12 + vertex].truncate(), previous[3 * 12 + vertex].truncate(), "at rest");
    }
    rig.play(&motion, 0.5, 60);
    assert_eq!(rig.non_finite(), 2, "only once");
}

#[test]
fn a_teleport_resets_and_a_fast_head_does_not() {
    let Some(mut rig) = rig(strands(), SimParams::default(), &[]) else { return };
    let at = |x: f32| Pose { translation: Vec3::X * x, ..Pose::IDENTITY };
    let report = rig.frame(&StepInput::new(0.0, at(0.0)));
    assert!(report.reset && !report.teleported);
    let report = rig.frame(&StepInput::new(1.0 / 60.0, at(0.2)));
    assert!(!report.reset && !report.teleported);
    let report = rig.frame(&StepInput::new(1.0 / 60.0, at(50.0)));
    assert!(report.reset && report.teleported);
    assert_eq!(rig.sim.resets(), 2);
    let shifted = rig.world(0)[..65 * 12]
        .iter()
        .zip(&rig.strands[0].rest)
        .map(|(position, rest)| position.truncate().distance(rest.truncate() + Vec3::X * 50.0))
        .fold(0.0, f32::max);
    assert!(shifted < 0.01, "two sub-steps from rest, in the new place: {shifted}");
    let turned = Pose { rotation: Quat::from_rotation_y(3.0), ..at(50.0) };
    assert!(rig.frame(&StepInput::new(1.0 / 60.0, turned)).teleported);
    rig.sim.reset();
    let report = rig.frame(&StepInput::new(1.0 / 60.0, turned));
    assert!(report.reset && !report.teleported);
    assert_eq!(rig.sim.resets(), 4);
}

#[test]
fn stress_leaves_strands_finite() {
    let extremes = [
        SimParams { local_stiffness: 0.0, global_stiffness: 0.0, ..SimParams::default() },
        SimParams { local_stiffness: 1.0, global_stiffness: 1.0, ..SimParams::default() },
        SimParams { gravity: Vec3::Y * 1000.0, max_speed: 1000.0, shock: 1.0, ..SimParams::default() },
        SimParams {
            damping: 0.0,
            length_iterations: 0,
            wind_drag: 1000.0,
            shock_acceleration: 0.0,
            ..SimParams::default()
        },
        SimParams { length_iterations: 16, local_iterations: 16, global_range: 0.1, ..SimParams::default() },
    ];
    for params in extremes {
        let Some(mut rig) = rig(strands(), params.clone(), &[]) else { return };
        let wind = Some(Wind::new(Vec3::new(1e6, 0.0, 1.0)));
        for frame in 0..60 {
            let dt = [1.0 / 60.0, 0.0, 10.0, -1.0, 1e-9][frame % 5];
            let rotation = Quat::from_rotation_y(1.9 * frame as f32);
            let head = Pose { rotation, translation: Vec3::X * (frame as f32 * 7.0).sin() };
            let report = rig.frame(&StepInput { wind, ..StepInput::new(dt, head) });
            assert!(report.sub_steps <= 12, "{report:?}");
            assert!(dt < 1.0 || (report.dropped > 9.8), "{report:?}");
        }
        let positions = rig.positions(0);
        assert_eq!((metrics::non_finite(&positions), rig.non_finite()), (0, 0), "{params:?}");
    }
}

/// Strands that are all alike, as many vertices as `points` gives, in metres.
fn alike(name: &str, points: impl IntoIterator<Item = Vec3>) -> Strands {
    let points: Vec<_> = points.into_iter().map(|point| point.to_array()).collect();
    let count = points.len() as u32;
    strands_of(HairAsset::new(name, AssetFormat::Builtin, points, vec![count]), 0)
}

#[test]
fn hostile_strands_stay_finite() {
    let along = |i: u32| 0.02 * i as f32;
    let hostile = [
        alike("one point", (0..12).map(|_| Vec3::Y)),
        alike("points in pairs", (0..12).map(|i| Vec3::X * along(i / 2))),
        alike("hairpins", (0..12).map(|i| Vec3::new(along(i % 2), 1e-4 * i as f32, 0.0))),
        alike("back on itself", (0..12).map(|i| Vec3::X * along(i % 2))),
        alike("tiny", (0..12).map(|i| 1e-7 * along(i) * Vec3::ONE)),
        alike("huge", (0..12).map(|i| 1e4 * along(i) * Vec3::new(1.0, -2.0, 0.5))),
        alike("uneven", (0..12).map(|i| Vec3::X * 1e-3 * (0.7 * i as f32).exp2())),
        alike("two", (0..2).map(|i| Vec3::X * along(i))),
        alike("many", (0..256).map(|i| 0.1 * Vec3::X * along(i))),
    ];
    let stiff = SimParams { local_stiffness: 1.0, global_stiffness: 1.0, ..SimParams::default() };
    let limp = SimParams { local_stiffness: 0.0, global_stiffness: 0.0, length_iterations: 16, ..SimParams::default() };
    for strands in hostile {
        let center = strands.rest[0].truncate();
        let ball = Capsule { a: center, b: center, radius_a: 0.03, radius_b: 0.03 };
        for params in [SimParams::default(), stiff.clone(), limp.clone()] {
            let Some(mut rig) = rig(strands.clone(), params, &[ball]) else { return };
            rig.play(&Motion::wild(&strands), 0.5, 60);
            let positions = rig.positions(0);
            assert_eq!((metrics::non_finite(&positions), rig.non_finite()), (0, 0), "{}", strands.name);
        }
    }
}

#[test]
fn what_is_not_finite_or_out_of_range_is_refused_and_nothing_is_recorded() {
    let mut backend = NullBackend::default();
    let strands = strands();
    let wrong = SectionDesc::new(&strands, SimParams { shock: 1.5, ..SimParams::default() });
    let error = HairSim::new(&mut backend, &mut PassList::new(), &[wrong], 0).unwrap_err();
    assert_eq!(error.to_string(), "parameter shock = 1.5 must be from 0 to 1");
    let desc = SectionDesc::new(&strands, SimParams::default());
    let mut sim = HairSim::new(&mut backend, &mut PassList::new(), &[desc], 0).unwrap();
    let mut list = PassList::new();
    let nowhere = Pose { translation: Vec3::NAN, ..Pose::IDENTITY };
    for (input, name) in [
        (StepInput::new(f64::NAN, Pose::IDENTITY), "dt"),
        (StepInput::new(0.1, nowhere), "head.translation"),
        (StepInput::new(0.1, Pose::IDENTITY).with_wind(Wind::new(Vec3::INFINITY)), "wind.velocity"),
    ] {
        assert_eq!(sim.step(&mut list, &input), Err(SimError::NonFinite { name }));
    }
    let scaled = Pose { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 1.1), ..Pose::IDENTITY };
    let error = sim.step(&mut list, &StepInput::new(0.1, scaled)).unwrap_err();
    assert_eq!(error, SimError::NoRotation { name: "head.rotation", length: 1.1 });
    assert!(list.commands().is_empty());
    assert!(sim.set_clock_params(ClockParams { sub_step: 0.0, ..ClockParams::default() }).is_err());
    assert!(sim.set_params(&mut backend, 0, SimParams { damping: -1.0, ..SimParams::default() }).is_err());
}

#[test]
fn parameters_can_change_while_it_runs() {
    let Some(mut rig) = rig(strands(), SimParams::default(), &[]) else { return };
    let motion = Motion::still(&rig.strands[0]);
    rig.play(&motion, 0.5, 60);
    let hanging = rig.positions(0)[11].y;
    let up = SimParams { gravity: Vec3::Y * 9.81, local_iterations: 3, ..SimParams::default() };
    rig.sim.set_params(&mut *rig.backend, 0, up.clone()).unwrap();
    assert_eq!(rig.sim.params(0), &up);
    rig.play(&motion, 1.0, 60);
    assert!(rig.positions(0)[11].y > hanging, "gravity points up now");
    let memory = |backend: &dyn tressfx_core::backend::Backend| backend.memory().bytes;
    assert!(memory(&*rig.backend) > 0);
    rig.sim.destroy(&mut *rig.backend);
    assert_eq!(memory(&*rig.backend), 0, "everything is freed");
}

/// An engine writes frames ahead of the GPU. What a list was written with stays, whatever changes after it.
#[test]
fn parameters_change_while_lists_wait() {
    let Some(mut waiting) = rig(strands(), SimParams::default(), &[]) else { return };
    let mut at_once = rig(strands(), SimParams::default(), &[]).unwrap();
    let motion = Motion::wild(&strands());
    let other = SimParams {
        length_iterations: 5,
        local_iterations: 1,
        global_stiffness: 0.0,
        gravity: Vec3::Y,
        ..SimParams::default()
    };
    let mut lists = Vec::new();
    for frame in 0..30 {
        let dt = if frame == 0 { 0.0 } else { 1.0 / 60.0 };
        let input = motion.input(f64::from(frame) / 60.0, dt);
        let params = if frame / 4 % 2 == 0 { SimParams::default() } else { other.clone() };
        for rig in [&mut waiting, &mut at_once] {
            rig.sim.set_params(&mut *rig.backend, 0, params.clone()).unwrap();
        }
        at_once.frame(&input);
        let mut list = PassList::new();
        waiting.sim.step(&mut list, &input).unwrap();
        lists.push(list);
        // Up to three frames are in flight.
        if lists.len() > 3 {
            waiting.backend.run(&lists.remove(0)).unwrap();
        }
    }
    lists.iter().for_each(|list| waiting.backend.run(list).unwrap());
    assert_eq!(waiting.positions(0), at_once.positions(0));
    assert_eq!(waiting.previous(0), at_once.previous(0));
}

#[test]
fn every_kernel_fits_the_limits_of_webgpu_and_its_structs_are_those_of_the_wgsl() {
    let mut backend = NullBackend::default();
    let strands = random_strands(10, 5, 1, 2);
    let ball = Capsule { a: Vec3::ZERO, b: Vec3::ZERO, radius_a: 0.1, radius_b: 0.1 };
    let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::TressFx).with_own_roots();
    let rods = desc.clone().with_solver(Solver::Direct);
    let mut list = PassList::new();
    let mut sim = HairSim::new(&mut backend, &mut list, &[desc, rods], 1).unwrap();
    let (motion, ball) = (Motion::wild(&strands), [Collider::with_head(ball)]);
    sim.step(&mut list, &motion.input(0.0, 0.0).with_colliders(&ball)).unwrap();
    sim.step(&mut list, &motion.input(1.0 / 60.0, 1.0 / 60.0).with_colliders(&ball)).unwrap();
    let mut seen = Vec::new();
    for command in list.commands() {
        let tressfx_core::pass::Command::Compute(pass) = command else { continue };
        let shader = &pass.kernel.shader;
        assert!(shader.storage_buffers() <= 8, "{}", shader.label);
        shader.check_layout::<Step>().unwrap();
        if shader.label == Stage::Roots.label() {
            shader.check_layout::<RootTransform>().unwrap();
        }
        seen.push(shader.label);
    }
    let stages = Solver::TressFx.stages().iter().chain(Solver::Direct.stages());
    for stage in stages.chain([&Solver::FRAME_END]) {
        assert!(seen.contains(&stage.label()), "{} runs", stage.label());
    }
    tressfx_core::backend::Run::run(&mut backend, &list).unwrap();
}

/// A long shake of the mohawk, which holds strands of nearly no length: 200 frames, or as many as TRESSFX_LONG_FRAMES says.
#[test]
fn a_long_shake_leaves_nothing_non_finite() {
    let frames: u32 = std::env::var("TRESSFX_LONG_FRAMES").ok().and_then(|text| text.parse().ok()).unwrap_or(200);
    let strands = real(REAL[0]).unwrap_or_else(|| builtin("long", 300));
    let Some(mut rig) = rig(strands, SimParams::default(), &[]) else { return };
    let motion = Motion { shake: 0.06, ..Motion::still(&rig.strands[0]) };
    for frame in 0..frames {
        rig.frame(&motion.input(f64::from(frame) / 60.0, 1.0 / 60.0));
    }
    let positions = rig.positions(0);
    assert_eq!((metrics::non_finite(&positions), rig.non_finite()), (0, 0), "{}", rig.strands[0].name);
}
