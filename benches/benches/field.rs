//! GPU time of each pass that makes a signed distance field, of a mesh that changes in every frame.
//!
//! `cargo bench -p tressfx-benches --bench field -- [--frames=N] [--backend=wgpu|vulkan] [MESH.obj]...`. Without a mesh it is a ring of 25,840 triangles, about as many as
//! the body of a character has. Times are from the GPU's timestamps, the median and the least. With `--test` it does as little as shows that it runs.

use std::collections::BTreeMap;
use std::f32::consts::TAU;

use glam::Vec3;
use tressfx_asset::mesh::Mesh;
use tressfx_benches::{DEVICES, Failure, median_and_least, timed_by_name};
use tressfx_core::backend::Run;
use tressfx_core::pass::PassList;
use tressfx_sim::field::{FieldDesc, Fields};

const FRAMES: u32 = 50;
const NODES: [u32; 3] = [32, 64, 128];

fn main() -> Result<(), Failure> {
    // Cargo adds `--bench`.
    let (options, meshes): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(|arg| arg.starts_with("--"));
    let option = |name: &str| options.iter().find_map(|option| option.strip_prefix(name)?.strip_prefix('='));
    let is_test = options.iter().any(|option| option == "--test");
    let frames = option("--frames").map_or(Ok(if is_test { 1 } else { FRAMES }), str::parse)?;
    let backend = option("--backend").unwrap_or(DEVICES[0].0);
    let Some(mut backend) = timed_by_name(backend)? else { return Ok(()) };
    let named = meshes.iter().map(|path| Ok((path.clone(), Mesh::read(path)?)));
    let mut meshes = named.collect::<Result<Vec<_>, Failure>>()?;
    if meshes.is_empty() {
        meshes.push((String::from("a ring"), ring()));
    }
    for (name, mesh) in &meshes {
        for nodes in if is_test { &NODES[..1] } else { &NODES } {
            bench(backend.as_mut(), name, mesh, *nodes, frames)?;
        }
    }
    Ok(())
}

/// Two triangles for each of its faces.
fn ring() -> Mesh {
    const AROUND: u32 = 136;
    const TUBE: u32 = 95;
    let angle = |index: u32, count: u32| TAU * (index % count) as f32 / count as f32;
    let vertex = |i: u32, j: u32| {
        let (u, v) = (angle(i, AROUND), angle(j, TUBE));
        let out = 0.7 + 0.25 * v.cos();
        Vec3::new(out * u.cos(), 0.25 * v.sin(), out * u.sin())
    };
    let positions: Vec<Vec3> = (0..AROUND).flat_map(|i| (0..TUBE).map(move |j| vertex(i, j))).collect();
    let index = |i: u32, j: u32| i % AROUND * TUBE + j % TUBE;
    let face = |i: u32, j: u32| {
        let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
        [a, b, c, a, c, d]
    };
    let indices: Vec<u32> = (0..AROUND).flat_map(|i| (0..TUBE).flat_map(move |j| face(i, j))).collect();
    Mesh { normals: positions.clone(), positions, indices }
}

fn bench(backend: &mut dyn Run, name: &str, mesh: &Mesh, nodes: u32, frames: u32) -> Result<(), Failure> {
    let mut list = PassList::new();
    let desc = FieldDesc::new(&mesh.positions, &mesh.indices).with_nodes(nodes);
    let mut fields = Fields::new(backend, &mut list, &[desc])?;
    backend.run(&list)?;
    let (mut passes, mut sums) = (BTreeMap::<_, Vec<f64>>::new(), Vec::new());
    // The first frame is not counted.
    for frame in 0..=frames {
        list.clear_commands();
        fields.mark_changed(0)?;
        fields.record(&mut list);
        backend.run(&list)?;
        let timings = backend.timings();
        if frame == 0 {
            continue;
        }
        let mut of_frame = BTreeMap::<_, f64>::new();
        timings.iter().for_each(|timing| *of_frame.entry(timing.label).or_default() += timing.nanoseconds);
        sums.push(of_frame.values().sum());
        of_frame.into_iter().for_each(|(label, sum)| passes.entry(label).or_default().push(sum));
    }
    println!("\n{name}: {} triangles, {nodes} nodes: {}", mesh.indices.len() / 3, median_and_least(&mut sums));
    passes.iter_mut().for_each(|(label, times)| println!("  {label}: {}", median_and_least(times)));
    fields.destroy(backend);
    Ok(())
}
