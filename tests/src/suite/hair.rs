//! Hair: each kernel of the simulation, a second of a groom, and its picture, against their f64 references.

use glam::{DVec3, EulerRot, Quat, Vec3};
use tressfx_core::backend::DepthOrder;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_render::Material;
use tressfx_sim::reference::{self, Guide};
use tressfx_sim::step::{SectionInfo, Step};
use tressfx_sim::{CapsuleMotion, SectionDesc, SimParams, Stage as Kernel, SubStep, Wind};

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
    Step::new(&params(), &SectionInfo::of(strands), &sub_step, Some(&Wind::new(Vec3::new(-3.0, 1.0, 2.0))))
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

/// Runs one kernel on the GPU's own state, and `reference` on the same.
fn kernel(t: &Subject, kernel: Kernel, reference: impl Fn(&Step, &mut Guide, u32, &[(Capsule, CapsuleMotion)])) {
    let (mut rig, step) = moved(t);
    let capsules = rig.centered();
    let before = state(&mut rig);
    rig.stage(&step, kernel);
    let (found, rest) = ((rig.positions(0), rig.previous(0)), rig.rest(0));
    let strands = &rig.strands[0];
    let [mut positions, mut previous] = before.clone();
    for guide in 0..strands.guides {
        let start = (guide * strands.vertices) as usize;
        let range = start..start + strands.vertices as usize;
        let mut of_guide = Guide {
            rest: &rest[range.clone()],
            rest_lengths: &strands.rest_lengths[range.clone()],
            positions: &mut positions[range.clone()],
            previous: &mut previous[range],
            own_root: None,
        };
        reference(&step, &mut of_guide, guide, &capsules);
    }
    assert!([&positions, &previous] != [&before[0], &before[1]], "it does something");
    for (found, expected) in [(&found.0[..positions.len()], &positions), (&found.1[..], &previous)] {
        let error = worst(strands, found, expected);
        assert!(error <= TOLERANCE, "{}: {error:e} of strand length", kernel.label());
    }
}

pub(super) fn integrate_is_as_in_f64(t: &mut Subject) {
    kernel(t, Kernel::Integrate, |step, guide, _, _| reference::integrate(step, guide));
}

pub(super) fn local_shape_is_as_in_f64(t: &mut Subject) {
    let iterations = params().local_iterations;
    kernel(t, Kernel::LocalShape, |step, guide, _, _| reference::local_shape(step, guide, iterations));
}

pub(super) fn wind_is_as_in_f64(t: &mut Subject) {
    kernel(t, Kernel::Wind, |step, guide, strand, _| reference::wind(step, guide, strand));
}

pub(super) fn lengths_is_as_in_f64(t: &mut Subject) {
    let sweeps = params().length_iterations;
    kernel(t, Kernel::Lengths, |step, guide, _, _| reference::lengths(step, guide, sweeps));
}

pub(super) fn recovery_is_as_in_f64(t: &mut Subject) {
    let (mut rig, step) = moved(t);
    let before = state(&mut rig);
    let (strands, buffers) = (rig.strands[0].clone(), rig.sim.buffers()[0]);
    let bad = 5 * buffers.shape.strands() + 3;
    rig.run(|_, list| list.upload(buffers.positions, 16 * u64::from(bad), &[f32::NAN]));
    rig.stage(&step, Kernel::Recovery);
    let (found, rest) = ([rig.positions(0), rig.previous(0)], rig.rest(0));
    let [mut positions, mut previous] = before;
    let vertices = strands.vertices as usize;
    let range = 3 * vertices..4 * vertices;
    positions[range.start + 5].x = f64::NAN;
    let mut of_guide = Guide {
        rest: &rest[range.clone()],
        rest_lengths: &strands.rest_lengths[range.clone()],
        positions: &mut positions[range.clone()],
        previous: &mut previous[range],
        own_root: None,
    };
    assert!(reference::recovery(&step, &mut of_guide));
    for (found, expected) in found.iter().zip([&positions, &previous]) {
        let error = worst(&strands, &found[..expected.len()], expected);
        assert!(error <= TOLERANCE, "{error:e} of strand length");
    }
    assert_eq!(rig.non_finite(), 1);
}

pub(super) fn collide_is_as_in_f64(t: &mut Subject) {
    kernel(t, Kernel::Collide, |step, guide, _, capsules| reference::collide(step, guide, capsules));
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
    let mut reference = reference::Simulation::new(&[SectionDesc::new(&strands, params)]).expect("fine");
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
