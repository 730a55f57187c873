//! GPU time of each pass, simulation and every technique of rendering, on both backends.
//!
//! `cargo bench -p tressfx-benches --bench passes -- [FILTER]`. A benchmark is `sim/GROOM/BACKEND/PASS` or
//! `render/TECHNIQUE/GROOM/BACKEND/PASS`, where `all` are the passes of a frame together. A pass that a frame has several of counts as
//! their sum. `TRESSFX_GROOMS="GROOM[,FOLLOWS] ..."` takes other grooms: files, `builtin:NAME...` or `sphere:STRANDS`.
//!
//! Pictures are of 1920x1080 pixels. A device that computes on the CPU gets a small groom and 320x180 pixels.

use std::time::Duration;

use criterion::Criterion;
use glam::{Quat, Vec3};
use tressfx_benches::{DEVICES, Failure, GpuClock, strands, timed};
use tressfx_core::backend::{Format, Run, TextureDesc, Timing};
use tressfx_core::error::Label;
use tressfx_core::pass::{Load, PassList, RasterPass};
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::Strands;
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{
    Counters, Fill, HairRenderer, Light, Lights, Material, PpllDesc, RenderDesc, SectionDraw, ShadedStrands,
    ShortCutDesc, StrandInfo, Targets, Technique, TilesDesc, ViewDraw,
};
use tressfx_sim::{HairSim, SectionDesc, SimParams, Solver, StepInput};

/// Frames in which pools grow to what was measured.
const FRAMES_OF_GROWTH: usize = 4;

fn main() -> Result<(), Failure> {
    let clock = GpuClock::default();
    let criterion = Criterion::default().with_measurement(clock.clone()).sample_size(20);
    let times = (Duration::from_millis(500), Duration::from_secs(2));
    let mut criterion = criterion.warm_up_time(times.0).measurement_time(times.1).configure_from_args();
    for (name, open) in DEVICES {
        match timed(name, open()) {
            Ok(mut backend) => device(&mut criterion, &clock, name, &mut *backend)?,
            Err(why) => eprintln!("{why}"),
        }
    }
    criterion.final_summary();
    Ok(())
}

fn device(
    criterion: &mut Criterion<GpuClock>,
    clock: &GpuClock,
    name: &str,
    backend: &mut dyn Run,
) -> Result<(), Failure> {
    let is_cpu = backend.caps().is_cpu;
    println!("{name}: {}", backend.caps().adapter);
    let size = if is_cpu { [320, 180] } else { [1920, 1080] };
    for groom in grooms(is_cpu) {
        let strands = strands(&groom)?;
        let short = groom.rsplit('/').next().unwrap_or(&groom).trim_start_matches("builtin:");
        for (solver, label) in [(Solver::Direct, "direct"), (Solver::TressFx, "tressfx")] {
            let mut sim = Sim::new(backend, &strands, solver)?;
            bench(criterion, clock, &format!("sim/{label}/{short}/{name}"), &mut || sim.frame(backend))?;
            sim.sim.destroy(backend);
        }
        let mut hair = Hair::new(backend, &strands, size)?;
        for (technique, desc) in techniques() {
            let group = format!("render/{technique}/{short}/{name}");
            match hair.renderer(backend, desc) {
                Ok(mut renderer) => {
                    bench(criterion, clock, &group, &mut || hair.frame(backend, &mut renderer))?;
                    renderer.destroy(backend);
                }
                Err(error) => eprintln!("{group}: skipped: {error}"),
            }
        }
        hair.destroy(backend);
    }
    Ok(())
}

fn grooms(is_cpu: bool) -> Vec<String> {
    if let Ok(grooms) = std::env::var("TRESSFX_GROOMS") {
        return grooms.split_whitespace().map(String::from).collect();
    }
    if is_cpu {
        return vec![String::from("builtin:wavy:300:16")];
    }
    let mut grooms = ["sphere:16384", "builtin:long:16384:32"].map(String::from).to_vec();
    if let Some(assets) = std::env::var_os("TRESSFX_ASSETS") {
        // AMD's sample draws three strands for each of the file.
        let mohawk = std::path::PathBuf::from(assets).join("tressfx41_ratboy/Ratboy_mohawk.tfx");
        grooms.push(format!("{},2", mohawk.display()));
    }
    grooms
}

