//! Tests of the clock.

use proptest::prelude::*;

use super::*;

fn clock() -> Clock {
    let bounds = Bounds { min: Vec3::splat(-0.1), max: Vec3::splat(0.1) };
    let mut clock = Clock::new(ClockParams::default(), bounds).unwrap();
    let frame = clock.advance(0.0, Pose::IDENTITY);
    assert_eq!((frame.reset, frame.sub_steps.len()), (Some(Quat::IDENTITY), 0));
    clock
}

fn moved(x: f32) -> Pose {
    Pose { translation: Vec3::X * x, ..Pose::IDENTITY }
}

#[test]
fn two_seconds_are_as_many_sub_steps_at_any_frame_rate() {
    for fps in [24, 30, 60, 72, 90, 120, 144, 240, 1000] {
        let mut clock = clock();
        let frames = (0..2 * fps).map(|_| clock.advance(1.0 / f64::from(fps), Pose::IDENTITY));
        assert_eq!(frames.map(|frame| frame.sub_steps.len()).sum::<usize>(), 240, "{fps} fps");
        assert!((clock.time() - 2.0).abs() < 1e-9);
    }
}

#[test]
fn the_head_moves_evenly_in_the_first_frame_and_arrives() {
    let mut clock = clock();
    let frame = clock.advance(1.0 / 60.0, moved(0.2));
    let displacements: Vec<f32> = frame.sub_steps.iter().map(|sub_step| sub_step.center_displacement.x).collect();
    assert!(displacements.iter().all(|displacement| (displacement - 0.1).abs() < 1e-6), "{displacements:?}");
    assert_eq!(clock.pose(), moved(0.2), "the end of the frame is met exactly");
    // Half of a sub-step: the strands stay, and the renderer is told where they are to be.
    let frame = clock.advance(1.0 / 240.0, moved(0.25));
    assert!(frame.sub_steps.is_empty());
    assert_eq!(clock.pose(), moved(0.25));
    let frame = clock.advance(1.0 / 240.0, moved(0.35));
    assert!((frame.sub_steps[0].center_displacement.x - 0.15).abs() < 1e-6);
}

#[test]
fn strands_turn_and_move_with_the_head_about_their_center() {
    let bounds = Bounds { min: Vec3::new(-0.1, 1.5, -0.1), max: Vec3::new(0.1, 1.7, 0.1) };
    let mut clock = Clock::new(ClockParams::default(), bounds).unwrap();
    assert!(clock.center().distance(bounds.center()) < 0.01);
    let head = |angle: f32| Pose { rotation: Quat::from_rotation_z(angle), translation: Vec3::X * angle };
    clock.advance(0.0, head(0.0));
    let point = Vec3::new(0.05, 1.55, -0.02);
    let mut place = (point - clock.center()).as_dvec3();
    let mut center = clock.center().as_dvec3();
    for frame in 1..=30 {
        let head = head(0.02 * frame as f32);
        for sub_step in clock.advance(1.0 / 60.0, head).sub_steps {
            place = sub_step.head_turn.as_dquat() * place;
            center += sub_step.center_displacement.as_dvec3();
        }
        let carried = head.transform(point);
        assert!((center + place).as_vec3().distance(carried) < 2e-6, "the head carries it to {carried}");
        assert!(clock.pose().transform(place.as_vec3()).distance(carried) < 1e-6, "and the renderer draws it there");
    }
    // Less than a sub-step later the strands have not turned yet.
    let head = head(0.605);
    assert!(clock.advance(1.0 / 240.0, head).sub_steps.is_empty());
    assert!(clock.pose().transform(place.as_vec3()).distance(head.transform(point)) < 1e-6);
}

/// Places of a head that is in one now, within the frames that bring it to these places.
fn places(clock: &mut Clock, dt: f64, ends: &[f32]) -> Vec<f32> {
    let mut place = clock.pose().translation.x;
    let mut places = Vec::new();
    for &end in ends {
        let frame = clock.advance(dt, moved(end));
        if frame.reset.is_some() {
            place = end;
        }
        for sub_step in frame.sub_steps {
            place += sub_step.center_displacement.x;
            places.push(place);
        }
    }
    places
}

