//! What it costs the CPU to create things: a simulation and a renderer without a GPU, and what is known of a groom's light.

use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};
use tressfx_asset::builtin::Builtin;
use tressfx_core::backend::Format;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_render::{HairRenderer, RenderDesc, StrandInfo};
use tressfx_sim::{HairSim, SectionDesc, SimParams};

fn strands(groom: &str) -> Strands {
    let asset = groom.parse::<Builtin>().expect("a built-in groom").asset();
    Strands::new(&asset, &StrandOptions::default()).expect("strands")
}

fn simulation(strands: &Strands) -> HairSim {
    let (mut backend, mut list) = (NullBackend::default(), PassList::new());
    let section = SectionDesc::new(strands, SimParams::default());
    HairSim::new(&mut backend, &mut list, &[section], 0).expect("a simulation")
}

fn renderer() -> HairRenderer {
    let desc = RenderDesc::new([128, 72], Format::Rgba16F);
    HairRenderer::new(&mut NullBackend::default(), &desc).expect("a renderer")
}

/// The first of a process compiles its shaders; those that come after it find them.
fn first<T>(name: &str, make: impl FnOnce() -> T) {
    let start = Instant::now();
    drop(make());
    println!("{name}, the first: {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
}

fn create(c: &mut Criterion) {
    let few = strands("wavy:64:16");
    first("HairSim::new", || simulation(&few));
    first("HairRenderer::new", renderer);
    c.bench_function("HairSim::new", |bench| bench.iter(|| simulation(&few)));
    c.bench_function("HairRenderer::new", |bench| bench.iter(renderer));
    let many = strands("wavy:4000:32");
    c.bench_function("StrandInfo::new", |bench| bench.iter(|| StrandInfo::new(&many)));
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = create
}
criterion_main!(benches);
