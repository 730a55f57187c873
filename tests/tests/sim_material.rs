//! What a stiffness of the published method is as a bending length.

use glam::Vec3;
use tressfx_conformance::sim::Motion;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_sim::bending_length::of_local_stiffness;
use tressfx_sim::reference::Simulation;
use tressfx_sim::{ClockParams, SectionDesc, SimParams, Solver};

const LENGTH: f32 = 0.2;
const G: f64 = 9.81;

/// A strand held horizontally, in metres.
fn strand(vertices: u16) -> Strands {
    let point = |i: u16| [LENGTH * f32::from(i) / f32::from(vertices - 1), 0.0, 0.0];
    let points = (0..vertices).map(point).collect();
    let asset = HairAsset::new("line", AssetFormat::Builtin, points, vec![vertices.into()]);
    let options = StrandOptions { follows: Some(0), metres_per_unit: Some(1.0), ..StrandOptions::default() };
    Strands::new(&asset, &options).unwrap()
}

/// The droop of the tip after 100 s, as a share of the length.
fn droop(vertices: u16, local_stiffness: f32, gravity: f64) -> f64 {
    let strands = strand(vertices);
    let gravity = Vec3::NEG_Y * gravity as f32;
    let params = SimParams { gravity, local_stiffness, global_stiffness: 0.0, damping: 0.01, ..SimParams::default() };
    let desc = SectionDesc::new(&strands, params).with_solver(Solver::TressFx);
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
    for vertices in [4, 8, 16, 32] {
        for local_stiffness in [0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 1.0] {
            let bending_length = f64::from(of_local_stiffness(local_stiffness, vertices.into(), LENGTH));
            // The theory of small deflections: `gravity L^4 / (8 EI)`. One in a hundred is small.
            let bending = G * bending_length.powi(3) / f64::from(LENGTH).powi(3);
            let droop = droop(vertices, local_stiffness, 0.08 * bending);
            let measured = bending_length * (0.01 / droop).cbrt();
            println!("{vertices} vertices, stiffness {local_stiffness}: {bending_length:.5} m, measured {measured:.5} m");
            assert!((bending_length / measured - 1.0).abs() < 0.1, "{vertices} {local_stiffness}: {measured}");
        }
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
