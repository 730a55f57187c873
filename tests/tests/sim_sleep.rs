//! Grooms that sleep: they record nothing, wake in the frame in which something changes, and move on as if they had never slept.

mod support;

use glam::{DVec3, Vec3};
use tressfx_conformance::sim::{Motion, Rig, random_strands};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::{
    ClockParams, Collider, HairSim, MotionTicket, SectionDesc, SimError, SimParams, SleepParams, Solver, StepInput,
    Wind, reference,
};

use support::gpu;

const FRAME: f64 = 1.0 / 60.0;

fn strands() -> Strands {
    random_strands(48, 16, 1, 5)
}

fn rig(solver: Solver) -> Option<Rig> {
    Some(Rig::with_solver(gpu()?, strands(), SimParams::default(), solver))
}

fn still() -> StepInput<'static> {
    StepInput::new(FRAME, Pose::IDENTITY)
}

/// A frame with a measurement, which comes back in that frame.
fn measured(rig: &mut Rig, input: &StepInput) -> Option<f32> {
    rig.frame(input);
    let ticket = rig.run(|sim, list| sim.request_motion(list))?;
    let bytes: [u8; 4] = rig.backend.read(ticket.ticket).ready().unwrap().try_into().unwrap();
    rig.sim.measured_motion(&ticket, bytes);
    Some(f32::from_le_bytes(bytes))
}

/// A second of frames for each until it sleeps, at most so many.
fn put_to_sleep(rig: &mut Rig, seconds: u32) {
    for _ in 0..6 * seconds {
        (0..9).for_each(|_| assert!(!rig.frame(&still()).asleep));
        measured(rig, &still());
        if rig.sim.is_asleep() {
            return;
        }
    }
    panic!("awake after {seconds} s");
}

#[test]
fn the_measurement_is_as_in_f64() {
    for solver in [Solver::TressFx, Solver::Direct] {
        let Some(mut rig) = rig(solver) else { return };
        rig.sim.allow_sleep(&mut *rig.backend, SleepParams::default()).unwrap();
        let motion = Motion::wild(&rig.strands[0]);
        rig.play(&motion, 0.3, 60);
        assert_eq!(measured(&mut rig, &still()), None, "the first one notes where strands are");
        for frames in [1, 7] {
            let before = positions(&mut rig);
            (1..frames).for_each(|_| assert!(!rig.frame(&still()).asleep));
            let found = measured(&mut rig, &still()).unwrap();
            let (after, strands) = (positions(&mut rig), &rig.strands[0]);
            let n = strands.vertices as usize;
            let shares = (0..strands.guides as usize).map(|guide| {
                let of = guide * n..(guide + 1) * n;
                reference::moved(&after[of.clone()], &before[of.clone()], &strands.rest_lengths[of])
            });
            let expected = shares.fold(0.0, f64::max);
            let error = (f64::from(found) - expected).abs();
            assert!(expected > 1e-4 && error < 1e-6 + 1e-5 * expected, "{solver:?}: {found}, not {expected}");
        }
    }
}

/// Of the guides and follow strands.
fn positions(rig: &mut Rig) -> Vec<DVec3> {
    rig.positions(0).iter().map(|position| position.truncate().as_dvec3()).collect()
}

