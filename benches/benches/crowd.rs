//! What a frame of many characters costs the CPU, of which few are seen and awake: writing its list. Nothing is run, so no GPU is asked for.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use tressfx_asset::builtin::Builtin;
use tressfx_core::backend::{Backend, Format, TextureDesc};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{
    HairRenderer, Lights, Material, RenderDesc, SectionDraw, ShadedStrands, StrandInfo, Targets, ViewDraw,
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
    renderer: HairRenderer,
    targets: Targets,
    view: View,
    /// Twice as far as hair reaches: unit of the places of characters.
    apart: f32,
    frame: u32,
}

impl Crowd {
    fn new(count: usize) -> Self {
        let mut backend = NullBackend::default();
        let asset = GROOM.parse::<Builtin>().expect("a built-in groom").asset();
        let strands = Strands::new(&asset, &StrandOptions::default()).expect("strands");
        let info = StrandInfo::new(&strands);
        let character = |backend: &mut NullBackend| {
            let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::TressFx);
            let mut sim = HairSim::new(backend, &mut PassList::new(), &[desc], 0).expect("a simulation");
            sim.allow_sleep(backend, SleepParams::default()).expect("sleep");
            let section = ShadedStrands::new(backend, sim.buffers()[0], info.clone()).expect("a section");
            (sim, section)
        };
        let characters = (0..count).map(|_| character(&mut backend)).collect();
        let points: Vec<_> = strands.rest_of_all().iter().map(|point| point.truncate()).collect();
        let view = Camera::around(&points, SIZE).view(SIZE).expect("a view");
        let mut texture = |label, format| backend.create_texture(&TextureDesc::new(label, SIZE, format));
        let targets = Targets::new(
            texture("color", Format::Rgba16F).expect("a texture"),
            texture("depth", Format::Depth32F).expect("a texture"),
        );
        let renderer = HairRenderer::new(&mut backend, &RenderDesc::new(SIZE, Format::Rgba16F)).expect("a renderer");
        let mut crowd = Self { characters, renderer, targets, view, apart: 4.0 * info.reach.1, frame: 0 };
        crowd.settle();
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
    fn settle(&mut self) {
        let mut list = PassList::new();
        for _ in 0..=SleepParams::default().measurements {
            list.clear_commands();
            self.write(&mut list);
            for (sim, _) in &mut self.characters {
                let ticket = sim.request_motion(&mut list);
                ticket.iter().for_each(|ticket| sim.measured_motion(ticket, [0; 4]));
            }
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
        let (material, lights) = (Material::default(), Lights::default());
        let draws: Vec<_> =
            self.characters.iter().map(|(sim, section)| SectionDraw::new(section, &material, sim.pose())).collect();
        let view = ViewDraw::new(&self.view, &lights, self.targets);
        self.renderer.draw(list, &[view], &draws).expect("a view that can be drawn");
        awake
    }
}

fn crowd(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("write the list of a crowd");
    let mut passes = Vec::new();
    for count in [SEEN, ALL] {
        let mut crowd = Crowd::new(count);
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

criterion_group!(benches, crowd);
criterion_main!(benches);
