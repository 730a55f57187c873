//! Strands between guides: the kernel against f64 and on both backends, and what interpolation has to keep: affine motion, lengths, density, partings.

mod support;

use glam::{DVec3, Quat, Vec2, Vec3};
use support::gpu;
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::sim::{Random, builtin, strands_of};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::{Backend, Run};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::reference;
use tressfx_sim::{HairSim, Interpolation, InterpolationParams, SectionDesc, SimError, SimParams, Solver, StepInput};

/// What the kernel may lose, of the length of a strand.
const TOLERANCE: f64 = 1e-5;

/// Guides whose first strand is at the origin, of points that a function gives for a root.
fn guides(roots: &[Vec2], strand: impl Fn(Vec2) -> Vec<Vec3>) -> Strands {
    let strands: Vec<Vec<Vec3>> = roots.iter().map(|&root| strand(root)).collect();
    let counts = strands.iter().map(|strand| strand.len() as u32).collect();
    let points = strands.into_iter().flatten().map(|point| point.to_array()).collect();
    strands_of(HairAsset::new("guides", AssetFormat::Builtin, points, counts), 0)
}

/// Places of the unit square, evenly spread and not on a grid.
fn square(count: usize) -> Vec<Vec2> {
    let at = |i: usize, step: f64| (0.5 + step * i as f64).fract() as f32;
    (1..=count).map(|i| Vec2::new(at(i, 0.754_877_666_246_692_7), at(i, 0.569_840_290_998_053_2))).collect()
}

/// Strands between guides at rest, on a backend that runs nothing: what is scattered, and the reference.
fn scattered(strands: &Strands, count: u32, params: &InterpolationParams) -> Interpolation {
    let mut backend = NullBackend::default();
    let buffers = StrandBuffers::new(&mut backend, StrandShape::of(strands), Vec3::ZERO).unwrap();
    Interpolation::new(&mut backend, &mut PassList::new(), (&buffers, strands), count, params).unwrap()
}

/// The vertices of a strand of f64 positions.
fn strand(positions: &[DVec3], vertices: u32, index: u32) -> &[DVec3] {
    &positions[(index * vertices) as usize..][..vertices as usize]
}

/// Strands between guides of a simulation that has moved them, as the GPU makes them, tangents too, and as f64 does; strand-major.
fn made(
    mut backend: Box<dyn Run>,
    strands: &Strands,
    count: u32,
    params: &InterpolationParams,
) -> ([Vec<[f32; 4]>; 2], Vec<Vec<DVec3>>) {
    let mut list = PassList::new();
    let desc = SectionDesc::new(strands, SimParams::default()).with_solver(Solver::TressFx);
    let mut sim = HairSim::new(&mut *backend, &mut list, &[desc], 0).unwrap();
    for frame in 0..10 {
        let head = Pose { rotation: Quat::from_rotation_z(0.05 * frame as f32), ..Pose::IDENTITY };
        sim.step(&mut list, &StepInput::new(1.0 / 60.0, head)).unwrap();
    }
    let between = Interpolation::new(&mut *backend, &mut list, (&sim.buffers()[0], strands), count, params).unwrap();
    between.record(&mut list, count);
    let of_guides = sim.read_positions(&mut list)[0];
    let buffers = *between.buffers();
    let bytes = 16 * u64::from(buffers.shape.strand_vertices());
    let tickets = [buffers.positions, buffers.tangents].map(|buffer| list.read_buffer(buffer, 0, bytes));
    backend.run(&list).unwrap();
    let mut read = |ticket| -> Vec<[f32; 4]> { bytemuck::pod_collect_to_vec(&backend.read(ticket).ready().unwrap()) };
    let shape = buffers.shape;
    let major = |values: Vec<[f32; 4]>| {
        let places = (0..shape.guides).flat_map(|strand| (0..shape.vertices).map(move |vertex| (strand, vertex)));
        places.map(|(strand, vertex)| values[shape.index(strand, vertex) as usize]).collect()
    };
    let on_gpu = tickets.map(|ticket| major(read(ticket)));
    let guides: Vec<DVec3> = strands
        .deinterleave(&read(of_guides))
        .iter()
        .map(|position| Vec3::from_slice(&position[..3]).as_dvec3())
        .collect();
    let reference = between.between().iter().enumerate().map(|(index, of)| {
        let trio = of.guides.to_array().map(|guide| strand(&guides, strands.vertices, guide));
        reference::interpolate(between.uniform(), of, index as u32, trio)
    });
    let reference = reference.collect();
    between.destroy(&mut *backend);
    sim.destroy(&mut *backend);
    (on_gpu, reference)
}

