//! GPU time of each simulation pass, beside the error of the strands, for some sub-steps and iterations.
//!
//! `cargo bench -p tressfx-benches --bench sim -- [--frames=N] [GROOM]...`, where `GROOM` is a file or `builtin:NAME...`. The head
//! is shaken and turned for `N` frames of 1/60 s. What it does by itself is small enough for a CPU; a GPU has something to do
//! with `--frames=60 builtin:long:16384:32 builtin:curly`.
//!
//! Times are from the GPU's timestamps, the median and the least; frames of all settings take turns. The tips are compared
//! with those at a sub-step of 1/960 s: that is no limit where curls are so stiff that they tremble at small sub-steps.
//!
//! The bench `passes` times the passes at the default setting with criterion; this one compares settings. With `--test` it does as
//! little as shows that it runs.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use glam::{Quat, Vec3, Vec4};
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_benches::{Failure, asset};
use tressfx_core::backend::{Backend, Run as _};
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::Pose;
use tressfx_sim::{ClockParams, HairSim, SectionDesc, SimParams, Solver, StepInput, metrics};

const FPS: f64 = 60.0;
const FRAMES: u32 = 6;
/// A GPU takes its time to raise its clocks.
const WARM_UP: Duration = Duration::from_secs(1);

/// Sub-steps a second, and iterations of both constraints in each.
type Setting = (u32, u32);

const EXACT: Setting = (960, 2);

fn main() -> Result<(), Failure> {
    // Cargo adds `--bench`.
    let (options, mut grooms): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(|arg| arg.starts_with("--"));
    let is_test = options.iter().any(|option| option == "--test");
    let frames = options.iter().find_map(|option| option.strip_prefix("--frames="));
    let frames = if is_test { 1 } else { frames.map_or(Ok(FRAMES), str::parse)? };
    let warm_up = if is_test { Duration::ZERO } else { WARM_UP };
    if is_test {
        grooms = vec![String::from("builtin:long:64:16")];
    } else if grooms.is_empty() {
        grooms = ["builtin:long:2048:32", "builtin:curly:1000"].map(String::from).to_vec();
        if let Some(assets) = std::env::var_os("TRESSFX_ASSETS") {
            let assets = std::path::PathBuf::from(assets);
            grooms.push(assets.join("tressfx41_ratboy/Ratboy_mohawk.tfx").display().to_string());
        }
    }
    let mut backend = WgpuBackend::headless()?;
    println!("{}", backend.caps().adapter);
    for groom in &grooms {
        bench(&mut backend, groom, frames, warm_up)?;
    }
    Ok(())
}

fn bench(backend: &mut WgpuBackend, groom: &str, frames: u32, time: Duration) -> Result<(), Failure> {
    let options = StrandOptions { follows: Some(0), ..StrandOptions::default() };
    let strands = Strands::new(&asset(groom)?, &options)?;
    println!("\n{groom}: {} strands of {} vertices", strands.strand_count(), strands.vertices);
    let settings = [60, 120, 240].into_iter().flat_map(|rate| [1, 2, 4].map(|iterations| (rate, iterations)));
    let mut runs = settings.map(|setting| Run::new(backend, &strands, setting)).collect::<Result<Vec<_>, _>>()?;
    warm_up(backend, &strands, time)?;
    for frame in 0..=frames {
        runs.iter_mut().try_for_each(|run| run.frame(backend, &strands, frame))?;
    }
    let mut exact = Run::new(backend, &strands, EXACT)?;
    (0..=frames).try_for_each(|frame| exact.frame(backend, &strands, frame))?;
    let exact = exact.finish(backend, &strands)?;
    for mut run in runs {
        run.report_times();
        let positions = run.finish(backend, &strands)?;
        report_errors(&strands, &positions, &exact);
    }
    Ok(())
}

fn warm_up(backend: &mut WgpuBackend, strands: &Strands, time: Duration) -> Result<(), Failure> {
    let mut run = Run::new(backend, strands, (60, 1))?;
    let start = Instant::now();
    for frame in (0..).take_while(|_| start.elapsed() < time) {
        run.frame(backend, strands, frame)?;
    }
    run.finish(backend, strands).map(drop)
}