#[test]
fn the_head_goes_on_as_it_did_where_the_last_frame_tells_how() {
    let close = |is: &[f32], should_be: &[f32]| {
        assert!(is.iter().zip(should_be).all(|(one, other)| (one - other).abs() < 1e-5), "{is:?} {should_be:?}");
    };
    let mut one = clock();
    close(&places(&mut one, 1.0 / 60.0, &[0.0, 0.4]), &[0.0, 0.0, 0.15, 0.4]);
    one.reset();
    close(&places(&mut one, 1.0 / 60.0, &[0.5, 0.7]), &[0.5, 0.5, 0.6, 0.7]);
    // A frame of another length, one that was too long, and a teleport tell nothing.
    close(&places(&mut one, 1.0 / 24.0, &[0.7]), &[0.7; 5]);
    close(&places(&mut one, 1.0 / 60.0, &[0.9]), &[0.8, 0.9]);
    one.advance(10.0, moved(0.0));
    close(&places(&mut one, 0.1, &[1.2])[..2], &[0.1, 0.2]);
    assert!(one.advance(1.0 / 60.0, moved(50.0)).teleported);
    close(&places(&mut one, 1.0 / 60.0, &[50.2]), &[50.1, 50.2]);
}

#[test]
fn a_shorter_sub_step_finds_the_head_where_it_was() {
    let mut clock = clock();
    clock.advance(1.0 / 60.0 + 1.0 / 125.0, moved(0.1));
    clock.set_params(ClockParams { sub_step: 1.0 / 1000.0, ..ClockParams::default() }).unwrap();
    for (dt, x) in [(0.0, 0.2), (1e-12, 0.3)] {
        let plan = clock.advance(dt, moved(x));
        let finite = |sub_step: &SubStep| {
            sub_step.center_displacement.is_finite() && sub_step.shares.iter().all(|share| share.is_finite())
        };
        assert!(plan.sub_steps.iter().all(finite), "{plan:?}");
        let sum: f32 = plan.sub_steps.iter().map(|sub_step| sub_step.center_displacement.x).sum();
        assert!((-1e-6..0.2).contains(&sum), "{sum}");
    }
}

#[test]
fn a_head_at_rest_makes_no_motion_at_all() {
    let mut clock = clock();
    let head = Pose { rotation: Quat::from_rotation_x(0.3), translation: Vec3::new(0.1, 0.2, 0.3) };
    clock.advance(0.1, head);
    let frame = clock.advance(0.1, head);
    assert!(
        frame
            .sub_steps
            .iter()
            .all(|sub_step| sub_step.head_turn == Quat::IDENTITY && sub_step.center_displacement == Vec3::ZERO)
    );
    assert!(frame.sub_steps.iter().all(|sub_step| sub_step.head_rotation == head.rotation));
}

#[test]
fn the_acceleration_is_that_of_the_frames() {
    let mut clock = clock();
    let dt = 1.0 / 60.0;
    let at = |frame: f32| moved(0.5 * 12.0 * (frame / 60.0).powi(2));
    let accelerations = (1..10).map(|frame| clock.advance(dt, at(frame as f32)).sub_steps[0].head_acceleration);
    let accelerations: Vec<f32> = accelerations.collect();
    assert_eq!(accelerations[0], 0.0, "one frame knows no acceleration");
    assert!(accelerations[1..].iter().all(|acceleration| (acceleration - 12.0).abs() < 0.1), "{accelerations:?}");
}

proptest! {
    #[test]
    fn time_is_simulated_or_dropped_and_never_lost(steps in prop::collection::vec(-0.1..0.5f64, 1..60)) {
        let mut clock = clock();
        let (mut passed, mut dropped, mut sub_steps) = (0.0, 0.0, 0);
        for dt in steps {
            let frame = clock.advance(dt, Pose::IDENTITY);
            prop_assert!(frame.sub_steps.len() <= 12);
            passed += dt.max(0.0);
            dropped += frame.dropped;
            sub_steps += frame.sub_steps.len();
        }
        let behind = passed - dropped - sub_steps as f64 / 120.0;
        prop_assert!((-1e-6..1.0 / 120.0 + 1e-6).contains(&behind), "{} s are neither", behind);
        prop_assert!((clock.time() - sub_steps as f64 / 120.0).abs() < 1e-9);
    }
}

