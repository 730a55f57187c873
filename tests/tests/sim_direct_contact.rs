//! The contacts of the `Direct` solver's kernel: against its f64 function, on a slope, and on both backends.

mod support;

use glam::{Quat, Vec3};
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_conformance::sim::{Motion, Rig, builtin, random_strands, strand_errors};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::Pose;
use tressfx_sim::{Collider, SectionDesc, SimParams, Solver, StepInput, metrics, reference};

use support::{gpu, taken_for};

const DT: f64 = 1.0 / 60.0;

fn rig(strands: &Strands, params: &SimParams, most: usize) -> Option<Rig> {
    rig_taken_for(true, strands, params, most)
}

/// On a CPU a thread goes along a strand, on a GPU several go together.
fn rig_taken_for(is_cpu: bool, strands: &Strands, params: &SimParams, most: usize) -> Option<Rig> {
    let backend = taken_for(*gpu()?, is_cpu);
    Some(Rig::with_colliders(backend, strands.clone(), params.clone(), Solver::Direct, &[], most))
}

fn capsule(a: Vec3, b: Vec3, radius_a: f32, radius_b: f32) -> Capsule {
    Capsule { a, b, radius_a, radius_b }
}

/// What swings and turns through the middle of a groom, and what rides on its head.
fn colliders(strands: &Strands, frame: u32) -> Vec<Collider<'static>> {
    let bounds = strands.guide_bounds();
    let (center, size) = (0.5 * (bounds.min + bounds.max), (bounds.max - bounds.min).max_element());
    let swung = |frame: u32| {
        let angle = 0.08 * frame as f32;
        let rotation = Quat::from_rotation_z(0.5 * angle);
        Pose { rotation, translation: center + size * Vec3::new(0.6 * angle.cos(), -0.1, 0.6 * angle.sin()) }
    };
    let bar = capsule(0.3 * size * Vec3::NEG_X, 0.3 * size * Vec3::X, 0.1 * size, 0.06 * size);
    let post = capsule(center - 0.3 * size * Vec3::Y, center - 0.05 * size * Vec3::Y, 0.1 * size, 0.2 * size);
    vec![Collider::free(bar, swung(frame.max(1) - 1), swung(frame)), Collider::with_head(post)]
}

#[test]
fn the_kernel_does_what_its_f64_function_does() {
    does_what_its_f64_function_does(true);
}

#[test]
fn threads_that_go_along_a_strand_together_do_what_the_f64_function_does() {
    does_what_its_f64_function_does(false);
}

fn does_what_its_f64_function_does(is_cpu: bool) {
    let groups = [
        ("random, 2", random_strands(65, 2, 0, 3)),
        ("random, 16", random_strands(65, 16, 1, 3)),
        ("long", builtin("long", 200)),
        ("random, 64", random_strands(65, 64, 0, 3)),
        ("curly", builtin("curly", 200)),
    ];
    // A barrier is dear on a CPU.
    for (name, strands) in groups.into_iter().take(if is_cpu { 5 } else { 3 }) {
        let params = SimParams::default();
        let motion = Motion { wind: None, ..Motion::turning(&strands) };
        let Some(mut rig) = rig_taken_for(is_cpu, &strands, &params, 2) else { return };
        let desc = SectionDesc::new(&strands, params).with_solver(Solver::Direct);
        let mut reference = reference::Simulation::new(&[desc]).unwrap();
        let untouched = reference_without_colliders(&strands, &motion);
        for frame in 0..=20 {
            let dt = if frame == 0 { 0.0 } else { DT };
            let colliders = colliders(&strands, frame);
            let input = motion.input(f64::from(frame) * DT, dt).with_colliders(&colliders);
            rig.frame(&input);
            reference.step(&input).unwrap();
        }
        assert_eq!((rig.non_finite(), reference.non_finite()), (0, 0));
        let errors = strand_errors(&strands, &rig.positions(0), &reference.positions(0));
        let at = |share: usize| errors[(errors.len() - 1) * share / 100];
        let edges = metrics::edge_error(&strands, &rig.positions(0)).max;
        let vertices = strands.vertices as usize;
        let moved = reference.positions(0);
        let pairs = moved.chunks(vertices).zip(untouched.chunks(vertices));
        let touched = pairs.filter(|(one, other)| one.iter().zip(*other).any(|(a, b)| a.distance(*b) > 1e-4)).count();
        println!(
            "{name}: {touched} of {} strands were touched; {:.1e} (median) {:.1e} (90%) {:.1e} (largest), edges {edges:.1e}",
            errors.len(),
            at(50),
            at(90),
            at(100)
        );
        // Where a strand just touches or just slides, rounding decides.
        assert!(touched > errors.len() / 20, "{name}: {touched}");
        assert!(at(50) < 1e-4 && at(90) < 1e-2 && edges < 2e-5, "{name}: {:e} {:e} {edges:e}", at(50), at(90));
    }
}

