//! A simulation on the GPU, frame by frame.

use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use glam::{DVec3, Vec4};
use tressfx_core::backend::Run as Gpu;
use tressfx_core::pass::PassList;
use tressfx_core::strands::Strands;
use tressfx_sim::reference::direct::RodRest;
use tressfx_sim::{HairSim, SectionDesc, StepInput, metrics};

use crate::case::{Case, FPS};
use crate::method::{Family, Method};

/// Tips from their roots over the lengths of their strands: of each time, one a strand.
pub(crate) type Tips = Vec<Vec<DVec3>>;

/// A groom that a method moves.
pub(crate) struct Drive<'a> {
    gpu: &'a mut dyn Gpu,
    sim: HairSim,
    strands: &'a Strands,
    case: &'a Case,
    /// GPU time of the passes of the last frame, ms; none where the device cannot time passes.
    frame_ms: Option<f64>,
}

impl<'a> Drive<'a> {
    /// A case at rest.
    pub(crate) fn new(gpu: &'a mut dyn Gpu, strands: &'a Strands, case: &'a Case, method: &Method) -> Result<Self> {
        let desc = SectionDesc::new(strands, method.params(&case.params)).with_solver(method.solver());
        let mut uploads = PassList::new();
        let mut sim = HairSim::new(gpu, &mut uploads, &[desc], 0)?;
        sim.set_clock_params(method.clock())?;
        gpu.run(&uploads)?;
        let mut drive = Self { gpu, sim, strands, case, frame_ms: None };
        drive.frame(&drive.case.input(0.0, 0.0, drive.strands.metres_per_unit))?;
        Ok(drive)
    }

    fn frame(&mut self, input: &StepInput) -> Result<()> {
        let mut list = PassList::new();
        self.sim.step(&mut list, input)?;
        self.gpu.run(&list)?;
        let timings = self.gpu.timings();
        let sum = timings.iter().map(|timing| timing.nanoseconds).sum::<f64>() * 1e-6;
        self.frame_ms = (!timings.is_empty()).then_some(sum);
        Ok(())
    }

    /// The frame of this number, from 1.
    pub(crate) fn go(&mut self, frame: u32, fps: u32) -> Result<()> {
        let dt = 1.0 / f64::from(fps);
        self.frame(&self.case.input(f64::from(frame) * dt, dt, self.strands.metres_per_unit))
    }

    /// Positions of the guides, strand-major, in the unit of the file.
    pub(crate) fn positions(&mut self) -> Result<Vec<Vec4>> {
        let mut list = PassList::new();
        let tickets = self.sim.read_positions(&mut list);
        self.gpu.run(&list)?;
        let bytes = self.gpu.read(tickets[0]).ready().context("the list has run, but a read-back is missing")?;
        Ok(self.strands.deinterleave(&bytemuck::pod_collect_to_vec::<u8, Vec4>(&bytes)))
    }

    /// Tips at every `every`th frame after a frame, and the largest error of an edge then.
    pub(crate) fn tips(mut self, fps: u32, frames: u32, after: u32, every: u32) -> Result<(Tips, f64)> {
        let (mut tips, mut edges) = (Tips::new(), 0.0_f64);
        for frame in 1..=frames {
            self.go(frame, fps)?;
            if frame > after && frame % every == 0 {
                let positions = self.positions()?;
                edges = edges.max(metrics::edge_error(self.strands, &positions).max);
                let wide: Vec<DVec3> = positions.iter().map(|place| place.truncate().as_dvec3()).collect();
                tips.push(tips_of(self.strands, &wide));
            }
        }
        Ok((tips, edges))
    }

    /// Goes on for so long on the clock, and is given up: a GPU that has waited for the answer to a case takes its time to raise its clocks.
    pub(crate) fn warm_up(mut self, time: Duration) -> Result<()> {
        let start = Instant::now();
        (1..).take_while(|_| start.elapsed() < time).try_for_each(|frame| self.go(frame, FPS))
    }

    /// GPU time of 1/60 s of motion, ms: the median over pairs of frames, since a long sub-step takes two.
    pub(crate) fn milliseconds(mut self, pairs: u32) -> Result<Option<f64>> {
        let mut times = Vec::new();
        for pair in 0..=pairs {
            let mut sum = 0.0;
            for frame in [2 * pair + 1, 2 * pair + 2] {
                self.go(frame, FPS)?;
                // A frame without a sub-step has no passes.
                sum += self.frame_ms.unwrap_or(0.0);
            }
            times.push(sum / 2.0);
        }
        // The first pair pays for what only happens once.
        let mut times = times.split_off(1);
        times.sort_by(f64::total_cmp);
        Ok(times.get(times.len() / 2).copied().filter(|&ms| ms > 0.0))
    }