fn techniques() -> [(&'static str, Technique); 7] {
    let (lists, mean) = (PpllDesc::default(), ShortCutDesc::default());
    [
        ("lists", lists.into()),
        ("lists-raster", lists.fill(Fill::Raster).into()),
        ("shortcut", mean.into()),
        ("shortcut-raster", mean.fill(Fill::Raster).into()),
        ("shortcut-ordered", mean.ordered(true).into()),
        ("shortcut-ordered-raster", mean.ordered(true).fill(Fill::Raster).into()),
        ("tiles", TilesDesc::default().into()),
    ]
}

/// Times each pass of a frame, and all of them together.
fn bench(
    criterion: &mut Criterion<GpuClock>,
    clock: &GpuClock,
    group: &str,
    frame: &mut dyn FnMut() -> Result<Vec<Timing>, Failure>,
) -> Result<(), Failure> {
    let mut labels: Vec<Label> = Vec::new();
    for timing in frame()? {
        if !labels.contains(&timing.label) {
            labels.push(timing.label);
        }
    }
    for label in labels.iter().copied().map(Some).chain([None]) {
        let pass = label.map_or("all", |label| label.rsplit('.').next().unwrap_or(label));
        criterion.bench_function(&format!("{group}/{pass}"), |bencher| {
            bencher.iter(|| clock.advance(&frame().expect("the first frame ran"), label));
        });
    }
    Ok(())
}

/// Runs a frame and gives the times of the passes of hair.
fn run(backend: &mut dyn Run, list: &PassList) -> Result<Vec<Timing>, Failure> {
    backend.run(list)?;
    let mut timings = backend.timings();
    timings.retain(|timing| timing.label.starts_with("hair."));
    Ok(timings)
}

/// A groom on a head that is shaken and turned.
struct Sim {
    sim: HairSim,
    metres_per_unit: f32,
    frames: u32,
}

impl Sim {
    fn new(backend: &mut dyn Run, strands: &Strands, solver: Solver) -> Result<Self, Failure> {
        let mut list = PassList::new();
        let desc = SectionDesc::new(strands, SimParams::default()).with_solver(solver);
        let sim = HairSim::new(backend, &mut list, &[desc], 0)?;
        backend.run(&list)?;
        let mut made = Self { sim, metres_per_unit: strands.metres_per_unit, frames: 0 };
        // The first takes the strands to where they begin.
        made.frame(backend)?;
        Ok(made)
    }

    /// A sixtieth of a second: 4 cm to each side three times a second, half a radian once a second.
    fn frame(&mut self, backend: &mut dyn Run) -> Result<Vec<Timing>, Failure> {
        let swing = |hertz: f32| (std::f32::consts::TAU * hertz * (self.frames % 60) as f32 / 60.0).sin();
        let translation = Vec3::X * (0.04 * swing(3.0) / self.metres_per_unit);
        let head = Pose { rotation: Quat::from_rotation_y(0.5 * swing(1.0)), translation };
        let seconds = if self.frames == 0 { 0.0 } else { 1.0 / 60.0 };
        self.frames += 1;
        let mut list = PassList::new();
        self.sim.step(&mut list, &StepInput::new(seconds, head))?;
        run(backend, &list)
    }
}

/// A groom in its rest pose, and what it is drawn into.
struct Hair {
    view: View,
    lights: Lights,
    targets: Targets,
    buffers: StrandBuffers,
    section: ShadedStrands,
    size: [u32; 2],
}

impl Hair {
    fn new(backend: &mut dyn Run, strands: &Strands, size: [u32; 2]) -> Result<Self, Failure> {
        let points: Vec<Vec3> = strands.rest_of_all().iter().map(|point| point.truncate()).collect();
        let view = Camera::around(&points, size).view(size)?;
        let mut texture = |label, format| backend.create_texture(&TextureDesc::new(label, size, format));
        let targets = Targets::new(texture("color", Format::Rgba16F)?, texture("depth", Format::Depth32F)?);
        let mut uploads = PassList::new();
        let buffers = StrandBuffers::new(backend, StrandShape::of(strands), Vec3::ZERO)?;
        buffers.upload(&mut uploads, strands);
        let section = ShadedStrands::new(backend, buffers, StrandInfo::new(strands))?;
        backend.run(&uploads)?;
        Ok(Self { view, lights: lights(), targets, buffers, section, size })
    }

    /// A renderer that has room for all of it.
    fn renderer(&self, backend: &mut dyn Run, technique: Technique) -> Result<HairRenderer, Failure> {
        let desc = RenderDesc::new(self.size, Format::Rgba16F).technique(technique);
        let mut renderer = HairRenderer::new(backend, &desc)?;
        let material = Material::default();
        let draw = SectionDraw::new(&self.section, &material, Pose::IDENTITY);
        renderer.grow_to_predicted(backend, &self.view, &[draw])?;
        for _ in 0..FRAMES_OF_GROWTH {
            let mut list = self.list(&mut renderer)?;
            let ticket = renderer.request_counters(&mut list, 0);
            backend.run(&list)?;
            let counters = Counters::from_bytes(&backend.read(ticket).ready().ok_or("no counters")?);
            renderer.grow_to_measured(backend, &counters)?;
        }
        Ok(renderer)
    }

    fn list(&self, renderer: &mut HairRenderer) -> Result<PassList, Failure> {
        let mut list = PassList::new();
        let clear = RasterPass::new("clear").color(self.targets.color, Load::Clear([0.0; 4]));
        list.raster(clear.depth(self.targets.depth, Load::Clear(self.view.depth().far())));
        let material = Material::default();
        let view = ViewDraw::new(&self.view, &self.lights, self.targets);
        renderer.draw(&mut list, &[view], &[SectionDraw::new(&self.section, &material, Pose::IDENTITY)])?;
        Ok(list)
    }

    fn frame(&mut self, backend: &mut dyn Run, renderer: &mut HairRenderer) -> Result<Vec<Timing>, Failure> {
        run(backend, &self.list(renderer)?)
    }

    fn destroy(self, backend: &mut dyn Run) {
        self.section.destroy(backend);
        self.buffers.destroy(backend);
        [self.targets.color, self.targets.depth].into_iter().for_each(|texture| backend.destroy(texture.into()));
    }
}

/// Light from above on the right, as in a studio.
fn lights() -> Lights {
    Lights {
        sky: Vec3::new(0.22, 0.24, 0.28),
        ground: Vec3::new(0.09, 0.08, 0.07),
        lights: vec![
            Light::directional(Vec3::new(0.75, 0.8, 0.75), Vec3::new(2.3, 2.1, 1.85)),
            Light::directional(Vec3::new(-0.9, 0.25, 0.6), Vec3::new(0.35, 0.42, 0.55)),
            Light::directional(Vec3::new(-0.45, 0.65, -0.9), Vec3::new(1.1, 1.2, 1.4)),
        ],
    }
}
