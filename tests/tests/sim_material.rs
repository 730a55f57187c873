//! What a stiffness of the published method is as a bending length.

use glam::Vec3;
use tressfx_conformance::sim::Motion;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_sim::bending_length::of_local_stiffness;
use tressfx_sim::reference::Simulation;
use tressfx_sim::{ClockParams, Preset, SectionDesc, SimParams, Solver};

const LENGTH: f32 = 0.2;
const G: f32 = 9.81;

/// A strand held horizontally, in metres.
fn strand(vertices: u16) -> Strands {
    let point = |i: u16| [LENGTH * f32::from(i) / f32::from(vertices - 1), 0.0, 0.0];
    let points = (0..vertices).map(point).collect();
    let asset = HairAsset::new("line", AssetFormat::Builtin, points, vec![vertices.into()]);
    let options = StrandOptions { follows: Some(0), metres_per_unit: Some(1.0), ..StrandOptions::default() };
    Strands::new(&asset, &options).unwrap()
}

/// The droop of the tip after 100 s, as a share of the length.
fn droop(solver: Solver, vertices: u16, params: SimParams) -> f64 {
    let strands = strand(vertices);
    let desc = SectionDesc::new(&strands, params).with_solver(solver);
    let mut simulation = Simulation::new(&[desc]).unwrap();
    simulation.set_clock_params(ClockParams { sub_step: 1.0 / 60.0, ..ClockParams::default() }).unwrap();
    let motion = Motion::still(&strands);
    simulation.step(&motion.input(0.0, 0.0)).unwrap();
    for frame in 1..=6000 {
        simulation.step(&motion.input(f64::from(frame) / 60.0, 1.0 / 60.0)).unwrap();
    }
    let places = simulation.positions(0);
    (places[0].y - places[usize::from(vertices) - 1].y) / f64::from(LENGTH)
}

#[test]
fn a_local_stiffness_is_as_stiff_as_its_bending_length() {
    for vertices in [3, 4, 8, 16, 32] {
        for local_stiffness in [0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 1.0] {
            let bending_length = of_local_stiffness(local_stiffness, vertices.into(), LENGTH);
            // Under this gravity either droops by about a hundredth: where that is small, it goes with one over the cube of the bending length.
            let gravity = Vec3::NEG_Y * (0.08 * G * (bending_length / LENGTH).powi(3));
            let shapeless = SimParams { gravity, global_stiffness: 0.0, sag_free: 0.0, ..SimParams::default() };
            let published = SimParams { local_stiffness, damping: 0.01, ..shapeless.clone() };
            let rod = SimParams { bending_length, air_drag: 1.0, ..shapeless };
            let [published, rod] = [(Solver::TressFx, published), (Solver::Direct, rod)]
                .map(|(solver, params)| droop(solver, vertices, params));
            let measured = bending_length * (rod / published).cbrt() as f32;
            println!(
                "{vertices} vertices, stiffness {local_stiffness}: {bending_length:.5} m, measured {measured:.5} m"
            );
            assert!((bending_length / measured - 1.0).abs() < 0.13, "{vertices} {local_stiffness}: {measured}");
        }
    }
}

#[test]
fn presets_are_in_the_documents() {
    let text = include_str!("../../docs/materials.md");
    for preset in Preset::ALL {
        let Preset { name, what, bending_length, internal_damping, air_drag } = preset;
        let row = format!("| `{name}` | {what} | {bending_length} | {internal_damping} | {air_drag} |");
        assert!(text.contains(&row), "{row}");
    }
}

#[test]
fn a_bending_length_is_within_its_range_whatever_is_asked() {
    for (stiffness, vertices, length) in [(0.0, 32, 0.2), (-1.0, 0, 0.0), (2.0, 2, 1e9), (f32::NAN, 2, 0.1)] {
        let bending_length = of_local_stiffness(stiffness, vertices, length);
        let params = SimParams { bending_length, ..SimParams::default() };
        assert!(params.validate().is_ok() || stiffness.is_nan(), "{stiffness} {vertices} {length}: {bending_length}");
    }
}