    /// The most that a vertex moves in a frame after three seconds of rest, as a share of its strand's length.
    pub(crate) fn jitter(mut self) -> Result<f64> {
        let still = StepInput { wind: None, ..self.case.input(0.0, 1.0 / f64::from(FPS), 1.0) };
        for _ in 0..3 * FPS {
            self.frame(&still)?;
        }
        let vertices = self.strands.vertices as usize;
        let lengths = lengths(self.strands);
        let mut before = self.positions()?;
        let mut most = 0.0_f64;
        for _ in 0..10 {
            self.frame(&still)?;
            let after = self.positions()?;
            for (i, (one, other)) in before.iter().zip(&after).enumerate() {
                most = most.max(f64::from(one.truncate().distance(other.truncate())) / lengths[i / vertices]);
            }
            before = after;
        }
        Ok(most)
    }

    /// What the energy of a strand has changed by after a second, as a share of what its fall from the horizontal sets free. Each
    /// sub-step is a frame; velocities are what vertices move by in one, over its length.
    pub(crate) fn energy(mut self, method: &Method) -> Result<f64> {
        let length = lengths(self.strands)[0];
        let (free, rate) = (9.81 * length * length / 2.0, f64::from(method.rate));
        let (mut last, mut energies) = (self.positions()?, Vec::new());
        let start = bending_energy(self.case, method, &last) + height_energy(&last);
        for frame in 1..=method.rate {
            self.go(frame, method.rate)?;
            let here = self.positions()?;
            let velocities: Vec<DVec3> =
                here.iter().zip(&last).map(|(one, other)| (one - other).truncate().as_dvec3() * rate).collect();
            let kinetic = kinetic_energy(method, &here, &velocities);
            let still = |place: &[Vec4]| bending_energy(self.case, method, place) + height_energy(place);
            energies.push(kinetic + (still(&here) + still(&last)) / 2.0);
            last = here;
        }
        // The mean of the last tenth of a second: what velocities miss within a sub-step swings.
        let end = &energies[energies.len() - (energies.len() / 10).max(1)..];
        Ok((end.iter().sum::<f64>() / end.len() as f64 - start) / free)
    }
}

/// Of each vertex half of the lengths beside it.
fn masses(strand: &[Vec4]) -> impl Iterator<Item = f64> + '_ {
    let edge = |i: usize| match (strand.get(i), strand.get(i + 1)) {
        (Some(one), Some(other)) => f64::from(one.truncate().distance(other.truncate())),
        _ => 0.0,
    };
    (0..strand.len()).map(move |i| (i.checked_sub(1).map_or(0.0, edge) + edge(i)) / 2.0)
}

/// Mass along the edges of a rod has less energy of turning than mass at their ends.
fn kinetic_energy(method: &Method, strand: &[Vec4], velocities: &[DVec3]) -> f64 {
    let at_vertices: f64 =
        masses(strand).zip(velocities).map(|(mass, velocity)| 0.5 * mass * velocity.length_squared()).sum();
    if method.family == Family::TressFx {
        return at_vertices;
    }
    let places: Vec<DVec3> = strand.iter().map(|place| place.truncate().as_dvec3()).collect();
    let rod = RodRest::new(&places, 0);
    let turning = rod.lengths.iter().zip(velocities.windows(2));
    let turning: f64 = turning.map(|(length, ends)| length / 12.0 * (ends[1] - ends[0]).length_squared()).sum();
    at_vertices - rod.mass_correction() * turning
}

fn height_energy(strand: &[Vec4]) -> f64 {
    masses(strand).zip(strand).map(|(mass, place)| mass * 9.81 * f64::from(place.y - strand[0].y)).sum()
}

/// Of the joints of a strand that is clamped along x; `tressfx` gives them none here.
fn bending_energy(case: &Case, method: &Method, strand: &[Vec4]) -> f64 {
    if method.family == Family::TressFx {
        return 0.0;
    }
    let stiffness = 9.81 * f64::from(case.params.bending_length).powi(3);
    let edges: Vec<DVec3> = strand.windows(2).map(|edge| (edge[1] - edge[0]).truncate().as_dvec3()).collect();
    let mut parent = (DVec3::X, 0.0);
    let mut energy = 0.0;
    for edge in edges {
        let (before, length) = parent;
        let strain = 2.0 * (before.angle_between(edge) / 2.0).tan();
        energy += 0.5 * stiffness / ((length + edge.length()) / 2.0) * strain * strain;
        parent = (edge, edge.length());
    }
    energy
}

/// Lengths of the guides.
fn lengths(strands: &Strands) -> Vec<f64> {
    let of = |lengths: &[f32]| lengths.iter().map(|&length| f64::from(length)).sum();
    strands.rest_lengths.chunks(strands.vertices as usize).map(of).collect()
}

/// Tips from their roots over the lengths of their strands.
pub(crate) fn tips_of(strands: &Strands, positions: &[DVec3]) -> Vec<DVec3> {
    let strand = positions.chunks(strands.vertices as usize).zip(lengths(strands));
    strand.map(|(strand, length)| (strand[strand.len() - 1] - strand[0]) / length.max(f64::MIN_POSITIVE)).collect()
}

/// Root mean square of the distances of tips.
pub(crate) fn distance(one: &Tips, other: &Tips) -> f64 {
    let pairs = one.iter().flatten().zip(other.iter().flatten());
    let count = one.iter().map(Vec::len).sum::<usize>().max(1);
    (pairs.map(|(one, other)| one.distance_squared(*other)).sum::<f64>() / count as f64).sqrt()
}
