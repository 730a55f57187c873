//! A head that moves evenly: hair stays where the head carries it, or trails. It never runs ahead.

mod support;

use glam::{DVec3, Vec3};
use support::gpu;
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_conformance::sim::{Rig, builtin, random_strands, wide};
use tressfx_core::backend::Run;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::{SectionDesc, SimParams, Solver, StepInput, reference};

/// Speeds of the head, m/s.
const SPEEDS: [f32; 3] = [1.5, 5.0, 30.0];
const SHOCKS: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
const FPS: u32 = 60;
/// Until the jerk of the start has died away.
const FRAMES: u32 = 4 * FPS;
/// How far a tip may be from where the head carries it at shock 1, m.
const LEVEL: f64 = 1e-4;
/// What rounding moves a tip that trails by less, m.
const ROUNDING: f64 = 2e-6;

/// A head that goes along x, with a little of the other axes.
fn direction() -> Vec3 {
    Vec3::new(1.0, 0.1, -0.2).normalize()
}

/// The inputs of a head at a speed in m/s.
fn inputs(strands: &Strands, speed: f32) -> impl Iterator<Item = StepInput<'static>> + use<> {
    let step = direction() * (speed / FPS as f32 / strands.metres_per_unit);
    (0..=FRAMES).map(move |frame| {
        let head = Pose { translation: step * frame as f32, ..Pose::IDENTITY };
        StepInput::new(if frame == 0 { 0.0 } else { 1.0 / f64::from(FPS) }, head)
    })
}

/// Tips of the guides relative to the centre of the groom, m.
fn tips(strands: &Strands, positions: &[DVec3]) -> Vec<DVec3> {
    let vertices = strands.vertices as usize;
    let guides = positions.chunks(vertices).take(strands.guides as usize);
    guides.map(|strand| strand[vertices - 1] * f64::from(strands.metres_per_unit)).collect()
}

fn in_f64(strands: &Strands, shock: f32, speed: f32) -> Vec<DVec3> {
    let params = SimParams { shock, ..SimParams::default() };
    let mut sim =
        reference::Simulation::new(&[SectionDesc::new(strands, params).with_solver(Solver::TressFx)]).unwrap();
    inputs(strands, speed).for_each(|input| assert!(sim.step(&input).is_ok()));
    tips(strands, &sim.positions(0))
}

fn on(backend: Box<dyn Run>, strands: &Strands, shock: f32, speed: f32) -> Vec<DVec3> {
    let params = SimParams { shock, ..SimParams::default() };
    let mut rig = Rig::new(backend, vec![(strands.clone(), params)], &[]);
    for input in inputs(strands, speed) {
        rig.frame(&input);
    }
    tips(strands, &wide(&rig.positions(0)))
}

/// How far tips are ahead of where they are on a head at rest, the most of them, and how far off they are to any side; m.
fn ahead(moving: &[DVec3], still: &[DVec3]) -> (f64, f64) {
    let ways = moving.iter().zip(still).map(|(moving, still)| *moving - *still);
    ways.fold((f64::NEG_INFINITY, 0.0), |(ahead, off), way| {
        (f64::max(ahead, way.dot(direction().as_dvec3())), f64::max(off, way.length()))
    })
}

fn hold(name: &str, strands: &Strands, shocks: &[f32], run: impl Fn(f32, f32) -> Vec<DVec3>) {
    let still = run(1.0, 0.0);
    for speed in SPEEDS {
        for &shock in shocks {
            let (ahead, off) = ahead(&run(shock, speed), &still);
            let (ahead_mm, off_mm) = (1e3 * ahead, 1e3 * off);
            println!(
                "{name}, {} vertices, {speed} m/s, shock {shock}: {ahead_mm:+.4} mm ahead, {off_mm:.4} mm off",
                strands.vertices
            );
            assert!(shock < 1.0 || off < LEVEL, "{name} at {speed} m/s: {off_mm} mm from where the head carries it");
            assert!(shock == 1.0 || ahead < ROUNDING, "{name} at {speed} m/s, shock {shock}: {ahead_mm} mm ahead");
        }
    }
}

#[test]
fn hair_trails_an_even_head_or_is_level_in_f64() {
    for vertices in [4, 8, 16, 32] {
        let strands = random_strands(12, vertices, 0, 7);
        hold("random", &strands, &SHOCKS, |shock, speed| in_f64(&strands, shock, speed));
    }
    // Curls tremble on a head at rest too.
    for name in ["straight", "long", "wavy"] {
        let strands = builtin(name, 12);
        hold(name, &strands, &SHOCKS, |shock, speed| in_f64(&strands, shock, speed));
    }
}

#[test]
fn hair_trails_an_even_head_or_is_level_on_both_backends() {
    let strands = builtin("long", 40);
    let shocks = [0.0, 0.75, 1.0];
    let Some(first) = gpu() else { return };
    drop(first);
    hold("wgpu", &strands, &shocks, |shock, speed| on(gpu().expect("there is one"), &strands, shock, speed));
    let vulkan = || Box::new(VulkanBackend::headless().expect("wgpu has an adapter"));
    hold("vulkan", &strands, &shocks, |shock, speed| on(vulkan(), &strands, shock, speed));
}
