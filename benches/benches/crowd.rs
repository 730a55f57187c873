//! What a frame of many characters costs the CPU, of which few are seen and awake: writing its list, and recording it. Nothing is submitted.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use tressfx_asset::builtin::Builtin;
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_benches::Recorder;
use tressfx_core::backend::{Backend, Format, Run, TextureDesc};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{
    HairRenderer, Light, Lights, Material, RenderDesc, SectionDraw, ShadedStrands, StrandInfo, Targets, ViewDraw,
};
use tressfx_sim::{HairSim, SectionDesc, SimParams, SleepParams, Solver, StepInput};

/// Few strands: the CPU does not look at them.
const GROOM: &str = "wavy:64:16";
const SIZE: [u32; 2] = [128, 72];
/// Characters that move before the eye.
const SEEN: usize = 20;
/// All of them.
const ALL: usize = 1000;

/// A simulation for each character, and one picture.
struct Crowd {
    characters: Vec<(HairSim, ShadedStrands)>,
    material: Material,
    lights: Lights,
    renderer: HairRenderer,
    targets: Targets,
    view: View,
    /// Twice as far as hair reaches: unit of the places of characters.
    apart: f32,
    frame: u32,
}

impl Crowd {
    fn new(backend: &mut dyn Run, count: usize) -> Self {
        let asset = GROOM.parse::<Builtin>().expect("a built-in groom").asset();
        let strands = Strands::new(&asset, &StrandOptions::default()).expect("strands");
        let info = StrandInfo::new(&strands);
        let mut uploads = PassList::new();
        let mut character = |backend: &mut dyn Backend| {
            let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::TressFx);
            let mut sim = HairSim::new(backend, &mut uploads, &[desc], 0).expect("a simulation");
            sim.allow_sleep(backend, SleepParams::default()).expect("sleep");
            let section = ShadedStrands::new(backend, sim.buffers()[0], info.clone()).expect("a section");
            (sim, section)
        };
        let characters = (0..count).map(|_| character(backend)).collect();
        let points: Vec<_> = strands.rest_of_all().iter().map(|point| point.truncate()).collect();
        let view = Camera::around(&points, SIZE).view(SIZE).expect("a view");
        let mut texture = |label, format| backend.create_texture(&TextureDesc::new(label, SIZE, format));
        let targets = Targets::new(
            texture("color", Format::Rgba16F).expect("a texture"),
            texture("depth", Format::Depth32F).expect("a texture"),
        );
        let renderer = HairRenderer::new(backend, &RenderDesc::new(SIZE, Format::Rgba16F)).expect("a renderer");
        backend.run(&uploads).expect("the uploads run");
        let (material, lights) = (Material::default(), lights());
        let mut crowd =
            Self { characters, material, lights, renderer, targets, view, apart: 4.0 * info.reach.1, frame: 0 };
        crowd.settle(backend);
        crowd
    }

    /// Where a character stands: those that are seen before the eye, others in rows far behind it.
    fn place(&self, index: usize) -> Vec3 {
        match index < SEEN {
            true => Vec3::X * 1e-3 * self.apart * (self.frame % 2) as f32,
            false => self.apart * Vec3::new((index % 32) as f32 - 16.0, 0.0, 100.0 + (index / 32) as f32),
        }
    }

    /// Measurements of no motion for all; those that move wake up again.
    fn settle(&mut self, backend: &mut dyn Run) {
        let mut list = PassList::new();
        for _ in 0..=SleepParams::default().measurements {
            list.clear_commands();
            self.write(&mut list);
            for (sim, _) in &mut self.characters {
                let ticket = sim.request_motion(&mut list);
                ticket.iter().for_each(|ticket| sim.measured_motion(ticket, [0; 4]));
            }
            backend.run(&list).expect("the frame runs");
        }
    }

    /// One frame of 1/60 s; how many were simulated.
    fn write(&mut self, list: &mut PassList) -> usize {
        self.frame += 1;
        let mut awake = 0;
        for index in 0..self.characters.len() {
            let head = Pose { translation: self.place(index), ..Pose::IDENTITY };
            let report = self.characters[index].0.step(list, &StepInput::new(1.0 / 60.0, head)).expect("a step");
            awake += usize::from(!report.asleep);
        }
        let draw = |character| section_of(character, &self.material);
        let draws: Vec<_> = self.characters.iter().map(draw).collect();
        let view = ViewDraw::new(&self.view, &self.lights, self.targets);
        self.renderer.draw(list, &[view], &draws).expect("a view that can be drawn");
        awake
    }
}

fn section_of<'a>((sim, section): &'a (HairSim, ShadedStrands), material: &'a Material) -> SectionDraw<'a> {
    SectionDraw::new(section, material, sim.pose())
}

/// A sky and three lights, all of which cast shadows.
fn lights() -> Lights {
    let light = |x, y, z| Light::directional(Vec3::new(x, y, z), Vec3::ONE);
    let lights = vec![light(0.75, 0.8, 0.75), light(-0.9, 0.25, 0.6), light(-0.45, 0.65, -0.9)];
    Lights { sky: Vec3::splat(0.2), ground: Vec3::splat(0.1), lights }
}

fn write(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("write the list of a crowd");
    let mut passes = Vec::new();
    for count in [SEEN, ALL] {
        let mut crowd = Crowd::new(&mut NullBackend::default(), count);
        let mut list = PassList::new();
        assert_eq!(crowd.write(&mut list), SEEN, "all others sleep");
        assert_eq!(crowd.renderer.drawn().sections, SEEN, "all others are unseen");
        passes.push(list.labels().collect::<Vec<_>>());
        group.bench_function(format!("{SEEN} seen and awake, of {count}"), |bencher| {
            bencher.iter(|| {
                list.clear_commands();
                black_box(crowd.write(&mut list))
            });
        });
    }
    assert_eq!(passes[0], passes[1], "what the GPU does is the same");
    group.finish();
}

/// What is recorded is the same for both.
fn record(criterion: &mut Criterion) {
    let mut backend = match VulkanBackend::headless() {
        Ok(backend) => backend,
        Err(error) => return eprintln!("record the list of a crowd: skipped: {error}"),
    };
    let mut crowd = Crowd::new(&mut backend, SEEN);
    let mut list = PassList::new();
    crowd.write(&mut list);
    let mut recorder = Recorder::new(backend);
    criterion.bench_function(&format!("record the list of a crowd/{SEEN} seen and awake"), |bencher| {
        bencher.iter_custom(|runs| (0..runs).map(|_| recorder.time(&list)).sum::<Duration>());
    });
}

criterion_group!(benches, write, record);
criterion_main!(benches);
