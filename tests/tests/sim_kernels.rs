//! The kernels of the published method, applied once, against their f64 references: on random strands of many counts and on real
//! grooms, each feature by itself.

mod support;

use glam::{DVec3, Quat, Vec3, Vec4};
use tressfx_conformance::sim::{
    Motion, REAL, Random, Rig, random_asset, random_strands, real, strand_errors, strands_of, wide, worst,
};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_sim::reference::{self, Guide};
use tressfx_sim::step::{SectionInfo, Step};
use tressfx_sim::{CapsuleMotion, SimParams, Solver, Stage, SubStep, Wind};

use support::rig;

/// Of the strand's length, for every strand.
const TOLERANCE: f64 = 1e-5;

fn params() -> SimParams {
    SimParams { global_stiffness: 0.3, global_range: 0.6, ..SimParams::default() }
}

/// What of a sub-step is held to its reference.
struct Case {
    name: &'static str,
    params: SimParams,
    wind: bool,
    capsules: bool,
}

/// All at once, and each feature by itself on chains that know gravity and lengths alone.
fn cases() -> Vec<Case> {
    let chain = SimParams { global_stiffness: 0.0, local_stiffness: 0.0, ..SimParams::default() };
    let no_lengths = SimParams { length_iterations: 0, ..chain.clone() };
    let case = |name, params| Case { name, params, wind: false, capsules: false };
    vec![
        Case { wind: true, capsules: true, ..case("all", params()) },
        case("lengths", chain.clone()),
        case("many iterations", SimParams { length_iterations: 7, local_iterations: 5, ..params() }),
        case("global shape", SimParams { global_stiffness: 0.3, global_range: 0.6, ..no_lengths.clone() }),
        case("local shape", SimParams { local_stiffness: 0.9, ..no_lengths.clone() }),
        Case { wind: true, ..case("wind", params()) },
        Case { capsules: true, ..case("capsules", no_lengths) },
        // Displacements at the limit, on both sides of it, and far below it.
        case("slow", SimParams { max_speed: 0.05, ..params() }),
        case("slower than its head", SimParams { max_speed: 0.3, shock: 0.3, ..params() }),
        case("fast", SimParams { max_speed: 1.0, shock: 0.6, ..params() }),
    ]
}

/// A ball inside of the roots of the random strands, and two solids among the tips.
fn capsules(strands: &Strands) -> Vec<Capsule> {
    let tips: Vec<Vec3> =
        strands.rest.chunks(strands.vertices as usize).map(|strand| strand[strand.len() - 1].truncate()).collect();
    let size = 0.12 * strands.bounds.radius();
    let (one, other) = (tips[0], tips[tips.len() / 2]);
    vec![
        Capsule { a: Vec3::ZERO, b: Vec3::ZERO, radius_a: 0.09 / strands.metres_per_unit, radius_b: 0.0 },
        Capsule { a: one, b: one + Vec3::new(size, -2.0 * size, 0.0), radius_a: size, radius_b: 0.5 * size },
        Capsule { a: other, b: other, radius_a: size, radius_b: size },
    ]
}

/// A sub-step in which everything happens. It moves vertices by less than the edges of the shortest strands are long: further
/// than that, where an edge points is a matter of rounding.
fn step(strands: &Strands, case: &Case) -> Step {
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.003, -0.002, 0.004);
    let rotation = turn * Motion::wild(strands).head(0.2).rotation;
    let sub_step = SubStep {
        time: 0.7,
        head_turn: turn,
        center_displacement: Vec3::new(0.0003, -0.0004, 0.0005) / strands.metres_per_unit,
        ..SubStep::at_rest(1.0 / 240.0, rotation)
    };
    let wind = case.wind.then(|| Wind::new(Vec3::new(-0.6, 0.2, 0.4)));
    Step::new(&case.params, &SectionInfo::new(strands, Solver::TressFx), &sub_step, wind.as_ref())
}

/// Positions and previous positions of the guides, in f64.
type State = (Vec<DVec3>, Vec<DVec3>);

fn state(rig: &mut Rig) -> State {
    let guides = rig.strands[0].rest.len();
    (wide(&rig.positions(0)[..guides]), wide(&rig.previous(0)))
}

