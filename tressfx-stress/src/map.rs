//! The map of stability: how fast strands still are half a second after a hard shake, over stiffness, sub-step and vertices.

use anyhow::{Context, Result};
use glam::{Quat, Vec3, Vec4};
use serde::{Deserialize, Serialize};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::Run;
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::Pose;
use tressfx_sim::{ClockParams, HairSim, SectionDesc, SimParams, StepInput};

use crate::case::SolverName;
use crate::dice::Dice;

/// Vertices of the panels.
pub const VERTICES: [u32; 5] = [4, 8, 16, 32, 64];
/// Sub-steps, in parts of a second.
pub const RATES: [u32; 7] = [30, 60, 120, 240, 480, 960, 1920];
/// Bending lengths of `Direct`, m.
pub const BENDING_LENGTHS: [f32; 7] = [0.002, 0.01, 0.03, 0.1, 0.4, 2.0, 10.0];
/// `local_stiffness` of `TressFx`; what one sees of it is `s / (1 - s)`.
pub const LOCAL_STIFFNESSES: [f32; 7] = [0.0, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0];

/// Strands of a cell.
const STRANDS: u32 = 16;
/// Their length, m.
const LENGTH: f32 = 0.2;
/// For so long the head is shaken, s.
const SHAKEN: f64 = 0.5;
/// For so long it then stands still, s.
const CALM: f64 = 0.5;
const FRAME: f64 = 1.0 / 60.0;

/// One square of the map.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Cell {
    /// What moves the strands.
    pub solver: SolverName,
    /// Vertices of a strand.
    pub vertices: u32,
    /// Sub-steps in a second.
    pub rate: u32,
    /// The place of the stiffness in [`BENDING_LENGTHS`] or [`LOCAL_STIFFNESSES`].
    pub stiffness: usize,
    /// The highest speed after half a second of calm, m/s; `None` where strands became non-finite.
    pub speed: Option<f64>,
}

/// Cells of one number of vertices, all stiffnesses and sub-steps.
///
/// # Errors
/// What the simulation or the backend says.
pub fn column(backend: &mut dyn Run, solver: SolverName, vertices: u32) -> Result<Vec<Cell>> {
    let strands = strands(vertices)?;
    let mut list = PassList::new();
    let desc = SectionDesc::new(&strands, params(solver, 0)).with_solver(solver.solver());
    let sim = HairSim::new(backend, &mut list, &[desc], 0)?;
    backend.run(&list)?;
    let mut shaker = Shaker { sim, backend, strands: &strands };
    let mut cells = Vec::new();
    for stiffness in 0..BENDING_LENGTHS.len() {
        shaker.sim.set_params(shaker.backend, 0, params(solver, stiffness))?;
        for rate in RATES {
            let speed = shaker.speed(rate)?;
            cells.push(Cell { solver, vertices, rate, stiffness, speed });
        }
    }
    shaker.sim.destroy(shaker.backend);
    Ok(cells)
}

/// The defaults but for the stiffness. Joints want the pose of the file as it is: else the bending length could be raised.
fn params(solver: SolverName, stiffness: usize) -> SimParams {
    let usual = SimParams { sag_free: 0.0, ..SimParams::default() };
    match solver {
        SolverName::Direct => SimParams { bending_length: BENDING_LENGTHS[stiffness], ..usual },
        SolverName::Tressfx => SimParams { local_stiffness: LOCAL_STIFFNESSES[stiffness], ..usual },
    }
}

/// Helices on a ball, from straight to tight.
fn strands(vertices: u32) -> Result<Strands> {
    let mut rolls = Dice::new(1).of("map");
    let mut points = Vec::new();
    for strand in 0..STRANDS {
        let along = rolls.direction();
        let across = along.any_orthonormal_vector();
        let (radius, turns) = (0.004 * (strand % 4) as f32, 1.0 + (strand / 4) as f32);
        for i in 0..vertices {
            let share = i as f32 / (vertices - 1) as f32;
            let around = Quat::from_axis_angle(along, std::f32::consts::TAU * turns * share) * across - across;
            points.push((along * (0.1 + LENGTH * share) + radius * around).to_array());
        }
    }
    let asset = HairAsset::new("map", AssetFormat::Builtin, points, vec![vertices; STRANDS as usize]);
    Ok(Strands::new(&asset, &StrandOptions { metres_per_unit: Some(1.0), ..StrandOptions::default() })?)
}

struct Shaker<'a> {
    sim: HairSim,
    backend: &'a mut dyn Run,
    strands: &'a Strands,
}

impl Shaker<'_> {
    /// Shakes from rest with sub-steps of one length.
    fn speed(&mut self, rate: u32) -> Result<Option<f64>> {
        let sub_step = 1.0 / f64::from(rate);
        self.sim.set_clock_params(ClockParams { sub_step, ..ClockParams::default() })?;
        self.sim.reset();
        let before = self.non_finite()?;
        let frames = (SHAKEN / FRAME) as u32;
        for frame in 0..=frames {
            let dt = if frame == 0 { 0.0 } else { FRAME };
            self.frame(dt, head(f64::from(frame) * FRAME))?;
        }
        let rest = head(f64::from(frames) * FRAME);
        let calm = (CALM / FRAME) as u32;
        (0..calm).try_for_each(|_| self.frame(FRAME, rest).map(drop))?;
        let one = self.positions(sub_step, rest)?;
        let other = self.positions(sub_step, rest)?;
        let pairs = one.iter().zip(&other).map(|(one, other)| f64::from(one.truncate().distance(other.truncate())));
        let speed = pairs.fold(0.0, |most, moved| if moved.is_nan() { f64::NAN } else { most.max(moved) }) / sub_step;
        Ok(Some(speed).filter(|speed| speed.is_finite()).filter(|_| self.non_finite().is_ok_and(|now| now == before)))
    }

    fn frame(&mut self, dt: f64, head: Pose) -> Result<PassList> {
        let mut list = PassList::new();
        self.sim.step(&mut list, &StepInput::new(dt, head))?;
        self.backend.run(&list)?;
        Ok(list)
    }

    fn positions(&mut self, dt: f64, head: Pose) -> Result<Vec<Vec4>> {
        let mut list = PassList::new();
        self.sim.step(&mut list, &StepInput::new(dt, head))?;
        let ticket = self.sim.read_positions(&mut list)[0];
        self.backend.run(&list)?;
        let bytes = self.backend.read(ticket).ready().context("a read-back is missing")?;
        Ok(self.strands.deinterleave(&bytemuck::pod_collect_to_vec::<u8, Vec4>(&bytes)))
    }

    fn non_finite(&mut self) -> Result<u32> {
        let mut list = PassList::new();
        let ticket = self.sim.read_non_finite(&mut list);
        self.backend.run(&list)?;
        Ok(bytemuck::pod_read_unaligned(&self.backend.read(ticket).ready().context("a read-back is missing")?))
    }
}

/// Shaken with 2 g at 4 Hz, and turned.
fn head(seconds: f64) -> Pose {
    let swing = |hertz: f64| (std::f64::consts::TAU * hertz * seconds).sin() as f32;
    Pose { rotation: Quat::from_rotation_y(0.5 * swing(1.0)), translation: Vec3::X * 0.031 * swing(4.0) }
}
