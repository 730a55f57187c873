//! GPU time of what moves a body and what is made between guides, beside a copy of as many bytes in the same list.
//!
//! `cargo bench -p tressfx-benches --bench body -- [--frames=N] [--backend=wgpu|vulkan]`. Each line has the median and the least time by the GPU's timestamps, the bytes that have to be
//! read and written, and how many times as long it takes as a kernel that copies them. With `--test` it does as little as shows that it runs.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use tressfx_benches::{DEVICES, Failure, median_and_least, timed_by_name};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::{BufferDesc, ComputeDesc, Run};
use tressfx_core::body::{Influences, MeshPose, SkinnedMesh};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Shader, ShaderSource, Specialization};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_sim::body::{Binding, Skinning, TriangleRoots};
use tressfx_sim::{HairSim, Interpolation, InterpolationParams, SectionDesc, SimParams, Solver};

const FRAMES: u32 = 50;

/// A vector a thread, from one buffer to another.
const COPY: ShaderSource =
    ShaderSource { label: "bench.copy", root: ("copy", include_str!("copy.wgsl")), library: &[] };

fn main() -> Result<(), Failure> {
    let options: Vec<String> = std::env::args().skip(1).collect();
    let option = |name: &str| options.iter().find_map(|option| option.strip_prefix(name)?.strip_prefix('='));
    let is_test = options.iter().any(|option| option == "--test");
    let frames = option("--frames").map_or(Ok(if is_test { 1 } else { FRAMES }), str::parse)?;
    let backend = option("--backend").unwrap_or(DEVICES[0].0);
    let Some(mut backend) = timed_by_name(backend)? else { return Ok(()) };
    let side = if is_test { 16 } else { 320 };
    body(backend.as_mut(), side, frames)?;
    let strands = if is_test { 500 } else { 100_000 };
    for params in [
        InterpolationParams::default(),
        InterpolationParams { clump: 0.5, noise: 0.1, shorter: 0.3, ..InterpolationParams::default() },
    ] {
        interpolation(backend.as_mut(), strands, &params, frames)?;
    }
    Ok(())
}

/// A square of so many vertices a side between two joints.
fn square(side: u32) -> SkinnedMesh {
    let places = || (0..side * side).map(|i| [i % side, i / side].map(|x| x as f32 / (side - 1) as f32));
    let corners = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| y * side + x));
    let influences = |[x, _]: [f32; 2]| Influences { joints: [0, 1, 0, 0], weights: [1.0 - x, x, 0.0, 0.0] };
    SkinnedMesh {
        name: "square".into(),
        positions: places().map(|[x, y]| Vec3::new(x, 0.0, y)).collect(),
        normals: vec![Vec3::Y; (side * side) as usize],
        triangles: corners.flat_map(|i| [[i, i + side, i + 1], [i + 1, i + side, i + side + 1]]).collect(),
        joints: vec!["left".into(), "right".into()],
        influences: places().map(influences).collect(),
        ..SkinnedMesh::default()
    }
}

/// Guides of so many vertices that stand on a square, evenly.
fn guides(count: u32, vertices: u32) -> Result<Strands, Failure> {
    let at = |i: u32, step: f64| (0.5 + step * f64::from(i + 1)).fract() as f32;
    let root = |i: u32| Vec3::new(at(i, 0.754_877_666), 0.0, at(i, 0.569_840_291));
    let strand = |i: u32| (0..vertices).map(move |vertex| (root(i) + Vec3::Y * 0.01 * vertex as f32).to_array());
    let points = (0..count).flat_map(strand).collect();
    let asset = HairAsset::new("guides", AssetFormat::Builtin, points, vec![vertices; count as usize]);
    Ok(Strands::new(&asset, &StrandOptions::default())?)
}