/// The reference, applied to all guides.
fn expected(rig: &Rig, case: &Case, step: &Step, capsules: &[(Capsule, CapsuleMotion)], state: &mut State) {
    let (strands, rest) = (&rig.strands[0], rig.rest(0));
    let vertices = strands.vertices as usize;
    for guide in 0..strands.guides as usize {
        let range = guide * vertices..(guide + 1) * vertices;
        let mut of_guide = Guide {
            rest: &rest[range.clone()],
            rest_lengths: &strands.rest_lengths[range.clone()],
            positions: &mut state.0[range.clone()],
            previous: &mut state.1[range],
            own_root: None,
        };
        let spoiled = reference::tressfx(step, &case.params, &mut of_guide, guide as u32, capsules, &[]);
        assert!(!spoiled, "guide {guide} is finite");
    }
}

/// Runs a groom for a while, then the kernel of each case once, from the GPU's own state before it.
fn check(name: &str, strands: &Strands) {
    for case in cases() {
        check_case(&format!("{name}, {}", case.name), strands.clone(), &case);
    }
}

fn check_case(name: &str, strands: Strands, case: &Case) {
    let capsules = if case.capsules { capsules(&strands) } else { vec![] };
    let (step, motion) = (step(&strands, case), Motion { wind: None, ..Motion::wild(&strands) });
    let Some(mut rig) = rig(strands, case.params.clone(), &capsules) else { return };
    rig.play(&motion, 0.2, 60);
    let capsules = rig.centered();
    let before = state(&mut rig);
    rig.stage(&step, Stage::TressFx);
    let after = (rig.positions(0), rig.previous(0));
    let mut reference = before.clone();
    expected(&rig, case, &step, &capsules, &mut reference);
    let guides = reference.0.len();
    for (gpu, reference) in [(&after.0[..guides], &reference.0), (&after.1[..], &reference.1)] {
        let errors = strand_errors(&rig.strands[0], gpu, reference);
        let (median, largest) = (errors[errors.len() / 2], errors[errors.len() - 1]);
        // Next to the axis of a capsule rounding decides on the side to which a vertex is pushed.
        let held = if case.capsules { errors[(errors.len() - 1) * 99 / 100] } else { largest };
        println!("{name}: {median:.1e} (median) {held:.1e} (held) {largest:.1e} (largest) of strand length");
        assert!(held <= TOLERANCE && largest.is_finite(), "{name}: {held:e}");
    }
    assert!(reference.0 != before.0, "{name} moves");
    if case.capsules && rig.strands[0].guides >= 60 && rig.strands[0].vertices > 2 {
        let mut without = before;
        expected(&rig, case, &step, &[], &mut without);
        assert!(without.0 != reference.0, "{name}: something collides");
    }
    check_frame_end(name, &mut rig, &step);
}

fn check_frame_end(name: &str, rig: &mut Rig, step: &Step) {
    rig.stage(step, Solver::FRAME_END);
    let (positions, tangents) = (rig.positions(0), rig.tangents(0));
    let strands = &rig.strands[0];
    let (guides, vertices) = (strands.guides as usize, strands.vertices as usize);
    let all = wide(&positions);
    let follows: Vec<DVec3> = strands
        .follow_offsets
        .iter()
        .enumerate()
        .flat_map(|(index, &offset)| {
            let start = index % guides * vertices;
            reference::follow_strand(step, &all[start..start + vertices], offset, None)
        })
        .collect();
    let error = worst(strands, &positions[guides * vertices..], &follows);
    assert!(error <= TOLERANCE, "{name} hair.sim.tangents: follow strands: {error:e}");

    for (strand, (points, tangents)) in all.chunks(vertices).zip(tangents.chunks(vertices)).enumerate() {
        let expected = reference::tangents(points);
        for (vertex, (tangent, expected)) in tangents.iter().zip(expected).enumerate() {
            let error = tangent.truncate().as_dvec3().distance(expected);
            // Where a strand turns back on itself, the sum of the two directions is short.
            let allowed = 1e-5 / sum_of_directions(points, vertex).clamp(1e-5, 1.0);
            assert!(error < allowed, "{name} hair.sim.tangents: strand {strand} vertex {vertex}: {error:e}");
            assert_eq!(tangent.w, 0.0);
        }
    }
}

