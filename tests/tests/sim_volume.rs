//! Hair against hair: its kernels against f64, both backends, what it costs where it is not asked for, and sleep.

#[path = "support/volume.rs"]
mod made;
mod support;

use glam::{DVec3, IVec4, Quat, Vec3, Vec4};
use made::{rig, rig_on};
use support::gpu;
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::sim::{Motion, Random, Rig, builtin, random_strands, strand_errors};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::reference::{self, Moving, VolumeForces, VolumeSums};
use tressfx_sim::step::{SectionInfo, Step};
use tressfx_sim::{
    HairSim, SectionDesc, SimError, SimParams, SleepParams, Solver, Stage, StepInput, SubStep, VolumeParams,
};

const SOLVERS: [Solver; 2] = [Solver::TressFx, Solver::Direct];
const SUB_STEP: f64 = 1.0 / 120.0;

/// A groom that is denser than at rest nearly everywhere, and rubs.
fn dense() -> VolumeParams {
    VolumeParams { cells: 24, rest_density: 0.1, sound_speed: 2.0, friction: 20.0 }
}

fn read<T: bytemuck::Pod>(rig: &mut Rig, ticket: tressfx_core::pass::Ticket) -> Vec<T> {
    bytemuck::pod_collect_to_vec(&rig.backend.read(ticket).ready().expect("the list has run"))
}

/// The sums and the values of all nodes.
fn nodes(rig: &mut Rig) -> (Vec<IVec4>, Vec<[Vec4; 2]>) {
    let [sums, values] = rig.run(|sim, list| sim.read_volume(list)).expect("it has a volume");
    (read(rig, sums), read(rig, values))
}

fn wide(points: &[Vec4]) -> Vec<DVec3> {
    points.iter().map(|point| point.truncate().as_dvec3()).collect()
}

/// A sub-step on a head that turns and moves.
fn step(strands: &Strands, solver: Solver) -> Step {
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.003, -0.002, 0.004);
    let rotation = turn * Quat::from_rotation_y(0.4);
    let center_displacement = Vec3::new(0.003, -0.004, 0.005) / strands.metres_per_unit;
    let sub_step = SubStep { head_turn: turn, center_displacement, ..SubStep::at_rest(SUB_STEP, rotation) };
    Step::new(&SimParams::default(), &SectionInfo::new(strands, solver), &sub_step, None)
}

/// The guides after some motion, and by what their solver says that they have moved in the last sub-step.
fn moved(rig: &mut Rig, solver: Solver) -> (Vec<DVec3>, Vec<DVec3>) {
    let motion = Motion::wild(&rig.strands[0]);
    rig.play(&motion, 0.3, 120);
    let before = wide(&rig.world(0));
    let frame = |frame: f64| motion.input(frame * SUB_STEP, SUB_STEP);
    assert_eq!(rig.frame(&frame(37.0)).sub_steps, 1);
    let guides = rig.strands[0].rest.len();
    let (here, after) = (wide(&rig.positions(0)[..guides]), wide(&rig.world(0)));
    let displacements = match solver {
        Solver::Direct => after.iter().zip(&before).map(|(after, before)| *after - *before).collect(),
        _ => here.iter().zip(wide(&rig.previous(0))).map(|(here, past)| *here - past).collect(),
    };
    (here, displacements)
}

/// By what the last kernel has displaced the guides in a sub-step, strand-major.
fn pushes(rig: &mut Rig, solver: Solver, before: &[Vec4]) -> Vec<DVec3> {
    if solver == Solver::TressFx {
        return before.iter().zip(rig.previous(0)).map(|(a, b)| (*a - b).truncate().as_dvec3()).collect();
    }
    let ticket = rig.run(|sim, list| sim.read_push(list, 0)).expect("rods are pushed");
    let pushes = read::<Vec4>(rig, ticket);
    let pushes = rig.strands[0].deinterleave(&pushes);
    wide(&pushes).iter().map(|push| *push * SUB_STEP * SUB_STEP).collect()
}