#[test]
fn the_kernel_does_what_the_reference_does_on_both_backends() {
    let strands = builtin("wavy", 400);
    let plain = InterpolationParams::default();
    let all = InterpolationParams { clump: 0.7, clump_falloff: 1.5, noise: 0.08, shorter: 0.4, ..plain.clone() };
    let fewer = InterpolationParams { vertices: Some(2), ..plain.clone() };
    let more = InterpolationParams { vertices: Some(3 * strands.vertices - 1), ..plain.clone() };
    let fur = InterpolationParams { nearest: true, noise: 0.3, noise_waves: 9.5, seed: 3, ..plain.clone() };
    let clumps = InterpolationParams { clump: 1.0, ..plain.clone() };
    for params in [plain, all, fewer, more, fur, clumps] {
        let Some(backend) = gpu() else { return };
        let (on_gpu, reference) = made(backend, &strands, 3001, &params);
        let options = VulkanOptions { validation: true, ..VulkanOptions::default() };
        let vulkan = VulkanBackend::headless_with(&options).unwrap();
        // On GPUs two compilers may round in two ways.
        let is_exact = vulkan.caps().is_cpu;
        let (other, _) = made(Box::new(vulkan), &strands, 3001, &params);
        assert!(!is_exact || on_gpu == other, "both backends: {params:?}");
        let [positions, tangents] = on_gpu;
        let vertices = reference[0].len();
        let (mut worst, mut worst_tangent) = (0.0f64, 0.0f64);
        for (index, strand) in reference.iter().enumerate() {
            let length: f64 = strand.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
            let directions = reference::tangents(strand);
            for (vertex, (&point, &tangent)) in strand.iter().zip(&directions).enumerate() {
                let place = index * vertices + vertex;
                let of = |values: &[[f32; 4]]| Vec3::from_slice(&values[place][..3]).as_dvec3();
                worst = worst.max(of(&positions).distance(point) / length);
                worst_tangent = worst_tangent.max(of(&tangents).distance(tangent));
            }
        }
        println!("{params:?}: {worst:.1e} of the length, tangents {worst_tangent:.1e}");
        assert!(worst < TOLERANCE && worst_tangent < 1e-3, "{worst:e}, {worst_tangent:e}: {params:?}");
    }
}

#[test]
fn strands_that_no_one_draws_are_not_made() {
    let Some(mut backend) = gpu() else { return };
    let strands = builtin("fur", 100);
    let mut list = PassList::new();
    let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::TressFx);
    let mut sim = HairSim::new(&mut *backend, &mut list, &[desc], 0).unwrap();
    sim.step(&mut list, &StepInput::new(0.0, Pose::IDENTITY)).unwrap();
    let params = InterpolationParams::default();
    let between = Interpolation::new(&mut *backend, &mut list, (&sim.buffers()[0], &strands), 1000, &params).unwrap();
    let empty = list.passes().count();
    between.record(&mut list, 0);
    assert_eq!(list.passes().count(), empty, "no strand, no pass");
    between.record(&mut list, 70);
    let shape = between.buffers().shape;
    let ticket = list.read_buffer(between.buffers().positions, 0, 16 * u64::from(shape.strand_vertices()));
    backend.run(&list).unwrap();
    let positions: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&backend.read(ticket).ready().unwrap());
    for strand in 0..shape.guides {
        let is_made = positions[shape.index(strand, shape.vertices - 1) as usize][..3] != [0.0; 3];
        assert_eq!(is_made, strand < 70, "strand {strand}");
    }
}