#[test]
fn a_groom_at_rest_sleeps_and_wakes_in_the_frame_in_which_its_head_moves() {
    for solver in [Solver::TressFx, Solver::Direct] {
        let (Some(mut sleeper), Some(mut awake)) = (rig(solver), rig(solver)) else { return };
        sleeper.sim.allow_sleep(&mut *sleeper.backend, SleepParams::default()).unwrap();
        awake.sim.allow_sleep(&mut *awake.backend, SleepParams { speed: 0.0, ..SleepParams::default() }).unwrap();
        put_to_sleep(&mut sleeper, 30);
        while awake.sim.time() < sleeper.sim.time() - 1e-9 {
            awake.frame(&still());
        }
        assert_eq!(positions(&mut sleeper), positions(&mut awake), "the same until it fell asleep");
        // One that sleeps for no time has the state that the other keeps.
        let Some(mut brief) = rig(solver) else { return };
        brief.sim.allow_sleep(&mut *brief.backend, SleepParams::default()).unwrap();
        put_to_sleep(&mut brief, 30);
        let slept = 120;
        for _ in 0..slept {
            awake.frame(&still());
            let mut list = PassList::new();
            let report = sleeper.sim.step(&mut list, &still()).unwrap();
            assert!(report.asleep && report.sub_steps == 0 && list.commands().is_empty());
            assert!(sleeper.sim.request_motion(&mut list).is_none() && list.commands().is_empty());
        }
        assert_eq!(sleeper.sim.time(), awake.sim.time());
        let drift = farthest(&mut sleeper, &mut awake);
        let allowed = f64::from(SleepParams::default().speed) * f64::from(slept) * FRAME;
        assert!(drift <= allowed, "{solver:?}: {drift} of length, it may be {allowed}");
        for frame in 1..=30 {
            let head = Pose { translation: Vec3::X * 0.004 * frame as f32, ..Pose::IDENTITY };
            for rig in [&mut sleeper, &mut awake, &mut brief] {
                let report = rig.frame(&StepInput::new(FRAME, head));
                assert!(!report.asleep && !rig.sim.is_asleep() && report.sub_steps > 0);
            }
        }
        let (moved, kept) = (farthest(&mut sleeper, &mut awake), farthest(&mut sleeper, &mut brief));
        println!(
            "{solver:?}: asleep for 2 s, {drift:.1e} of length from one that is awake, then {moved:.1e}; {kept:.1e} from one that slept for no time"
        );
        assert_eq!(kept, 0.0, "{solver:?}: it moves on from where it was, bit for bit");
        assert!(moved < MOVED, "{solver:?}: {moved}");
    }
}

/// Of the length of a strand: how far one that was asleep may be from one that was not, after half a second of motion. Those that are awake go on to
/// settle, the slower the longer.
const MOVED: f64 = 1e-3;

/// How far guides of two are apart at most, as a share of their length.
fn farthest(one: &mut Rig, other: &mut Rig) -> f64 {
    let lengths: Vec<f64> =
        strands().rest_lengths.chunks(16).map(|strand| strand.iter().map(|&length| f64::from(length)).sum()).collect();
    let pairs = positions(one).into_iter().zip(positions(other)).take(48 * 16);
    pairs.enumerate().map(|(i, (a, b))| a.distance(b) / lengths[i / 16]).fold(0.0, f64::max)
}

/// A simulation without a GPU, and what it takes for a measurement of this share.
struct Alone {
    backend: NullBackend,
    sim: HairSim,
}

impl Alone {
    fn new(own_roots: bool) -> Self {
        let (mut backend, strands) = (NullBackend::default(), random_strands(8, 6, 1, 2));
        let mut desc = SectionDesc::new(&strands, SimParams::default());
        desc.own_roots = own_roots;
        let mut sim = HairSim::new(&mut backend, &mut PassList::new(), &[desc], 2).unwrap();
        sim.allow_sleep(&mut backend, SleepParams::default()).unwrap();
        Self { backend, sim }
    }

    /// The labels of a frame.
    fn frame(&mut self, input: &StepInput) -> Vec<&'static str> {
        let mut list = PassList::new();
        self.sim.step(&mut list, input).unwrap();
        list.labels().collect()
    }

    /// Frames with measurements of no motion, until it sleeps.
    fn sleep(&mut self, input: &StepInput) {
        for _ in 0..SleepParams::default().measurements + 1 {
            assert!(!self.frame(input).is_empty());
            let ticket = self.sim.request_motion(&mut PassList::new());
            ticket.iter().for_each(|ticket| self.sim.measured_motion(ticket, [0; 4]));
        }
        assert!(self.sim.is_asleep() && self.frame(input).is_empty());
    }
}

