//! GPU time of each simulation pass of a sixtieth of a second, beside the error of the strands: both solvers, some sub-steps, with
//! and without bodies.
//!
//! `cargo bench -p tressfx-benches --bench sim -- [--frames=N] [--backend=wgpu|vulkan] [GROOM]...`, where `GROOM` is a file,
//! `builtin:NAME...` or `sphere:STRANDS`. The head is shaken and turned for `N` frames of 1/60 s. What it does by itself is small enough
//! for a CPU; a GPU has something to do with `--frames=60 sphere:16384 sphere:131072`.
//!
//! Times are from the GPU's timestamps, the median and the least; frames of all settings take turns. The tips are compared
//! with those of the same bodies and [`Solver::Direct`] at a sub-step of 1/960 s.
//!
//! The bench `passes` times the passes at the default setting with criterion; this one compares settings. With `--test` it does as
//! little as shows that it runs.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use glam::{Quat, Vec3, Vec4};
use tressfx_benches::{DEVICES, Failure, asset, timed_by_name};
use tressfx_core::backend::Run as Device;
use tressfx_core::pass::PassList;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::Pose;
use tressfx_sim::{ClockParams, Collider, HairSim, SectionDesc, SimParams, Solver, StepInput, metrics};

const FPS: f64 = 60.0;
const FRAMES: u32 = 6;
/// A GPU takes its time to raise its clocks.
const WARM_UP: Duration = Duration::from_secs(1);
/// Bodies of those settings that have any.
const BODIES: usize = 6;

/// What is compared.
#[derive(Clone, Copy, PartialEq)]
struct Setting {
    solver: Solver,
    /// Sub-steps a second.
    rate: u32,
    bodies: bool,
}

const EXACT: u32 = 960;
const SOLVERS: [(Solver, u32); 5] =
    [(Solver::TressFx, 60), (Solver::TressFx, 120), (Solver::Direct, 60), (Solver::Direct, 120), (Solver::Direct, 240)];

/// What the command line asks for.
struct Args {
    frames: u32,
    warm_up: Duration,
    backend: String,
    grooms: Vec<String>,
}

impl Args {
    fn parse() -> Result<Self, Failure> {
        // Cargo adds `--bench`.
        let (options, grooms): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(|arg| arg.starts_with("--"));
        let option = |name: &str| options.iter().find_map(|option| option.strip_prefix(name)?.strip_prefix('='));
        let backend = option("--backend").unwrap_or(DEVICES[0].0).to_owned();
        if options.iter().any(|option| option == "--test") {
            return Ok(Self { frames: 1, warm_up: Duration::ZERO, backend, grooms: vec!["builtin:long:64:16".into()] });
        }
        let frames = option("--frames").map_or(Ok(FRAMES), str::parse)?;
        let grooms = if grooms.is_empty() { usual_grooms() } else { grooms };
        Ok(Self { frames, warm_up: WARM_UP, backend, grooms })
    }
}

fn usual_grooms() -> Vec<String> {
    let mut grooms = ["builtin:long:2048:32", "builtin:curly:1000"].map(String::from).to_vec();
    if let Some(assets) = std::env::var_os("TRESSFX_ASSETS") {
        let assets = std::path::PathBuf::from(assets);
        grooms.push(assets.join("tressfx41_ratboy/Ratboy_mohawk.tfx").display().to_string());
    }
    grooms
}

fn main() -> Result<(), Failure> {
    let args = Args::parse()?;
    let Some(mut backend) = timed_by_name(&args.backend)? else { return Ok(()) };
    for groom in &args.grooms {
        bench(backend.as_mut(), groom, args.frames, args.warm_up)?;
    }
    Ok(())
}

fn bench(backend: &mut dyn Device, groom: &str, frames: u32, time: Duration) -> Result<(), Failure> {
    let options = StrandOptions { follows: Some(0), ..StrandOptions::default() };
    let strands = Strands::new(&asset(groom)?, &options)?;
    println!("\n{groom}: {} strands of {} vertices", strands.strand_count(), strands.vertices);
    let bodies = bodies(&strands);
    let settings =
        [false, true].into_iter().flat_map(|bodies| SOLVERS.map(|(solver, rate)| Setting { solver, rate, bodies }));
    let mut runs = settings.map(|setting| Run::new(backend, &strands, setting)).collect::<Result<Vec<_>, _>>()?;
    warm_up(backend, &strands, &bodies, time)?;
    for frame in 0..=frames {
        runs.iter_mut().try_for_each(|run| run.frame(backend, &strands, &bodies, frame))?;
    }
    let mut exact = Vec::new();
    for has_bodies in [false, true] {
        let mut run = Run::new(backend, &strands, Setting { solver: Solver::Direct, rate: EXACT, bodies: has_bodies })?;
        (0..=frames).try_for_each(|frame| run.frame(backend, &strands, &bodies, frame))?;
        exact.push(run.finish(backend, &strands)?);
    }
    let head = input(&strands, frames).head;
    println!(
        "  of {:.1} % of the strands some vertex is at a body",
        100.0 * touching(&strands, &exact[1], &head, &bodies)
    );
    for mut run in runs {
        run.report_times();
        let exact = &exact[usize::from(run.setting.bodies)];
        let positions = run.finish(backend, &strands)?;
        report_errors(&strands, &positions, exact);
    }
    Ok(())
}