fn reference_without_colliders(strands: &Strands, motion: &Motion) -> Vec<glam::DVec3> {
    let desc = SectionDesc::new(strands, SimParams::default()).with_solver(Solver::Direct);
    let mut reference = reference::Simulation::new(&[desc]).unwrap();
    for frame in 0..=20 {
        let dt = if frame == 0 { 0.0 } else { DT };
        reference.step(&motion.input(f64::from(frame) * DT, dt)).unwrap();
    }
    reference.positions(0)
}

#[test]
fn both_backends_agree_to_the_bit() {
    [true, false].into_iter().for_each(both_backends_agree);
}

fn both_backends_agree(is_cpu: bool) {
    let strands = random_strands(65, 24, 1, 9);
    let Some(gpu) = gpu() else { return };
    let params = SimParams { internal_damping: 1e-3, ..SimParams::default() };
    let made = |backend| Rig::with_colliders(backend, strands.clone(), params.clone(), Solver::Direct, &[], 2);
    let mut one = made(taken_for(*gpu, is_cpu));
    let vulkan = {
        let _alone = tressfx_backend_vulkan::lock_loader();
        VulkanBackend::headless().expect("a Vulkan device")
    };
    let mut other = made(taken_for(vulkan, is_cpu));
    let motion = Motion::wild(&strands);
    for frame in 0..=30 {
        let dt = if frame == 0 { 0.0 } else { DT };
        let colliders = colliders(&strands, frame);
        let input = motion.input(f64::from(frame) * DT, dt).with_colliders(&colliders);
        one.frame(&input);
        other.frame(&input);
    }
    assert_eq!(one.positions(0), other.positions(0));
}

/// A straight strand of 20 cm along x.
fn straight(vertices: u32) -> Strands {
    let points: Vec<_> = (0..vertices).map(|i| [0.2 * i as f32 / (vertices - 1) as f32, 0.0, 0.0]).collect();
    let asset = HairAsset::new("straight", AssetFormat::Builtin, points, vec![vertices]);
    let masses = (0..vertices).map(|i| if i == 0 { 0.0 } else { 1.0 }).collect();
    let asset = HairAsset { inverse_mass: Some(masses), ..asset };
    let options = StrandOptions { follows: Some(0), metres_per_unit: Some(1.0), ..StrandOptions::default() };
    Strands::new(&asset, &options).unwrap()
}

/// How fast the tip of a strand on a slope goes down after two seconds, m/s, and how far it got, m. The slope is the top of a long cylinder.
fn on_slope(vertices: u32, degrees: f32) -> Option<[f32; 2]> {
    let strands = straight(vertices);
    let slope = degrees.to_radians();
    let params = SimParams {
        gravity: 9.81 * Vec3::new(0.0, -slope.cos(), slope.sin()),
        bending_length: 0.01,
        sag_free: 0.0,
        friction: 0.4,
        air_drag: 1.0,
        ..SimParams::default()
    };
    let mut rig = rig(&strands, &params, 1)?;
    let ground = capsule(Vec3::new(-1.0, -0.3, 0.0), Vec3::new(1.0, -0.3, 0.0), 0.3, 0.3);
    let colliders = [Collider::with_head(ground)];
    let mut frame = |dt: f64| {
        rig.frame(&StepInput::new(dt, Pose::IDENTITY).with_colliders(&colliders));
        rig.world(0)
    };
    let start = frame(0.0);
    for _ in 0..120 {
        frame(DT);
    }
    let before = frame(0.0);
    for _ in 0..15 {
        frame(DT);
    }
    let after = frame(0.0);
    let tip = vertices as usize - 1;
    Some([after[tip].distance(before[tip]) / 0.25, after[tip].distance(start[tip])])
}

#[test]
fn strands_stay_on_a_slope_until_friction_yields() {
    for vertices in [2, 8, 32] {
        let Some([creep, down]) = on_slope(vertices, 20.0) else { return };
        let [_, slid] = on_slope(vertices, 25.0).unwrap();
        println!("{vertices} vertices: 20 degrees {creep:.1e} m/s, {down:.1e} m down; 25 degrees {slid:.2} m down");
        // A single edge from a root on the surface hops on the spot instead of sliding, in f64 too: an open fault.
        let slides = vertices == 2 || slid > 0.08;
        assert!(creep < 1e-6 && down < 3e-3 && slides, "{vertices}: {creep:e} {down:e} {slid}");
    }
}