/// Skinning: a vertex is 48 bytes that are read and 32 that are written. A root is 96 bytes that are read, 36 of its corners, and 32 that are read and written.
fn body(backend: &mut dyn Run, side: u32, frames: u32) -> Result<(), Failure> {
    let (mesh, strands) = (square(side), guides(side * side / 4, 2)?);
    let mut list = PassList::new();
    let desc = SectionDesc::new(&strands, SimParams::default()).with_own_roots().with_solver(Solver::TressFx);
    let mut sim = HairSim::new(backend, &mut list, &[desc], 0)?;
    let mut skinning = Skinning::new(backend, &mut list, &mesh, false)?;
    let binding = Binding::of_guides(&strands, &mesh, 1.0)?;
    let roots = TriangleRoots::new(backend, &mut list, &sim, 0, &binding, skinning.mesh_vertices())?;
    backend.run(&list)?;
    let (vertices, count) = (u64::from(side * side), u64::from(strands.guides));
    let work = [("hair.sim.skin", 80 * vertices), ("hair.sim.triangle_roots", (96 + 36 + 64) * count)];
    beside_copies(backend, &format!("{vertices} vertices, {count} roots"), &work, frames, |list, frame| {
        let turned = Affine3A::from_rotation_x(0.01 * frame as f32);
        skinning.pose(list, &MeshPose { joints: vec![Affine3A::IDENTITY, turned], morphs: Vec::new() })?;
        roots.record(list, &mut sim);
        Ok(())
    })
}

/// Strands of 16 vertices between 2,000 guides, of which each vertex is read once at least; 32 bytes of each strand that are read, and 32 of each vertex that are written.
fn interpolation(backend: &mut dyn Run, count: u32, params: &InterpolationParams, frames: u32) -> Result<(), Failure> {
    let strands = guides(2000, 16)?;
    let mut list = PassList::new();
    let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::TressFx);
    let sim = HairSim::new(backend, &mut list, &[desc], 0)?;
    let between = Interpolation::new(backend, &mut list, (&sim.buffers()[0], &strands), count, params)?;
    backend.run(&list)?;
    let bytes = 16 * 2000 * 16 + u64::from(count) * (32 + 32 * 16);
    let name = format!("{count} strands between guides, clump {}, noise {}", params.clump, params.noise);
    beside_copies(backend, &name, &[("hair.sim.interpolate", bytes)], frames, |list, _| {
        between.record(list, count);
        Ok(())
    })
}

/// Times passes, and for each of them a copy of half of its bytes, which are read and written.
fn beside_copies(
    backend: &mut dyn Run,
    name: &str,
    work: &[(&str, u64)],
    frames: u32,
    mut record: impl FnMut(&mut PassList, u32) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let copy = backend.create_compute(&ComputeDesc::new(Arc::new(Shader::new(&COPY, &Specialization::new())?)))?;
    let mut copies = Vec::new();
    for &(_, bytes) in work {
        let vectors = (bytes / 2).div_ceil(16);
        let mut buffer = || backend.create_buffer(&BufferDesc::storage("bench.vectors", 16 * vectors));
        let bindings = copy.bind(&[("vectors", buffer()?.into()), ("copied", buffer()?.into())])?;
        copies.push((bindings, Grid::for_threads(vectors as u32, 64)));
    }
    let mut times = vec![[Vec::new(), Vec::new()]; work.len()];
    // The first frame is not counted.
    for frame in 0..=frames {
        let mut list = PassList::new();
        record(&mut list, frame)?;
        copies.iter().for_each(|(bindings, grid)| list.compute(&copy, bindings, *grid));
        backend.run(&list)?;
        let timings = backend.timings();
        let mut copied = timings.iter().filter(|timing| timing.label == COPY.label);
        for (&(label, _), [own, beside]) in work.iter().zip(&mut times) {
            let of_label = timings.iter().filter(|timing| timing.label == label).map(|timing| timing.nanoseconds);
            let copied = copied.next().map(|timing| timing.nanoseconds);
            if frame > 0 {
                own.push(of_label.sum::<f64>());
                beside.push(copied.unwrap_or(f64::NAN));
            }
        }
    }
    println!("\n{name}");
    for ((label, bytes), [own, beside]) in work.iter().zip(&mut times) {
        let (own, beside) = (median_and_least(own), median_and_least(beside));
        let ratio = own.median / beside.median;
        println!("  {label}: {own}; {bytes} bytes, {ratio:.2} times a copy of them ({beside})");
    }
    Ok(())
}