/// Upright capsules in a ring around the lower half of a groom, inside its outline.
fn bodies(strands: &Strands) -> Vec<Capsule> {
    let points = || strands.rest.iter().map(|point| point.truncate());
    let (low, high) =
        points().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    let (center, half) = (0.5 * (low + high), 0.5 * (high - low));
    let radius = 0.06 * half.max_element();
    let capsule = |index: usize| {
        let (sin, cos) = (std::f32::consts::TAU * index as f32 / BODIES as f32).sin_cos();
        let foot = center + half * Vec3::new(0.85 * cos, -0.6, 0.85 * sin);
        Capsule { a: foot, b: foot + 0.3 * half.y * Vec3::Y, radius_a: radius, radius_b: radius }
    };
    (0..BODIES).map(capsule).collect()
}

/// The share of the strands of which a vertex is nearer to a body than a tenth of its radius.
fn touching(strands: &Strands, positions: &[Vec4], head: &Pose, bodies: &[Capsule]) -> f64 {
    let back = head.rotation.inverse();
    let is_near = |point: &Vec4| {
        let point = back * (point.truncate() - head.translation);
        bodies.iter().any(|body| body.distance(point) < 0.1 * body.radius_a)
    };
    let strands = positions.chunks(strands.vertices as usize);
    let count = strands.len();
    strands.filter(|strand| strand.iter().any(is_near)).count() as f64 / count as f64
}

fn warm_up(backend: &mut dyn Device, strands: &Strands, bodies: &[Capsule], time: Duration) -> Result<(), Failure> {
    let mut run = Run::new(backend, strands, Setting { solver: Solver::TressFx, rate: 60, bodies: false })?;
    let start = Instant::now();
    for frame in (0..).take_while(|_| start.elapsed() < time) {
        run.frame(backend, strands, bodies, frame)?;
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
    fn new(backend: &mut dyn Device, strands: &Strands, setting: Setting) -> Result<Self, Failure> {
        let mut list = PassList::new();
        let section = SectionDesc::new(strands, SimParams::default()).with_solver(setting.solver);
        let mut sim = HairSim::new(backend, &mut list, &[section], if setting.bodies { BODIES } else { 0 })?;
        backend.run(&list)?;
        sim.set_clock_params(ClockParams { sub_step: 1.0 / f64::from(setting.rate), ..ClockParams::default() })?;
        Ok(Self { setting, sim, passes: BTreeMap::new(), frames: Vec::new() })
    }

    /// Frame 0 takes the strands to rest and is not timed.
    fn frame(
        &mut self,
        backend: &mut dyn Device,
        strands: &Strands,
        bodies: &[Capsule],
        frame: u32,
    ) -> Result<(), Failure> {
        let mut list = PassList::new();
        let colliders = if self.setting.bodies { Collider::all_with_head(bodies) } else { Vec::new() };
        self.sim.step(&mut list, &input(strands, frame).with_colliders(&colliders))?;
        backend.run(&list)?;
        let mut timings = backend.timings();
        timings.retain(|timing| timing.label.starts_with("hair."));
        if frame > 0 {
            self.frames.push(timings.iter().map(|timing| timing.nanoseconds).sum());
            // Of all sub-steps of a frame together.
            let mut sums = BTreeMap::<_, f64>::new();
            timings.iter().for_each(|timing| *sums.entry(timing.label).or_default() += timing.nanoseconds);
            sums.into_iter().for_each(|(label, sum)| self.passes.entry(label).or_default().push(sum));
        }
        Ok(())
    }

    fn report_times(&mut self) {
        let Setting { solver, rate, bodies } = self.setting;
        let (median, least) = median_and_least(&mut self.frames);
        let bodies = if bodies { format!(", {BODIES} bodies") } else { String::new() };
        println!("  {solver:?}, 1/{rate} s{bodies}: a frame {median:.4} ms, least {least:.4} ms");
        for (label, times) in &mut self.passes {
            let (median, least) = median_and_least(times);
            println!("    {label:24} {median:.4} ms, least {least:.4} ms");
        }
    }

    /// Frees the simulation and gives where the strands are, strand-major.
    fn finish(self, backend: &mut dyn Device, strands: &Strands) -> Result<Vec<Vec4>, Failure> {
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
    println!("    tips: {median:.2} % (median), {most:.2} % (99%) of a strand from rods at 1/960 s");
}

/// In milliseconds.
fn median_and_least(nanoseconds: &mut [f64]) -> (f64, f64) {
    nanoseconds.sort_by(f64::total_cmp);
    let at = |index: usize| nanoseconds.get(index).map_or(f64::NAN, |time| time * 1e-6);
    (at(nanoseconds.len() / 2), at(0))
}
