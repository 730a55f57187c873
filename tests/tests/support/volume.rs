//! Grooms with hair against hair.
#![allow(dead_code, reason = "each test takes what it needs")]

use std::f32::consts::TAU;

use glam::Vec3;
use tressfx_conformance::sim::{Random, Rig};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::Run;
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_sim::{HairSim, SectionDesc, SimParams, Solver, VolumeParams};

use crate::support::gpu;

/// A simulation of one section on wgpu.
pub(crate) fn rig(strands: &Strands, params: SimParams, solver: Solver, volume: &VolumeParams) -> Option<Rig> {
    Some(rig_on(gpu()?, strands, params, solver, volume))
}

/// With room for a collider.
pub(crate) fn rig_on(
    mut backend: Box<dyn Run>,
    strands: &Strands,
    params: SimParams,
    solver: Solver,
    volume: &VolumeParams,
) -> Rig {
    let desc = SectionDesc::new(strands, params).with_solver(solver);
    let mut list = PassList::new();
    let sim = HairSim::with_volume(&mut *backend, &mut list, &[desc], 1, None, volume).expect("the simulation is made");
    backend.run(&list).expect("the uploads run");
    Rig { backend, sim, strands: vec![strands.clone()], capsules: Vec::new() }
}

/// Strands of these vertices, in metres, in their order.
pub(crate) fn strands(each: &[Vec<Vec3>]) -> Strands {
    let vertices = each[0].len() as u32;
    let points = each.iter().flatten().map(Vec3::to_array).collect();
    let asset = HairAsset::new("made", AssetFormat::Builtin, points, vec![vertices; each.len()]);
    let options = StrandOptions {
        follows: Some(0),
        metres_per_unit: Some(1.0),
        shuffle: false,
        vertices: Some(vertices),
        ..StrandOptions::default()
    };
    Strands::new(&asset, &options).expect("the asset is fine")
}

/// Vertices of each strand of these grooms.
pub(crate) const VERTICES: u16 = 12;
/// Their length, m.
pub(crate) const LENGTH: f32 = 0.2;

/// 120 strands that lie one over the other from a wall at x = 0: 4 cm high, from y = 0 on, and 10 cm wide.
pub(crate) fn block() -> Strands {
    curly_block(0.0)
}

/// The same with three turns of this radius, m.
pub(crate) fn curly_block(radius: f32) -> Strands {
    let mut random = Random::new(11);
    let strand = |i: u16| {
        let (layer, place) = (f32::from(i / 12), f32::from(i % 12));
        let jitter = 0.001 * random.vector();
        let root = Vec3::new(0.0, 0.004 * (layer + 0.5), 0.1 * place / 11.0 - 0.05) + jitter;
        let phase = TAU * random.signed();
        let at = |v: u16| {
            let along = f32::from(v) / f32::from(VERTICES - 1);
            let (sin, cos) = (phase + 3.0 * TAU * along).sin_cos();
            root + LENGTH * along * Vec3::X + radius * Vec3::new(0.0, sin - phase.sin(), cos - phase.cos())
        };
        (0..VERTICES).map(at).collect()
    };
    strands(&(0..120).map(strand).collect::<Vec<Vec<Vec3>>>())
}