#[test]
fn what_guides_do_alike_their_strands_do_too() {
    // Straight guides that are moved by one affine map without shear of lengths: a point between three guides goes where the map takes it.
    let roots = square(300);
    let straight =
        |root: Vec2| -> Vec<Vec3> { (0..6).map(|vertex| Vec3::new(root.x, 0.02 * vertex as f32, root.y)).collect() };
    let strands = guides(&roots, straight);
    let between = scattered(&strands, 2000, &InterpolationParams::default());
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -0.7).as_dquat();
    let moved = |point: DVec3| turn * point + DVec3::new(3.0, -1.0, 0.5);
    let shaken = InterpolationParams { noise: 0.2, clump: 0.5, shorter: 0.3, ..InterpolationParams::default() };
    let shaken = scattered(&strands, 2000, &shaken);
    let rest: Vec<DVec3> = strands.rest.iter().map(|vertex| vertex.truncate().as_dvec3()).collect();
    let turned: Vec<DVec3> = rest.iter().copied().map(moved).collect();
    let of = |between: &Interpolation, index: u32, positions: &[DVec3]| {
        let strand_of = &between.between()[index as usize];
        let trio = strand_of.guides.to_array().map(|guide| strand(positions, strands.vertices, guide));
        reference::interpolate(between.uniform(), strand_of, index, trio)
    };
    for index in 0..2000 {
        let own = of(&between, index, &rest);
        assert!(own[0].y.abs() < 1e-9, "the root is on the skin");
        for (vertex, point) in own.iter().enumerate() {
            assert!((*point - own[0]).distance(DVec3::Y * 0.02f32 as f64 * vertex as f64) < 1e-7, "{point}");
        }
        // Chance too goes with the guides.
        for between in [&between, &shaken] {
            let (before, after) = (of(between, index, &rest), of(between, index, &turned));
            let error = before.iter().zip(&after).map(|(before, &after)| moved(*before).distance(after));
            assert!(error.fold(0.0, f64::max) < 1e-9);
        }
    }
}

#[test]
fn strands_between_guides_that_part_keep_their_lengths() {
    // Each guide leans away from the middle: their mean would be far too short.
    let leaning = |root: Vec2| -> Vec<Vec3> {
        let way = Vec3::new(root.x - 0.5, 0.1, root.y - 0.5).normalize();
        (0..5).map(|vertex| Vec3::new(root.x, 0.0, root.y) + way * 0.1 * vertex as f32).collect()
    };
    let strands = guides(&square(60), leaning);
    for params in [
        InterpolationParams { parting: 180.0, ..InterpolationParams::default() },
        InterpolationParams { parting: 180.0, clump: 1.0, ..InterpolationParams::default() },
    ] {
        let between = scattered(&strands, 1000, &params);
        let rest = between.rest(&strands, 1000).unwrap();
        for lengths in rest.rest_lengths.chunks(5) {
            let length: f32 = lengths.iter().sum();
            assert!((length - 0.4).abs() < 1e-5, "{length}");
        }
    }
}

#[test]
fn hair_parts_between_guides_that_differ() {
    let sides = |root: Vec2| -> Vec<Vec3> {
        let way = Vec3::new(if root.x < 0.5 { -0.7 } else { 0.7 }, 0.8, 0.0).normalize();
        (0..4).map(|vertex| Vec3::new(root.x, 0.0, root.y) + way * 0.05 * vertex as f32).collect()
    };
    let strands = guides(&square(200), sides);
    let upright = |parting: f32| {
        let params = InterpolationParams { parting, ..InterpolationParams::default() };
        let rest = scattered(&strands, 4000, &params).rest(&strands, 4000).unwrap();
        rest.root_directions.iter().filter(|direction| direction.x.abs() < 0.6).count()
    };
    let (parted, mixed) = (upright(60.0), upright(180.0));
    println!("strands that are on neither side: {parted} with a parting, {mixed} without");
    assert!(parted == 0 && mixed > 100, "{parted} {mixed}");
}

#[test]
fn density_is_that_of_the_guides() {
    // A density that is four times as high on one side as on the other: 1 + 3 x, through the inverse of its integral.
    let across = |u: f32| ((1.0 + 15.0 * u).sqrt() - 1.0) / 3.0;
    let roots: Vec<Vec2> = square(2000).into_iter().map(|place| Vec2::new(across(place.x), place.y)).collect();
    let standing = |root: Vec2| vec![Vec3::new(root.x, 0.0, root.y), Vec3::new(root.x, 0.02, root.y)];
    let strands = guides(&roots, standing);
    let count = 100_000;
    let between = scattered(&strands, count, &InterpolationParams::default());
    let all: Vec<Vec3> = between.rest(&strands, count).unwrap().rest.chunks(2).map(|of| of[0].truncate()).collect();
    // Beyond the outermost guides there is no hair: parts are within. Of all strands, and of the first tenth and hundredth.
    let parts: Vec<[f32; 2]> =
        (0..8).map(|part| [0.06 + 0.11 * part as f32, 0.06 + 0.11 * (part + 1) as f32]).collect();
    let expected = |[low, high]: [f32; 2]| (high - low) * (1.0 + 1.5 * (low + high));
    let inner: f32 = parts.iter().map(|&part| expected(part)).sum();
    for (share, most) in [(1, 0.03), (10, 0.03), (100, 0.15)] {
        let first = &all[..all.len() / share];
        let within = |[low, high]: [f32; 2]| {
            first.iter().filter(|root| (low..high).contains(&root.x) && (0.06..0.94).contains(&root.z)).count() as f32
        };
        let found: f32 = parts.iter().map(|&part| within(part)).sum();
        for &part in &parts {
            let error = within(part) / found / (expected(part) / inner) - 1.0;
            println!("1/{share}: {part:?} {:+.2} %", 100.0 * error);
            assert!(error.abs() < most, "1/{share}, {part:?}: {error}");
        }
    }
}

