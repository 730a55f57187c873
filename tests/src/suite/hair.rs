//! Hair: each kernel of the simulation, a second of a groom, and its picture, against their f64 references.

use glam::{DVec3, EulerRot, Quat, Vec3, Vec4};
use tressfx_core::backend::DepthOrder;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_render::Material;
use tressfx_sim::reference::{self, Guide};
use tressfx_sim::step::{SectionInfo, Step};
use tressfx_sim::{SectionDesc, SimParams, Solver, Stage as Kernel, SubStep, Wind};

use super::subject::Subject;
use crate::render::{Groom, Screen};
use crate::sim::{Motion, Rig, random_strands, strand_errors, wide, worst};

/// Of a strand's length, for one kernel.
const TOLERANCE: f64 = 1e-5;
/// Of a strand's length, for a second, for all strands but one in a hundred.
const TOLERANCE_OF_A_SECOND: f64 = 1e-3;

fn params() -> SimParams {
    SimParams { global_stiffness: 0.3, global_range: 0.6, ..SimParams::default() }
}

/// A ball inside of the roots of the random strands, and one among the tips.
fn capsules(strands: &Strands) -> Vec<Capsule> {
    let tip = strands.rest[strands.vertices as usize - 1].truncate();
    let ball = |at: Vec3, radius: f32| Capsule { a: at, b: at, radius_a: radius, radius_b: radius };
    vec![ball(Vec3::ZERO, 0.09), ball(tip, 0.12 * strands.bounds.radius())]
}

/// A sub-step in which everything happens, and nothing moves further than the shortest edge is long.
fn step(strands: &Strands) -> Step {
    let turn = Quat::from_euler(EulerRot::XYZ, 0.003, -0.002, 0.004);
    let rotation = turn * Motion::wild(strands).head(0.1).rotation;
    let sub_step = SubStep {
        time: 0.7,
        head_turn: turn,
        center_displacement: Vec3::new(0.0003, -0.0004, 0.0005),
        ..SubStep::at_rest(1.0 / 240.0, rotation)
    };
    Step::new(
        &params(),
        &SectionInfo::new(strands, Solver::TressFx),
        &sub_step,
        Some(&Wind::new(Vec3::new(-3.0, 1.0, 2.0))),
    )
}

/// Random strands that have moved for a while, a step for them, and capsules relative to their centre.
fn moved(t: &Subject) -> (Rig, Step) {
    let strands = random_strands(24, 12, 1, 9);
    let (step, capsules, motion) = (step(&strands), capsules(&strands), Motion::wild(&strands));
    let mut rig = Rig::new(t.another(), vec![(strands, params())], &capsules);
    rig.play(&motion, 0.1, 60);
    (rig, step)
}

/// Positions and previous positions of the guides.
fn state(rig: &mut Rig) -> [Vec<DVec3>; 2] {
    let guides = rig.strands[0].rest.len();
    [wide(&rig.positions(0)[..guides]), wide(&rig.previous(0))]
}

/// A slice of each array of a section for one of its guides.
fn guide_of<'a>(strands: &'a Strands, rest: &'a [Vec4], state: &'a mut [Vec<DVec3>; 2], guide: usize) -> Guide<'a> {
    let vertices = strands.vertices as usize;
    let range = guide * vertices..(guide + 1) * vertices;
    let [positions, previous] = state;
    Guide {
        rest: &rest[range.clone()],
        rest_lengths: &strands.rest_lengths[range.clone()],
        positions: &mut positions[range.clone()],
        previous: &mut previous[range],
        own_root: None,
    }
}

/// The error of the guides' positions and past ones, as a share of strand length.
fn error(rig: &mut Rig, expected: &[Vec<DVec3>; 2]) -> f64 {
    let found = [rig.positions(0), rig.previous(0)];
    let errors = found.iter().zip(expected).map(|(found, expected)| {
        let guides = &found[..expected.len()];
        worst(&rig.strands[0], guides, expected)
    });
    errors.fold(0.0, f64::max)
}

pub(super) fn tressfx_is_as_in_f64(t: &mut Subject) {
    let (mut rig, step) = moved(t);
    let (capsules, rest, strands) = (rig.centered(), rig.rest(0), rig.strands[0].clone());
    let before = state(&mut rig);
    rig.stage(&step, Kernel::TressFx);
    let mut expected = before.clone();
    for guide in 0..strands.guides {
        let mut of_guide = guide_of(&strands, &rest, &mut expected, guide as usize);
        assert!(!reference::tressfx(&step, &params(), &mut of_guide, guide, &capsules, &[]), "it is finite");
    }
    assert!(expected != before, "it does something");
    let error = error(&mut rig, &expected);
    assert!(error <= TOLERANCE, "{error:e} of strand length");
}

