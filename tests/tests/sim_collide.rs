//! Contacts that are hard to resolve: strands that point nearly at the centre of a ball, strands whose first edge barely reaches out
//! of it, and strands between solids that overlap.

mod support;

use glam::{DVec3, Quat, Vec3, Vec4};
use support::rig;
use tressfx_conformance::sim::{Motion, Random, Rig, strand_errors, strands_of, wide};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::reference::{self, Guide};
use tressfx_sim::step::{SectionInfo, Step};
use tressfx_sim::{CapsuleMotion, SimParams, Solver, Stage, StepInput, SubStep};

const GUIDES: usize = 2000;
const VERTICES: [u32; 5] = [2, 3, 4, 5, 16];
const LENGTH: f32 = 0.1;
const RADIUS: f32 = 0.2;
const BALL: Capsule = Capsule { a: Vec3::ZERO, b: Vec3::ZERO, radius_a: RADIUS, radius_b: RADIUS };

/// Nothing but contacts moves a strand.
fn limp() -> SimParams {
    SimParams {
        gravity: Vec3::ZERO,
        global_stiffness: 0.0,
        local_stiffness: 0.0,
        length_iterations: 0,
        ..SimParams::default()
    }
}

/// From 10^-7 to 1, as many between one power of ten and the next as between any other.
fn share(random: &mut Random) -> f32 {
    10f32.powf(3.5 * (random.signed() - 1.0))
}

/// Straight strands, each given by its root and the way to its tip.
fn straight(vertices: u32, strand: impl Fn(&mut Random) -> (Vec3, Vec3)) -> Strands {
    let mut random = Random::new(u64::from(vertices));
    let mut points = Vec::new();
    for _ in 0..GUIDES {
        let (root, way) = strand(&mut random);
        let edge = way * LENGTH / (vertices - 1) as f32;
        points.extend((0..vertices).map(|i| (root + edge * i as f32).to_array()));
    }
    strands_of(HairAsset::new("straight", AssetFormat::Builtin, points, vec![vertices; GUIDES]), 0)
}

/// From outside towards the centre of the ball, past it at any distance; the tips are inside at any depth.
fn aimed(vertices: u32) -> Strands {
    straight(vertices, |random| {
        let (out, aside) = (random.vector().normalize(), random.vector().normalize());
        let root = out * (RADIUS + LENGTH * (1.0 - 0.9 * share(random)));
        (root, (0.3 * share(random) * aside - out).normalize())
    })
}

/// From so deep inside the ball that the first edge just reaches out, or just does not, in any direction.
fn buried(vertices: u32) -> Strands {
    straight(vertices, |random| {
        let edge = LENGTH / (vertices - 1) as f32;
        let depth = edge * (1.0 + 0.5 * share(random) * random.signed().signum());
        (random.vector().normalize() * (RADIUS - depth), random.vector().normalize())
    })
}

/// A step in which the head moves.
fn step(info: &SectionInfo, head: Pose) -> Step {
    let sub_step = SubStep {
        head_turn: Quat::from_rotation_z(0.002),
        center_displacement: Vec3::X * 0.0003,
        ..SubStep::at_rest(1.0 / 120.0, head.rotation)
    };
    Step::new(&limp(), info, &sub_step, None)
}

/// From the skin of the ball in any direction, amid solids that overlap.
fn amid(vertices: u32) -> Strands {
    straight(vertices, |random| {
        (random.vector().normalize() * RADIUS * (0.95 + 0.1 * random.signed()), random.vector().normalize())
    })
}

fn solids() -> [Capsule; 3] {
    let post = Capsule { a: Vec3::new(0.1, -0.3, 0.0), b: Vec3::new(0.25, 0.3, 0.1), radius_a: 0.06, radius_b: 0.09 };
    let at = Vec3::new(0.0, 0.22, 0.1);
    [BALL, post, Capsule { a: at, b: at, radius_a: 0.08, radius_b: 0.08 }]
}

/// What the GPU has, and what the reference has.
type Pair = (Vec<Vec4>, Vec<DVec3>);

/// The kernel, once from the rest pose, on a head that moves: positions and previous positions. And how many strands it moves.
fn collided(rig: &mut Rig, head: Pose) -> ([Pair; 2], usize) {
    let step = step(&SectionInfo::new(&rig.strands[0], Solver::TressFx), head);
    rig.frame(&StepInput::new(0.0, head));
    let (mut positions, mut previous) = (wide(&rig.positions(0)), wide(&rig.previous(0)));
    rig.stage(&step, Stage::TressFx);
    let vertices = rig.strands[0].vertices as usize;
    let rest = rig.rest(0);
    let capsules = rig.centered();
    let before = positions.clone();
    for guide in 0..GUIDES {
        let range = guide * vertices..(guide + 1) * vertices;
        let mut of_guide = Guide {
            rest: &rest[range.clone()],
            rest_lengths: &rig.strands[0].rest_lengths[range.clone()],
            positions: &mut positions[range.clone()],
            previous: &mut previous[range],
            own_root: None,
        };
        assert!(!reference::tressfx(&step, &limp(), &mut of_guide, 0, &capsules, &[]));
    }
    let touched =
        positions.chunks(vertices).zip(before.chunks(vertices)).filter(|(after, before)| after != before).count();
    ([(rig.positions(0), positions), (rig.previous(0), previous)], touched)
}