/// The head at the end of a frame: 4 cm to each side three times a second, and turned by half a radian once a second.
fn input(strands: &Strands, frame: u32) -> StepInput<'static> {
    let swing = |hertz: f64| (std::f64::consts::TAU * hertz * f64::from(frame) / FPS).sin() as f32;
    let translation = Vec3::X * (0.04 * swing(3.0) / strands.metres_per_unit);
    let head = Pose { rotation: Quat::from_rotation_y(0.5 * swing(1.0)), translation };
    StepInput::new(if frame == 0 { 0.0 } else { 1.0 / FPS }, head)
}

struct Run {
    setting: Setting,
    sim: HairSim,
    /// Times of each pass, by its label.
    passes: BTreeMap<&'static str, Vec<f64>>,
    /// Times of whole frames.
    frames: Vec<f64>,
}

impl Run {
    fn new(backend: &mut WgpuBackend, strands: &Strands, setting: Setting) -> Result<Self, Failure> {
        let (rate, iterations) = setting;
        let params = SimParams { local_iterations: iterations, length_iterations: iterations, ..SimParams::default() };
        let mut list = PassList::new();
        let mut sim =
            HairSim::new(backend, &mut list, &[SectionDesc::new(strands, params).with_solver(Solver::TressFx)], 0)?;
        backend.run(&list)?;
        sim.set_clock_params(ClockParams { sub_step: 1.0 / f64::from(rate), ..ClockParams::default() })?;
        Ok(Self { setting, sim, passes: BTreeMap::new(), frames: Vec::new() })
    }

    /// Frame 0 takes the strands to rest and is not timed.
    fn frame(&mut self, backend: &mut WgpuBackend, strands: &Strands, frame: u32) -> Result<(), Failure> {
        let mut list = PassList::new();
        self.sim.step(&mut list, &input(strands, frame))?;
        backend.run(&list)?;
        let timings = backend.timings();
        if frame > 0 {
            self.frames.push(timings.iter().map(|timing| timing.nanoseconds).sum());
            timings.iter().for_each(|timing| self.passes.entry(timing.label).or_default().push(timing.nanoseconds));
        }
        Ok(())
    }

    fn report_times(&mut self) {
        let (rate, iterations) = self.setting;
        let (median, least) = median_and_least(&mut self.frames);
        println!("  1/{rate} s, {iterations} iterations: a frame {median:.4} ms, least {least:.4} ms");
        for (label, times) in &mut self.passes {
            let (median, least) = median_and_least(times);
            println!("    {label:24} {median:.4} ms, least {least:.4} ms");
        }
    }

    /// Frees the simulation and gives where the strands are, strand-major.
    fn finish(self, backend: &mut WgpuBackend, strands: &Strands) -> Result<Vec<Vec4>, Failure> {
        let mut list = PassList::new();
        let tickets = self.sim.read_positions(&mut list);
        backend.run(&list)?;
        let bytes = backend.read(tickets[0]).ready().ok_or("no positions")?;
        self.sim.destroy(backend);
        let number = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let vertex = |bytes: &[u8]| Vec4::from_array([0, 4, 8, 12].map(|start| number(&bytes[start..])));
        Ok(strands.deinterleave(&bytes.chunks(16).map(vertex).collect::<Vec<_>>()))
    }
}

fn report_errors(strands: &Strands, positions: &[Vec4], exact: &[Vec4]) {
    let vertices = strands.vertices as usize;
    let error = metrics::edge_error(strands, positions);
    let pairs = positions.chunks(vertices).zip(exact.chunks(vertices)).zip(strands.rest_lengths.chunks(vertices));
    let mut tips: Vec<f64> = pairs
        .map(|((strand, exact), lengths)| {
            let distance = strand[vertices - 1].truncate().distance(exact[vertices - 1].truncate());
            f64::from(distance / lengths.iter().sum::<f32>().max(f32::MIN_POSITIVE))
        })
        .collect();
    tips.sort_by(f64::total_cmp);
    let (median, most) = (100.0 * tips[tips.len() / 2], 100.0 * tips[(tips.len() - 1) * 99 / 100]);
    println!("    edges: rms {:.5} %, max {:.4} %", 100.0 * error.rms, 100.0 * error.max);
    println!("    tips: {median:.2} % (median), {most:.2} % (99%) of a strand from 1/960 s, 2 iterations");
}

/// In milliseconds.
fn median_and_least(nanoseconds: &mut [f64]) -> (f64, f64) {
    nanoseconds.sort_by(f64::total_cmp);
    let at = |index: usize| nanoseconds.get(index).map_or(f64::NAN, |time| time * 1e-6);
    (at(nanoseconds.len() / 2), at(0))
}