#[test]
fn the_kernels_do_what_their_f64_functions_do() {
    for solver in SOLVERS {
        let strands = random_strands(65, 16, 2, 5);
        let Some(mut rig) = rig(&strands, SimParams::default(), solver, &dense()) else { return };
        let (here, displacements) = moved(&mut rig, solver);
        let (step, previous) = (step(&strands, solver), rig.previous(0));
        for stage in [Stage::VolumeSplat, Stage::VolumeNodes, Stage::VolumePush] {
            rig.stage(&step, stage);
        }
        let (sums, values) = nodes(&mut rig);
        let (grid, center) = (rig.sim.volume_grid().unwrap(), rig.sim.center());
        let forces = VolumeForces::new(&dense(), strands.metres_per_unit);
        let masses = reference::vertex_masses(&strands);
        let unit = f64::from(1 << 30) / masses.iter().sum::<f64>();
        let seen = here.iter().zip(&displacements).zip(&masses).map(|((&here, &displacement), &mass)| {
            let (place, velocity) = reference::volume_vertex(&step, solver, None, here, displacement);
            Moving { place, velocity: velocity.clamp_length_max(forces.fastest), mass: mass * unit }
        });
        let seen: Vec<_> = seen.collect();

        let mut expected = VolumeSums::new(&grid);
        seen.iter().for_each(|v| reference::volume_splat(&grid, &mut expected, v.place, v.mass, v.velocity));
        let mut largest = [0.0_f64; 2];
        for (sum, expected) in sums.iter().zip(&expected.0) {
            let momentum = expected.truncate() / forces.fastest;
            largest[0] = largest[0].max((f64::from(sum.x) - expected.w).abs());
            let found = DVec3::new(sum.y.into(), sum.z.into(), sum.w.into());
            largest[1] = largest[1].max((found - momentum).abs().max_element());
        }
        let whole: i64 = sums.iter().map(|sum| i64::from(sum.x)).sum();
        assert!((whole - (1 << 30)).abs() < 20_000, "{whole} of all mass");
        // Of a vertex that counts a million.
        assert!(largest[0] < 300.0 && largest[1] < 300.0, "{solver:?}: {largest:?}");

        let rest = reference::rest_masses(&grid, &[&strands], center, dense().rest_density);
        let rest: Vec<_> = rest.iter().map(|mass| mass * unit).collect();
        let as_found = |sum: &IVec4| {
            let momentum = DVec3::new(sum.y.into(), sum.z.into(), sum.w.into()) * forces.fastest;
            momentum.extend(sum.x.into())
        };
        let expected = reference::volume_nodes(&grid, &VolumeSums(sums.iter().map(as_found).collect()), &rest);
        let steepest = expected.iter().map(|node| node.slope.length()).fold(0.0, f64::max);
        assert!(steepest > 1.0 / f64::from(grid.cell), "{solver:?}: hardly any pressure, {steepest}");
        for (value, expected) in values.iter().zip(&expected) {
            let [slope, velocity] = value.map(|value| value.truncate().as_dvec3());
            assert!(slope.distance(expected.slope) < 1e-5 * steepest, "{slope} instead of {}", expected.slope);
            assert!(velocity.distance(expected.velocity) < 1e-5 * forces.fastest);
        }

        let found = pushes(&mut rig, solver, &previous);
        let expected = reference::volume(&grid, &rest, &forces, SUB_STEP, &seen);
        let head = step.head_rotation.as_dvec4();
        let largest = expected.iter().map(|push| push.length()).fold(0.0, f64::max);
        let mut error = 0.0_f64;
        for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let expected =
                glam::DQuat::from_vec4(head) * if strands.rest[index].w == 0.0 { DVec3::ZERO } else { *expected };
            error = error.max(found.distance(expected));
        }
        println!("{solver:?}: pushes up to {largest:.1e}, off by {error:.1e}");
        assert!(largest > 1e-4 && error < 2e-3 * largest, "{solver:?}: {error:e} of {largest:e}");
    }
}

#[test]
fn a_groom_moves_as_in_f64() {
    for solver in SOLVERS {
        let strands = random_strands(65, 12, 1, 8);
        let volume = VolumeParams { sound_speed: 0.5, ..dense() };
        let Some(mut rig) = rig(&strands, SimParams::default(), solver, &volume) else { return };
        let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(solver);
        let mut reference =
            reference::Simulation::new(std::slice::from_ref(&desc)).unwrap().with_volume(&volume).unwrap();
        let mut without = reference::Simulation::new(&[desc]).unwrap();
        let motion = Motion::wild(&strands);
        rig.play(&motion, 0.25, 60);
        for frame in 0..=15 {
            let input = motion.input(f64::from(frame) / 60.0, if frame == 0 { 0.0 } else { 1.0 / 60.0 });
            for simulation in [&mut reference, &mut without] {
                simulation.step(&input).unwrap();
            }
        }
        let positions = rig.positions(0);
        let errors = strand_errors(&strands, &positions, &reference.positions(0));
        let apart = strand_errors(&strands, &positions, &without.positions(0));
        let (error, apart) = (errors[errors.len() * 99 / 100], apart[apart.len() / 2]);
        println!("{solver:?}: {error:.1e} (99%), {apart:.1e} (median) from one without");
        assert!(error < 2e-3 && apart > 5.0 * error, "{solver:?}: {error:e}, {apart:e}");
    }
}