#[test]
fn whatever_changes_wakes_it_in_that_frame() {
    let ball = Capsule { a: Vec3::Y, b: Vec3::Y * 2.0, radius_a: 0.1, radius_b: 0.1 };
    let moved = Capsule { radius_a: 0.2, ..ball };
    let (resting, other) = ([Collider::with_head(ball)], [Collider::with_head(moved)]);
    let at = |x: f32| Pose { translation: Vec3::X * x, ..Pose::IDENTITY };
    let moving = [Collider::free(ball, at(0.0), at(0.01))];
    let base = still().with_colliders(&resting);
    let path = [at(1e-6)];
    let mut alone = Alone::new(true);
    let inputs = [
        StepInput { head: at(1e-6), ..base },
        base.with_path(&path),
        base.with_wind(Wind::new(Vec3::X)),
        base.with_colliders(&other),
        base.with_colliders(&moving),
        base.with_colliders(&[]),
    ];
    for (index, input) in inputs.iter().enumerate() {
        alone.sleep(&base);
        assert!(!alone.frame(input).is_empty(), "change {index}");
        assert!(!alone.sim.is_asleep(), "change {index}");
    }
    let params = SimParams::default();
    let changes: [&dyn Fn(&mut Alone); 6] = [
        &|alone| alone.sim.set_params(&mut alone.backend, 0, params.clone()).unwrap(),
        &|alone| alone.sim.set_clock_params(ClockParams::default()).unwrap(),
        &|alone| alone.sim.set_roots(&mut PassList::new(), 0, &[Pose::IDENTITY; 8]).unwrap(),
        &|alone| alone.sim.reset(),
        &|alone| alone.sim.wake(),
        &|alone| alone.sim.allow_sleep(&mut alone.backend, SleepParams::default()).unwrap(),
    ];
    for (index, change) in changes.iter().enumerate() {
        alone.sleep(&base);
        change(&mut alone);
        assert!(!alone.frame(&base).is_empty(), "change {index}");
    }
}

#[test]
fn it_stays_awake_in_wind_and_where_something_moves_and_where_nobody_measures() {
    let at = |x: f32| Pose { translation: Vec3::X * x, ..Pose::IDENTITY };
    let ball = Capsule { a: Vec3::Y, b: Vec3::Y * 2.0, radius_a: 0.1, radius_b: 0.1 };
    let moving = [Collider::free(ball, at(0.0), at(0.01))];
    for input in [still().with_wind(Wind::new(Vec3::X)), still().with_colliders(&moving)] {
        let mut alone = Alone::new(false);
        for _ in 0..20 {
            assert!(!alone.frame(&input).is_empty());
            assert!(alone.sim.request_motion(&mut PassList::new()).is_none(), "each frame is something new");
        }
    }
    let mut alone = Alone::new(false);
    assert!((0..100).all(|_| !alone.frame(&still()).is_empty()));
    // Strands that move, or are no numbers, are not at rest.
    for share in [0.1f32, f32::NAN, f32::INFINITY] {
        for _ in 0..20 {
            assert!(!alone.frame(&still()).is_empty());
            let ticket = alone.sim.request_motion(&mut PassList::new());
            ticket.iter().for_each(|ticket| alone.sim.measured_motion(ticket, share.to_le_bytes()));
        }
    }
}

#[test]
fn a_measurement_from_before_a_change_says_nothing() {
    let mut alone = Alone::new(false);
    let mut old: Vec<MotionTicket> = Vec::new();
    for _ in 0..6 {
        alone.frame(&still());
        old.extend(alone.sim.request_motion(&mut PassList::new()));
    }
    assert_eq!(old.len(), 5);
    alone.sim.wake();
    old.iter().for_each(|ticket| alone.sim.measured_motion(ticket, [0; 4]));
    assert!(!alone.sim.is_asleep());
    let refused = SleepParams { speed: -1.0, ..SleepParams::default() };
    let error = alone.sim.allow_sleep(&mut alone.backend, refused).unwrap_err();
    assert!(matches!(error, SimError::Param(_)) && error.to_string().contains("sleep.speed"), "{error}");
    let refused = SleepParams { measurements: 0, ..SleepParams::default() };
    assert!(alone.sim.allow_sleep(&mut alone.backend, refused).unwrap_err().to_string().contains("sleep.measurements"));
}

#[test]
fn of_many_characters_only_those_that_move_are_simulated() {
    let mut all: Vec<_> = (0..60).map(|_| Alone::new(false)).collect();
    all.iter_mut().for_each(|alone| alone.sleep(&still()));
    let mut list = PassList::new();
    let mut asleep = 0;
    for (index, alone) in all.iter_mut().enumerate() {
        let head = Pose { translation: Vec3::X * if index % 20 == 0 { 0.01 } else { 0.0 }, ..Pose::IDENTITY };
        asleep += usize::from(alone.sim.step(&mut list, &StepInput::new(FRAME, head)).unwrap().asleep);
    }
    let mut one = Alone::new(false);
    one.sleep(&still());
    let passes = one.frame(&StepInput::new(FRAME, Pose { translation: Vec3::X * 0.01, ..Pose::IDENTITY })).len();
    assert_eq!((asleep, list.passes().count()), (57, 3 * passes));
}
