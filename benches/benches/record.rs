//! What a frame costs the CPU: writing its list, and recording the list into a command buffer. Nothing is submitted.

use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use tressfx_asset::builtin::Builtin;
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_backend_wgpu::{WgpuBackend, wgpu};
use tressfx_benches::Recorder;
use tressfx_core::backend::{Format, Record, Run, TextureDesc};
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{
    HairRenderer, Lights, Material, RenderDesc, SectionDraw, ShadedStrands, StrandInfo, Targets, ViewDraw,
};
use tressfx_sim::{HairSim, SectionDesc, SimParams, StepInput, Wind};

/// Few strands: the CPU does not look at them.
const GROOM: &str = "wavy:64:16";
const GROOMS: [u32; 3] = [1, 10, 100];
const SIZE: [u32; 2] = [128, 72];

/// So many grooms, in one simulation and one picture.
struct Frames {
    sim: HairSim,
    renderer: HairRenderer,
    sections: Vec<ShadedStrands>,
    targets: Targets,
    view: View,
    material: Material,
    lights: Lights,
}

impl Frames {
    fn new(backend: &mut dyn Run, grooms: u32) -> Self {
        let asset = GROOM.parse::<Builtin>().expect("a built-in groom").asset();
        let strands = Strands::new(&asset, &StrandOptions::default()).expect("strands");
        let desc = || SectionDesc::new(&strands, SimParams::default());
        let sections: Vec<_> = (0..grooms).map(|_| desc()).collect();
        let mut uploads = PassList::new();
        let sim = HairSim::new(backend, &mut uploads, &sections, 0).expect("a simulation");
        let points: Vec<_> = strands.rest_of_all().iter().map(|point| point.truncate()).collect();
        let view = Camera::around(&points, SIZE).view(SIZE).expect("a view");
        let info = StrandInfo::new(&strands);
        let section = |&buffers| ShadedStrands::new(backend, buffers, info.clone()).expect("a section");
        let sections = sim.buffers().iter().map(section).collect();
        let mut texture = |label, format| backend.create_texture(&TextureDesc::new(label, SIZE, format));
        let targets = Targets::new(
            texture("color", Format::Rgba16F).expect("a texture"),
            texture("depth", Format::Depth32F).expect("a texture"),
        );
        let renderer = HairRenderer::new(backend, &RenderDesc::new(SIZE, Format::Rgba16F)).expect("a renderer");
        backend.run(&uploads).expect("the uploads run");
        Self { sim, renderer, sections, targets, view, material: Material::default(), lights: Lights::default() }
    }

    /// One frame of 1/60 s: two sub-steps, with wind.
    fn write(&mut self, list: &mut PassList) {
        list.clear_commands();
        let wind = Wind::new(glam::Vec3::new(2.0, 0.0, 1.0));
        self.sim.step(list, &StepInput::new(1.0 / 60.0, Pose::IDENTITY).with_wind(wind)).expect("a step");
        let (material, pose) = (&self.material, self.sim.pose());
        let draw = |section| SectionDraw::new(section, material, pose);
        let draws: Vec<_> = self.sections.iter().map(draw).collect();
        let view = ViewDraw::new(&self.view, &self.lights, self.targets);
        self.renderer.draw(list, &[view], &draws).expect("a view that can be drawn");
    }

    /// A frame in a row of frames.
    fn steady(&mut self, backend: &mut dyn Run) -> PassList {
        let mut list = PassList::new();
        for _ in 0..2 {
            self.write(&mut list);
            backend.run(&list).expect("the frame runs");
        }
        self.write(&mut list);
        list
    }
}

fn write(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("write the list");
    for grooms in GROOMS {
        let mut backend = VulkanBackend::headless().expect("Vulkan");
        let mut frames = Frames::new(&mut backend, grooms);
        let mut list = frames.steady(&mut backend);
        group.bench_function(BenchmarkId::from_parameter(grooms), |bencher| bencher.iter(|| frames.write(&mut list)));
    }
}

fn vulkan(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("record on Vulkan");
    for grooms in GROOMS {
        let mut backend = VulkanBackend::headless().expect("Vulkan");
        let list = Frames::new(&mut backend, grooms).steady(&mut backend);
        let mut recorder = Recorder::new(backend);
        group.bench_function(BenchmarkId::from_parameter(grooms), |bencher| {
            bencher.iter_custom(|runs| (0..runs).map(|_| recorder.time(&list)).sum::<Duration>());
        });
    }
}

fn wgpu(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("record on wgpu");
    for grooms in GROOMS {
        let mut backend = WgpuBackend::headless().expect("an adapter");
        let list = Frames::new(&mut backend, grooms).steady(&mut backend);
        let device = backend.device().clone();
        let mut record = || {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let start = Instant::now();
            backend.record(&mut encoder, &list).expect("a recording");
            // wgpu does most of its work here.
            let commands = encoder.finish();
            let time = start.elapsed();
            drop(commands);
            device.poll(wgpu::PollType::Poll).expect("a poll");
            time
        };
        group.bench_function(BenchmarkId::from_parameter(grooms), |bencher| {
            bencher.iter_custom(|runs| (0..runs).map(|_| record()).sum::<Duration>());
        });
    }
}

criterion_group!(benches, write, vulkan, wgpu);
criterion_main!(benches);