#[test]
fn runs_are_equal_and_both_backends_agree_to_the_bit() {
    for solver in SOLVERS {
        let strands = random_strands(129, 16, 1, 9);
        let Some(gpu) = gpu() else { return };
        let vulkan =
            VulkanBackend::headless_with(&VulkanOptions { validation: true, ..VulkanOptions::default() }).unwrap();
        let again = support::gpu().expect("there was one");
        let states = [gpu as Box<dyn tressfx_core::backend::Run>, Box::new(vulkan), again].map(|backend| {
            let mut rig = rig_on(backend, &strands, SimParams::default(), solver, &dense());
            rig.play(&Motion::wild(&strands), 0.5, 60);
            (rig.positions(0), rig.previous(0), nodes(&mut rig))
        });
        assert!(states[0] == states[1] && states[0] == states[2], "{solver:?}");
    }
}

#[test]
fn friction_leaves_momentum_and_common_motion_as_they_are() {
    let strands = random_strands(40, 8, 0, 2);
    let mut list = PassList::new();
    let section = SectionDesc::new(&strands, SimParams::default());
    let sim = HairSim::with_volume(&mut NullBackend::default(), &mut list, &[section], 0, None, &dense()).unwrap();
    let grid = sim.volume_grid().unwrap();
    let forces = VolumeForces { sound_speed: 0.0, friction: 30.0, fastest: 16.0 };
    let rest = vec![1.0; grid.node_count() as usize];
    let mut random = Random::new(4);
    let mut vertices: Vec<Moving> = (0..500)
        .map(|_| Moving {
            place: random.vector().as_dvec3() * 0.1,
            velocity: random.vector().as_dvec3() * 3.0,
            mass: f64::from(random.signed()) + 1.5,
        })
        .collect();
    let pushes = reference::volume(&grid, &rest, &forces, SUB_STEP, &vertices);
    let changes = |pushes: &[DVec3], vertices: &[Moving]| -> (DVec3, f64) {
        let change = |(push, vertex): (&DVec3, &Moving)| *push / SUB_STEP * vertex.mass;
        let all: Vec<_> = pushes.iter().zip(vertices).map(change).collect();
        (all.iter().sum(), all.iter().map(|change| change.length()).sum())
    };
    let energy = |vertices: &[Moving]| -> f64 { vertices.iter().map(|v| v.mass * v.velocity.length_squared()).sum() };
    let (sum, size) = changes(&pushes, &vertices);
    assert!(size > 10.0 && sum.length() < 1e-12 * size, "{sum} of {size}");
    let before = energy(&vertices);
    vertices.iter_mut().zip(&pushes).for_each(|(vertex, push)| vertex.velocity += *push / SUB_STEP);
    assert!(energy(&vertices) < 0.95 * before, "{} of {before}", energy(&vertices));
    vertices.iter_mut().for_each(|vertex| vertex.velocity = DVec3::new(1.0, -2.0, 0.5));
    let (_, size) = changes(&reference::volume(&grid, &rest, &forces, SUB_STEP, &vertices), &vertices);
    assert!(size < 1e-9, "{size}");
}