pub(super) fn a_strand_that_is_no_numbers_goes_to_rest(t: &mut Subject) {
    let (mut rig, step) = moved(t);
    let (capsules, rest, strands) = (rig.centered(), rig.rest(0), rig.strands[0].clone());
    let mut expected = state(&mut rig);
    let buffers = rig.sim.buffers()[0];
    let bad = 5 * buffers.shape.strands() + 3;
    rig.run(|_, list| list.upload(buffers.positions, 16 * u64::from(bad), &[f32::NAN]));
    rig.stage(&step, Kernel::TressFx);
    expected[0][3 * strands.vertices as usize + 5].x = f64::NAN;
    for guide in 0..strands.guides {
        let mut of_guide = guide_of(&strands, &rest, &mut expected, guide as usize);
        let spoiled = reference::tressfx(&step, &params(), &mut of_guide, guide, &capsules, &[]);
        assert_eq!(spoiled, guide == 3);
    }
    let error = error(&mut rig, &expected);
    assert!(error <= TOLERANCE, "{error:e} of strand length");
    assert_eq!(rig.non_finite(), 1);
}

pub(super) fn tangents_is_as_in_f64(t: &mut Subject) {
    let (mut rig, step) = moved(t);
    rig.stage(&step, Kernel::Tangents);
    let (positions, tangents) = (rig.positions(0), rig.tangents(0));
    let strands = &rig.strands[0];
    let (vertices, all) = (strands.vertices as usize, wide(&positions));
    let guides: Vec<_> = all.chunks(vertices).take(strands.guides as usize).collect();
    let offsets = strands.follow_offsets.iter().zip(guides.iter().cycle());
    let follows: Vec<_> =
        offsets.flat_map(|(&offset, guide)| reference::follow_strand(&step, guide, offset, None)).collect();
    let error = worst(strands, &positions[strands.rest.len()..], &follows);
    assert!(!follows.is_empty() && error <= TOLERANCE, "{error:e} of strand length");
    for (points, tangents) in all.chunks(vertices).zip(tangents.chunks(vertices)) {
        for (found, expected) in tangents.iter().zip(reference::tangents(points)) {
            let error = found.truncate().as_dvec3().distance(expected);
            assert!(error < 1e-4, "{found} is not {expected}");
        }
    }
}

pub(super) fn a_second_is_as_in_f64(t: &mut Subject) {
    let strands = random_strands(64, 16, 0, 3);
    let (motion, params) = (Motion::turning(&strands), SimParams::default());
    let mut rig = Rig::new(t.another(), vec![(strands.clone(), params.clone())], &[]);
    let mut reference =
        reference::Simulation::new(&[SectionDesc::new(&strands, params).with_solver(Solver::TressFx)]).expect("fine");
    rig.play(&motion, 1.0, 60);
    for frame in 0..=60 {
        let dt = if frame == 0 { 0.0 } else { 1.0 / 60.0 };
        reference.step(&motion.input(f64::from(frame) / 60.0, dt)).expect("the input is fine");
    }
    let errors = strand_errors(&strands, &rig.positions(0), &reference.positions(0));
    let most = errors[(errors.len() - 1) * 99 / 100];
    assert!(most < TOLERANCE_OF_A_SECOND, "{most:e} of strand length");
}

fn material() -> Material {
    Material::default().with(|m| {
        m.fibre_radius = Some(0.005);
        m.opacity = 0.7;
        m.tip_opacity = 0.5;
    })
}

fn picture_of(t: &Subject, order: DepthOrder) {
    let mut screen = Screen::new(t.another(), |setup| (setup.ppll().k, setup.camera.depth) = (16, order));
    let groom = Groom::wavy(60, 12, 1, material());
    let exact = screen.exact(&[&groom]);
    let difference = screen.hair(&[&groom]).difference(&exact);
    assert!(exact.iter().any(|pixel| pixel.w > 0.5), "the groom is in the picture");
    assert!(difference.max < 0.005 && difference.psnr > 65.0, "{order:?}: {difference:?}");
}

pub(super) fn a_picture_is_as_in_f64_in_standard_order(t: &mut Subject) {
    picture_of(t, DepthOrder::Standard);
}

pub(super) fn a_picture_is_as_in_f64_in_reverse_order(t: &mut Subject) {
    picture_of(t, DepthOrder::Reverse);
}

pub(super) fn a_picture_is_the_same_twice_to_the_bit(t: &mut Subject) {
    let groom = Groom::wavy(300, 12, 2, material());
    let mut screen = Screen::new(t.another(), |_| ());
    let first = screen.hair(&[&groom]);
    let mut other = Screen::new(t.another(), |_| ());
    for again in [screen.hair(&[&groom]), other.hair(&[&groom])] {
        assert_eq!(first.counters, again.counters);
        assert!(first.bytes == again.bytes);
    }
}