#[test]
fn hard_contacts_match_the_reference() {
    let head = Pose { rotation: Quat::from_rotation_y(0.7), translation: Vec3::new(0.02, -0.01, 0.03) };
    for vertices in VERTICES {
        // Amid solids each vertex multiplies the errors of its parent: one strand in a hundred may miss.
        for (name, strands, capsules, held) in [
            ("aimed", aimed(vertices), &[BALL][..], GUIDES),
            ("buried", buried(vertices), &[BALL], GUIDES),
            ("amid", amid(vertices), &solids(), GUIDES * 99 / 100),
        ] {
            let Some(mut rig) = rig(strands, limp(), capsules) else { return };
            let (states, touched) = collided(&mut rig, head);
            assert!(touched > GUIDES / 3, "{name}, {vertices} vertices: {touched} strands touch");
            for (gpu, reference) in states {
                let errors = strand_errors(&rig.strands[0], &gpu, &reference);
                let (median, largest) = (errors[GUIDES / 2], errors[GUIDES - 1]);
                println!(
                    "{name}, {vertices} vertices: {median:.1e} (median), {largest:.1e} (largest) of strand length"
                );
                assert!(errors[held - 1] <= 1e-5, "{name}, {vertices} vertices: {:e}", errors[held - 1]);
                assert!(largest < 0.01, "{name}, {vertices} vertices: {largest:e}");
            }
        }
    }
}

/// Positions, then previous positions.
type State = Vec<DVec3>;

/// The reference, for a strand between solids that overlap.
fn collided_reference(strands: &Strands, guide: usize, state: &State) -> State {
    let vertices = strands.vertices as usize;
    let mut after = state.clone();
    let (positions, previous) = after.split_at_mut(vertices);
    let range = guide * vertices..(guide + 1) * vertices;
    let (rest, rest_lengths) = (&strands.rest[range.clone()], &strands.rest_lengths[range]);
    let mut of_guide = Guide { rest, rest_lengths, positions, previous, own_root: None };
    let solids = solids().map(|capsule| (capsule, CapsuleMotion::STILL));
    let step = step(&SectionInfo::new(strands, Solver::TressFx), Pose::default());
    assert!(!reference::tressfx(&step, &limp(), &mut of_guide, 0, &solids, &[]));
    after
}

/// The largest distance between two states, as a share of strand length.
fn apart(one: &State, other: &State) -> f64 {
    one.iter().zip(other).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max) / f64::from(LENGTH)
}

/// Where a contact hung on its strand with a jump, two drivers that round differently would part there, and so would two frame
/// rates.
#[test]
fn contacts_follow_their_strands_without_a_jump() {
    for vertices in VERTICES {
        let strands = amid(vertices);
        let mut random = Random::new(7);
        let edge = f64::from(LENGTH) / f64::from(vertices - 1);
        let mut shaken = |state: &State, share: f64| -> State {
            let mut shaken: State =
                state.iter().map(|point| *point + share * f64::from(LENGTH) * random.vector().as_dvec3()).collect();
            // Contacts begin where edges have their lengths.
            for i in 1..vertices as usize {
                shaken[i] = shaken[i - 1] + edge * (shaken[i] - shaken[i - 1]).normalize();
            }
            shaken
        };
        let (mut growths, mut jump, mut touched) = (Vec::new(), 0.0, 0);
        for guide in 0..GUIDES {
            let after = |state: &State| collided_reference(&strands, guide, state);
            let range = guide * vertices as usize..(guide + 1) * vertices as usize;
            let rest = wide(&strands.rest[range]);
            let state = shaken(&[rest.clone(), rest].concat(), 0.02);
            let contact = after(&state);
            touched += usize::from(contact != state);
            let mut growth = 0.0;
            for share in [1e-7, 1e-7, 1e-6, 1e-6, 1e-4, 1e-3] {
                let near = shaken(&state, share);
                let moved = apart(&after(&near), &contact);
                growth = f64::max(growth, if share < 1e-5 { moved / share } else { 0.0 });
                if moved > 10.0 * share {
                    jump = f64::max(jump, jump_between(&state, &near, after));
                }
            }
            growths.push(growth);
        }
        growths.sort_by(f64::total_cmp);
        let (most, largest) = (growths[GUIDES * 99 / 100], growths[GUIDES - 1]);
        println!(
            "{vertices} vertices: {touched} touch, errors grow {most:.1} (99 %), {largest:.1} (largest) times, \
             {jump:.1e} of strand length (largest jump)"
        );
        assert!(touched > GUIDES / 3, "{touched}");
        assert!(most < 200.0, "{vertices} vertices: an error grows {most:.1} times");
        assert!(jump < 1e-5, "{vertices} vertices: a jump by {jump:.1e} of strand length");
    }
}

/// How far the results are apart where they change fastest on the way from one state to another.
fn jump_between(one: &State, other: &State, after: impl Fn(&State) -> State) -> f64 {
    let between = |share: f64| -> State { one.iter().zip(other).map(|(a, b)| a.lerp(*b, share)).collect() };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        let [a, m, b] = [low, middle, high].map(|share| after(&between(share)));
        if apart(&a, &m) > apart(&m, &b) { high = middle } else { low = middle }
    }
    apart(&after(&between(low)), &after(&between(high)))
}

/// A bounded turn takes several sub-steps, most of them where the strand points exactly at the centre.
#[test]
fn strands_that_point_at_a_center_get_out() {
    for vertices in VERTICES {
        let Some(mut rig) = rig(aimed(vertices), limp(), &[BALL]) else { return };
        let motion = Motion::still(&rig.strands[0]);
        let deepest = [0.05, 0.1, 0.25].map(|seconds| {
            rig.play(&motion, seconds, 60);
            let movable = rig.world(0).into_iter().filter(|position| position.w > 0.0);
            movable.map(|position| -BALL.distance(position.truncate())).fold(0.0, f32::max)
        });
        println!("{vertices} vertices: deepest after 6, 18 and 48 sub-steps: {deepest:?} m");
        assert!(deepest[2] < 1e-6, "{vertices} vertices: {deepest:?}");
    }
}