/// What a scene does not use costs nothing.
#[test]
fn a_simulation_without_it_has_nothing_of_it() {
    let strands = random_strands(70, 8, 0, 1);
    for (solver, label) in [(Solver::TressFx, "hair.sim.tressfx"), (Solver::Direct, "hair.sim.direct")] {
        let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(solver);
        let passes = |volume: Option<&VolumeParams>| {
            let (mut backend, mut list) = (NullBackend::default(), PassList::new());
            let sections = std::slice::from_ref(&desc);
            let mut sim = match volume {
                Some(volume) => HairSim::with_volume(&mut backend, &mut list, sections, 0, None, volume),
                None => HairSim::new(&mut backend, &mut list, sections, 0),
            }
            .unwrap();
            let mut list = PassList::new();
            sim.step(&mut list, &StepInput::new(0.0, Pose::IDENTITY)).unwrap();
            let mut list = PassList::new();
            sim.step(&mut list, &StepInput::new(SUB_STEP, Pose::IDENTITY)).unwrap();
            let labels: Vec<_> = list.passes().map(|(label, _)| label).collect();
            let solver = backend.shaders.iter().find(|shader| shader.label == label).unwrap();
            (
                labels,
                list.commands().len(),
                solver.slots.len(),
                solver.wgsl.contains("push_slot"),
                backend.shaders.len(),
            )
        };
        let (without, with) = (passes(None), passes(Some(&VolumeParams::default())));
        assert_eq!(without.0, [label, "hair.sim.tangents"]);
        let volume = ["hair.sim.volume_splat", "hair.sim.volume_nodes", "hair.sim.volume_push"];
        assert_eq!(with.0, [&[label], &volume[..], &["hair.sim.tangents"]].concat());
        // And the sums are cleared.
        assert_eq!(with.1, without.1 + 4);
        assert_eq!((without.2, without.3, without.4 + 3), (with.2, false, with.4));
        assert_eq!(with.3, solver == Solver::Direct);
    }
}

#[test]
fn it_is_changed_or_refused() {
    let strands = random_strands(8, 8, 0, 1);
    let (mut backend, mut list) = (NullBackend::default(), PassList::new());
    let desc = SectionDesc::new(&strands, SimParams::default());
    let sections = std::slice::from_ref(&desc);
    let params = VolumeParams::default();
    let mut without = HairSim::new(&mut backend, &mut list, sections, 0).unwrap();
    assert_eq!(without.set_volume(&mut list, &params), Err(SimError::NoVolume));
    assert!(without.read_volume(&mut list).is_none() && without.read_push(&mut list, 0).is_none());
    let wrong = VolumeParams { cells: 200, ..params.clone() };
    let error = HairSim::with_volume(&mut backend, &mut list, sections, 0, None, &wrong).unwrap_err();
    assert!(error.to_string().contains("volume.cells = 200"), "{error}");
    let mut sim = HairSim::with_volume(&mut backend, &mut list, sections, 0, None, &params).unwrap();
    assert!(sim.set_volume(&mut list, &VolumeParams { cells: 20, ..params.clone() }).is_err());
    assert_eq!(sim.volume(), Some(&params));
    let softer = VolumeParams { sound_speed: 0.1, friction: 0.0, ..params };
    sim.set_volume(&mut list, &softer).unwrap();
    assert_eq!(sim.volume(), Some(&softer));
}

#[test]
fn hair_in_its_rest_pose_feels_no_push() {
    for solver in SOLVERS {
        let strands = builtin("curly", 60);
        let volume = VolumeParams { rest_density: 0.05, cells: 24, ..VolumeParams::default() };
        let Some(mut rig) = rig(&strands, SimParams::default(), solver, &volume) else { return };
        let head = Pose { rotation: Quat::from_rotation_z(1.0), translation: Vec3::X };
        rig.frame(&StepInput::new(0.0, head));
        let (_, values) = nodes(&mut rig);
        let slope = values.iter().map(|value| value[0].truncate().length()).fold(0.0, f32::max);
        assert!(slope * rig.sim.volume_grid().unwrap().cell < 1e-3, "{solver:?}: {slope}");
        assert!(values.iter().all(|value| value[1] == Vec4::ZERO));
    }
}

#[test]
fn a_groom_that_keeps_its_volume_may_sleep() {
    let strands = random_strands(48, 16, 1, 5);
    let volume = VolumeParams { cells: 20, rest_density: 0.2, ..VolumeParams::default() };
    let Some(mut rig) = rig(&strands, SimParams::default(), Solver::Direct, &volume) else { return };
    rig.sim.allow_sleep(&mut *rig.backend, SleepParams::default()).unwrap();
    rig.play(&Motion::wild(&strands), 0.5, 60);
    for frame in 0..900 {
        let mut list = PassList::new();
        if rig.sim.step(&mut list, &StepInput::new(1.0 / 60.0, Pose::IDENTITY)).unwrap().asleep {
            assert!(list.commands().is_empty());
            println!("asleep after {:.1} s", f64::from(frame) / 60.0);
            return;
        }
        rig.backend.run(&list).unwrap();
        if frame % 10 == 9
            && let Some(ticket) = rig.run(|sim, list| sim.request_motion(list))
        {
            let bytes: [u8; 4] = rig.backend.read(ticket.ticket).ready().unwrap().try_into().unwrap();
            rig.sim.measured_motion(&ticket, bytes);
        }
    }
    panic!("awake after 15 s");
}