#[test]
fn curls_of_few_vertices_are_round() {
    // A helix of a radius of 1 cm, ten vertices a turn.
    let curl = |root: Vec2| -> Vec<Vec3> {
        let at = |vertex: usize| {
            let angle = std::f32::consts::TAU * vertex as f32 / 10.0;
            Vec3::new(0.01 * angle.cos(), 0.002 * vertex as f32, 0.01 * angle.sin())
        };
        (0..31).map(|vertex| Vec3::new(root.x, 0.0, root.y) + at(vertex)).collect()
    };
    let strands = guides(&square(40), curl);
    let params = InterpolationParams { vertices: Some(121), ..InterpolationParams::default() };
    let rest = scattered(&strands, 50, &params).rest(&strands, 50).unwrap();
    let mut worst = 0.0f32;
    for strand in rest.rest.chunks(121) {
        let axis = strand[0].truncate() - Vec3::X * 0.01;
        // Beyond the first and the last edge, at which nobody knows how it goes on.
        for vertex in &strand[4..117] {
            let radius = (vertex.truncate() - axis).reject_from(Vec3::Y).length();
            worst = worst.max((radius / 0.01 - 1.0).abs());
        }
    }
    println!("radius off by {:.2} %", 100.0 * worst);
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn what_cannot_be_interpolated_is_refused_by_name() {
    let mut backend = NullBackend::default();
    let mut refused = |strands: &Strands, count: u32, params: &InterpolationParams| {
        let buffers = StrandBuffers::new(&mut backend, StrandShape::of(strands), Vec3::ZERO).unwrap();
        let mut list = PassList::new();
        Interpolation::new(&mut backend, &mut list, (&buffers, strands), count, params).unwrap_err()
    };
    let up = |root: Vec2| vec![Vec3::new(root.x, 0.0, root.y), Vec3::new(root.x, 0.1, root.y)];
    let line: Vec<Vec2> = (0..20).map(|i| Vec2::new(i as f32, 2.0 * i as f32)).collect();
    let plain = InterpolationParams::default();
    for roots in [&line[..], &line[..2], &[Vec2::ONE; 5]] {
        let error = refused(&guides(roots, up), 100, &plain);
        assert!(matches!(error, SimError::NoTriangles { .. }), "{error}");
    }
    let strands = guides(&square(30), up);
    assert!(matches!(refused(&strands, 0, &plain), SimError::RenderStrands { .. }));
    assert!(matches!(refused(&strands, u32::MAX, &plain), SimError::RenderStrands { .. }));
    for (params, name) in [
        (InterpolationParams { vertices: Some(1), ..plain.clone() }, "vertices"),
        (InterpolationParams { noise: f32::NAN, ..plain.clone() }, "noise"),
        (InterpolationParams { clump: 1.5, ..plain.clone() }, "clump"),
        (InterpolationParams { parting: -1.0, ..plain.clone() }, "parting"),
        (InterpolationParams { shorter: 1.0, ..plain }, "shorter"),
    ] {
        assert!(refused(&strands, 10, &params).to_string().contains(name), "{name}");
    }
    // Any roots whatever: nothing panics.
    let mut random = Random::new(5);
    for _ in 0..20 {
        let roots: Vec<Vec2> = (0..40).map(|_| Vec2::new(random.signed(), random.signed()).powf(9.0)).collect();
        let roots: Vec<Vec2> = roots.into_iter().map(|root| if root.is_finite() { root } else { Vec2::ZERO }).collect();
        let strands = guides(&roots, up);
        let mut backend = NullBackend::default();
        let buffers = StrandBuffers::new(&mut backend, StrandShape::of(&strands), Vec3::ZERO).unwrap();
        let made = Interpolation::new(
            &mut backend,
            &mut PassList::new(),
            (&buffers, &strands),
            200,
            &InterpolationParams::default(),
        );
        if let Ok(between) = made {
            assert!(between.rest(&strands, 200).unwrap().rest.iter().all(|vertex| vertex.is_finite()));
        }
    }
}