/// How long the sum of the directions of the edges at a vertex is: 1 at the ends, 2 where a strand is straight.
fn sum_of_directions(points: &[DVec3], vertex: usize) -> f64 {
    let edges = points.windows(2).skip(vertex.saturating_sub(1)).take(if vertex == 0 { 1 } else { 2 });
    edges.map(|edge| (edge[1] - edge[0]).normalize_or_zero()).sum::<DVec3>().length()
}

#[test]
fn kernels_match_their_references_for_every_vertex_count() {
    for vertices in [2, 3, 4, 7, 32, 256] {
        check(&format!("random of {vertices} vertices"), &random_strands(65, vertices, 2, u64::from(vertices)));
    }
}

#[test]
fn kernels_match_their_references_for_every_strand_count() {
    for guides in [1, 63, 64, 65] {
        check(&format!("{guides} random"), &random_strands(guides, 16, 1, u64::from(guides)));
    }
}

#[test]
fn kernels_match_their_references_with_both_ends_pinned() {
    let mut strands = random_strands(64, 12, 0, 5);
    for strand in strands.rest.chunks_mut(12) {
        strand[11].w = 0.0;
    }
    check("both ends pinned", &strands);
}

/// The first guide has no edge with a length, the second none at its root, the third none at its tip; follow strands have none
/// there either, or the spread gives them some.
#[test]
fn tangents_where_edges_have_no_length() {
    let (vertices, mut asset) = (8, random_asset(3, 8, 3));
    for (strand, range) in [0..8, 0..4, 4..8].into_iter().enumerate() {
        let points = &mut asset.points[strand * vertices..][range];
        points.fill(points[0]);
    }
    for tip_separation in [0.0, 1.5] {
        let params = SimParams { tip_separation: Some(tip_separation), ..params() };
        let Some(mut rig) = rig(strands_of(asset.clone(), 2), params, &[]) else { return };
        rig.frame(&Motion::still(&rig.strands[0]).input(0.0, 0.0));
        let (points, tangents) = (wide(&rig.positions(0)), rig.tangents(0));
        let expected = points.chunks(vertices).flat_map(reference::tangents);
        for (index, (tangent, expected)) in tangents.iter().zip(expected).enumerate() {
            let (strand, vertex) = (index / vertices, index % vertices);
            let error = tangent.truncate().as_dvec3().distance(expected);
            assert!(error < 1e-4, "{tip_separation}: strand {strand} vertex {vertex}: {tangent}, not {expected}");
        }
    }
}

/// Edges of a micrometre among longer ones point anywhere from one sub-step to the next, all but backwards too. There the length of the
/// turn from one direction to another is mostly rounding, if it follows from their dot product.
#[test]
fn strands_that_fold_back_on_themselves_stay_finite() {
    let mut random = Random::new(1);
    let mut points = Vec::new();
    for _ in 0..256 {
        let mut place = 0.1 * random.vector();
        for vertex in 0..64 {
            points.push(place.to_array());
            place += random.vector() * if vertex % 4 == 0 { 1e-2 } else { 1e-6 };
        }
    }
    let asset = HairAsset::new("folded", AssetFormat::Builtin, points, vec![64; 256]);
    let Some(mut rig) = rig(strands_of(asset, 0), SimParams::default(), &[]) else { return };
    let motion = Motion::wild(&rig.strands[0]);
    rig.play(&motion, 1.0, 60);
    assert_eq!(rig.non_finite(), 0);
}

#[test]
fn kernels_match_their_references_on_real_grooms() {
    for path in REAL {
        real(path).into_iter().for_each(|strands| check(path, &strands));
    }
}

#[test]
fn inverse_masses_stay_what_they_are() {
    let strands = random_strands(65, 9, 2, 1);
    let Some(mut rig) = rig(strands, params(), &[]) else { return };
    let motion = Motion::wild(&rig.strands[0]);
    rig.play(&motion, 0.1, 60);
    let positions = rig.positions(0);
    let rest = &rig.strands[0].rest;
    let expected: Vec<f32> = rest.iter().cycle().take(positions.len()).map(|vertex| vertex.w).collect();
    assert_eq!(positions.iter().map(|position: &Vec4| position.w).collect::<Vec<_>>(), expected);
}