#[test]
fn poses_within_a_frame_are_shorter_frames_with_the_shares_of_the_whole() {
    let (mut whole, mut parts) = (clock(), clock());
    for frame in 0..20_u8 {
        let at = |third: u8| moved(0.02 * (f32::from(3 * frame + third) * 0.2).sin());
        let along = whole.advance_along(1.0 / 20.0, &[at(1), at(2)], at(3));
        let one_by_one: Vec<_> = (1..=3).flat_map(|third| parts.advance(1.0 / 60.0, at(third)).sub_steps).collect();
        assert_eq!(along.sub_steps.len(), 6);
        for (index, (sub_step, expected)) in along.sub_steps.iter().zip(&one_by_one).enumerate() {
            assert!((sub_step.shares[1] - (index + 1) as f64 / 6.0).abs() < 1e-9, "{:?}", sub_step.shares);
            assert!((sub_step.roots.share - sub_step.shares[1].min(1.0)).abs() < 1e-6, "roots have one way");
            let same = SubStep { shares: expected.shares, roots: expected.roots, ..*sub_step };
            assert!((same.time - expected.time).abs() < 1e-12 && SubStep { time: expected.time, ..same } == *expected);
        }
    }
}

#[test]
fn roots_have_the_way_of_the_head() {
    let mut clock = clock();
    // Frames of several lengths, one of them too long, and one twice as long as the one before it and more.
    let lengths: [f64; 10] =
        [1.0 / 30.0, 1.0 / 30.0, 1.0 / 50.0, 1.0 / 30.0, 1.0 / 144.0, 1.0 / 100.0, 0.3, 0.1, 0.1, 0.05];
    let (mut before, mut reached) = ([0.0_f64; 3], 0.0);
    for (index, dt) in lengths.into_iter().enumerate() {
        let end = 0.03 * f64::sin(0.9 * index as f64);
        let frame = clock.advance(dt, moved(end as f32));
        for sub_step in frame.sub_steps {
            reached += f64::from(sub_step.center_displacement.x);
            let (start, way) = (before[0], sub_step.roots);
            let bend = way.bend.dot(DVec3::new(end - start, before[1] - start, before[2] - start));
            let root = start + way.share * (end - start) + bend;
            assert!((root - reached).abs() < 1e-6, "frame {index} at {}: {root}, {reached}", way.share);
            assert!(way.share == 1.0 || (way.frame - (dt - frame.dropped)).abs() < 1e-9);
        }
        before = [end, before[0], before[1]];
    }
    assert!(clock.advance(1.0 / 60.0, moved(50.0)).teleported);
    let reset = clock.advance(0.0, Pose::IDENTITY);
    assert!(reset.sub_steps.iter().all(|sub_step| sub_step.roots == RootPath::END));
}

#[test]
fn a_teleport_within_a_frame_resets_there_and_what_is_too_long_is_cut() {
    let mut clock = clock();
    let frame = clock.advance_along(1.0 / 20.0, &[moved(0.0), moved(100.0)], moved(100.0));
    assert!(frame.teleported && frame.reset.is_some());
    assert_eq!(frame.sub_steps.len(), 4, "those from the teleport on");
    let frame = clock.advance_along(1.0, &[moved(50.0)], moved(100.0));
    assert!((frame.dropped - 0.9).abs() < 1e-9 && !frame.teleported && frame.sub_steps.len() == 12, "{frame:?}");
}

#[test]
fn time_passes_over_a_head_that_stands_still_as_it_is_simulated() {
    let head = Pose { rotation: Quat::from_rotation_y(0.4), translation: Vec3::new(0.3, 1.7, -2.0) };
    let mut simulated = clock();
    // Two frames more than the path of the head looks back.
    (0..4).for_each(|_| drop(simulated.advance(1.0 / 60.0, head)));
    let mut passed = simulated.clone();
    for dt in
        [0.0, 1.0 / 144.0, 1.0 / 60.0, 1.0 / 60.0, 1.0 / 31.0, 0.0004, 5.0, 0.01, 0.02, 0.02, -1.0, 0.011, 1.0 / 60.0]
    {
        simulated.advance(dt, head);
        passed.pass(dt);
        let mut settled = passed.clone();
        settled.settle();
        assert_eq!(format!("{settled:?}"), format!("{simulated:?}"), "{dt}");
    }
    let moved = Pose { translation: Vec3::new(0.3, 1.75, -2.0), ..head };
    let frames = [&mut passed, &mut simulated].map(|clock| format!("{:?}", clock.advance(1.0 / 60.0, moved)));
    assert_eq!(frames[0], frames[1]);
}
