//! The zero surface of a field as triangles: held to its reference, closed, and as large as what it shows.

#[path = "support/mesh.rs"]
mod mesh;
mod support;

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::{DVec3, UVec3};
use mesh::{Triangles, ball, bust, torus};
use support::gpu;
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_core::backend::{Backend, Run};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_sim::field::{FieldDesc, FieldError, FieldSurface, Fields, SurfaceSize};
use tressfx_sim::reference::field::{Field, FieldGrid};
use tressfx_sim::reference::{surface_count, surface_emit, surface_scan};

/// A surface that was read back.
struct Found {
    field: Field,
    size: SurfaceSize,
    /// Positions and normals.
    vertices: Vec<[f32; 8]>,
    triangles: Vec<[u32; 3]>,
    /// What a draw is told.
    draw: Vec<u32>,
}

fn words<T: bytemuck::Pod>(backend: &mut dyn Run, ticket: Ticket) -> Vec<T> {
    bytemuck::pod_collect_to_vec(&backend.read(ticket).ready().expect("the list has run"))
}

/// Counts, makes room, and writes.
fn surface(backend: &mut dyn Run, (positions, indices): &Triangles, nodes: u32) -> Found {
    let mut list = PassList::new();
    let desc = FieldDesc::new(positions, indices).with_nodes(nodes);
    let mut fields = Fields::new(backend, &mut list, &[desc]).expect("the mesh is a body");
    let mut surface = FieldSurface::new(backend, &fields, 0).expect("there is one");
    fields.record(&mut list);
    let counted = surface.record(&mut list);
    backend.run(&list).expect("the list runs");
    let size = words::<SurfaceSize>(backend, counted)[0];
    let is_small = surface.make_room(backend, size).expect("there is room");
    assert_eq!(is_small, size.triangles > 0);
    assert!(!surface.make_room(backend, size).unwrap(), "there is room now");
    let mut list = PassList::new();
    let again = surface.record(&mut list);
    let buffers = surface.buffers();
    let vertices = list.read_buffer(buffers.vertices, 0, 32 * u64::from(size.vertices.max(1)));
    let triangles = list.read_buffer(buffers.indices, 0, 12 * u64::from(size.triangles.max(1)));
    let draw = list.read_buffer(buffers.draw, 0, 16);
    let [header, distances] = fields.read(&mut list, 0).unwrap();
    backend.run(&list).expect("the list runs");
    assert_eq!(words::<SurfaceSize>(backend, again)[0], size);
    let field = Field::from_words(&words::<u32>(backend, header), &words::<u32>(backend, distances)).unwrap();
    let (mut vertices, mut triangles) = (words(backend, vertices), words(backend, triangles));
    vertices.truncate(size.vertices as usize);
    triangles.truncate(size.triangles as usize);
    let draw = words(backend, draw);
    surface.destroy(backend);
    fields.destroy(backend);
    Found { field, size, vertices, triangles, draw }
}

/// Volume and area of what is within triangles.
fn measures(points: &[DVec3], triangles: &[[u32; 3]]) -> [f64; 2] {
    triangles.iter().fold([0.0, 0.0], |[volume, area], triangle| {
        let [a, b, c] = triangle.map(|vertex| points[vertex as usize]);
        [volume + a.dot(b.cross(c)) / 6.0, area + 0.5 * (b - a).cross(c - a).length()]
    })
}

fn points_of(found: &Found) -> Vec<DVec3> {
    found.vertices.iter().map(|vertex| DVec3::new(vertex[0].into(), vertex[1].into(), vertex[2].into())).collect()
}

/// Edges without exactly two triangles, one along each way.
fn open_edges(triangles: &[[u32; 3]]) -> usize {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for [a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            edges.entry([*from.min(to), *from.max(to)]).or_default()[usize::from(from > to)] += 1;
        }
    }
    edges.values().filter(|ways| **ways != [1, 1]).count()
}

/// A ring without some of its triangles, and with one turned inside out.
fn damaged() -> Triangles {
    let (positions, mut indices) = torus(40, 0.7, 14, 0.23);
    indices.drain(300..330);
    indices.swap(600, 601);
    (positions, indices)
}

#[test]
fn each_kernel_matches_its_reference_and_the_surface_is_closed() {
    let needle = (vec![glam::Vec3::ZERO, glam::Vec3::ONE, glam::Vec3::new(0.5, 0.4, 0.5)], vec![0, 1, 2]);
    let cases = [("a ring", Some(damaged()), 40), ("a triangle", Some(needle), 24), ("Sintel's bust", bust(), 56)];
    for (name, triangles, nodes) in cases {
        let (Some(triangles), Some(mut backend)) = (triangles, gpu()) else { continue };
        let found = surface(&mut *backend, &triangles, nodes);
        let Found { field, size, .. } = &found;
        let counts = surface_count(field);
        let firsts = surface_scan(&counts);
        assert_eq!(firsts.last(), Some(&[size.vertices, size.triangles]), "{name}");
        let (vertices, triangles) = surface_emit(field);
        assert!(found.triangles == triangles, "{name}: the triangles");
        assert_eq!(vertices.len(), found.vertices.len(), "{name}");
        let (mut off, mut turned) = (0.0f64, 0.0f64);
        for (found, [position, normal]) in found.vertices.iter().zip(&vertices) {
            let [x, y, z, one, ..] = found.map(f64::from);
            let [.., u, v, w, zero] = found.map(f64::from);
            assert_eq!([one, zero], [1.0, 0.0]);
            off = off.max(position.distance(DVec3::new(x, y, z)) / field.grid.cell);
            turned = turned.max(normal.distance(DVec3::new(u, v, w)));
        }
        println!("{name}: {size:?}, off by {off:.1e} cells, normals by {turned:.1e}");
        assert!(off < 1e-4 && turned < 1e-3, "{name}: {off} {turned}");
        assert_eq!(open_edges(&found.triangles), 0, "{name}: open edges");
        assert_eq!(found.draw, [3 * size.triangles, 1, 0, 0], "{name}");
        assert_eq!(size.triangles > 1000, name != "a triangle", "{name}: {size:?}");
        // Normals and windings both look out.
        let inward = |triangle: &&[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize]);
            (b[0] - a[0]).cross(c[0] - a[0]).dot(a[1] + b[1] + c[1]) < 0.0
        };
        let inward = triangles.iter().filter(inward).count();
        // What is thinner than a cell has no slope across it.
        let is_thin = name == "a triangle";
        assert!(is_thin || inward * 100 <= triangles.len(), "{name}: {inward} of {} look in", triangles.len());
    }
}

/// A body whose volume and area are known.
struct Known {
    name: &'static str,
    mesh: Triangles,
    distance: fn(DVec3) -> f64,
    measures: [f64; 2],
}

fn known() -> [Known; 2] {
    let (tube, radius) = (0.23f64, 0.7);
    [
        Known {
            name: "a ball",
            mesh: ball(512),
            distance: |point| point.distance(DVec3::new(0.3, -0.2, 0.1)) - 0.9,
            measures: [4.0 / 3.0 * PI * 0.9f64.powi(3), 4.0 * PI * 0.81],
        },
        Known {
            name: "a ring",
            mesh: torus(600, radius as f32, 200, tube as f32),
            distance: |point| (point.x.hypot(point.z) - 0.7).hypot(point.y) - 0.23,
            measures: [2.0 * PI * PI * radius * tube * tube, 4.0 * PI * PI * radius * tube],
        },
    ]
}

/// Errors of volume and area as shares of them, and the powers of the cell that they fall with. Errors are those of straight triangles on a round body: a quarter
/// where cells are half as wide.
fn converges(name: &str, of_cells: &[(f64, [f64; 2])], known: [f64; 2]) {
    let errors: Vec<_> = of_cells
        .iter()
        .map(|(cell, found)| (cell, [0, 1].map(|kind| (found[kind] / known[kind] - 1.0).abs())))
        .collect();
    for pair in errors.windows(2) {
        let [(wide, before), (narrow, after)] = [pair[0], pair[1]];
        let orders = [0, 1].map(|kind| (before[kind] / after[kind]).ln() / (wide / narrow).ln());
        println!("{name}: cells of {narrow:.4}: errors {after:.5?} of volume and area, orders {orders:.2?}");
        assert!(orders.iter().all(|order| *order > 1.7), "{name}: {orders:?}");
    }
    let [volume, area] = errors.last().unwrap().1;
    assert!(volume < 6e-3 && area < 6e-3, "{name}: {volume} {area}");
}

#[test]
fn volume_and_area_converge_to_those_of_a_ball_and_a_ring() {
    let Some(mut backend) = gpu() else { return };
    for Known { name, mesh, distance, measures: known } in known() {
        let of_mesh: Vec<_> = [24, 40, 64]
            .map(|nodes| {
                let found = surface(&mut *backend, &mesh, nodes);
                (found.field.grid.cell, measures(&points_of(&found), &found.triangles))
            })
            .into();
        converges(name, &of_mesh, known);
        // With exact distances, in f64, down to narrower cells.
        let exact: Vec<_> = [24u32, 48, 96]
            .map(|nodes| {
                let cell = 2.6 / f64::from(nodes - 1);
                let grid = FieldGrid { origin: DVec3::splat(-1.3), cell, nodes: UVec3::splat(nodes) };
                let at = |index| distance(grid.origin + cell * grid.node(index).as_dvec3());
                let field = Field { grid, distances: (0..grid.count()).map(at).collect(), margin: 0.0 };
                let (vertices, triangles) = surface_emit(&field);
                assert_eq!(open_edges(&triangles), 0);
                (cell, measures(&vertices.iter().map(|vertex| vertex[0]).collect::<Vec<_>>(), &triangles))
            })
            .into();
        converges(&format!("{name}, exactly"), &exact, known);
    }
}

/// Raw Vulkan, under the eyes of the validation layer, and wgpu.
#[test]
fn a_surface_is_the_same_to_the_bit_on_both_backends() {
    let Some(mut wgpu) = gpu() else { return };
    let options = VulkanOptions { validation: true, ..Default::default() };
    let mut vulkan = VulkanBackend::headless_with(&options).unwrap();
    let [one, other] = [surface(&mut *wgpu, &damaged(), 48), surface(&mut vulkan, &damaged(), 48)];
    assert!(one.size.triangles > 5000 && one.size == other.size);
    assert!(bytemuck::cast_slice::<_, u32>(&one.vertices) == bytemuck::cast_slice::<_, u32>(&other.vertices));
    assert!(one.triangles == other.triangles);
}

#[test]
fn a_surface_without_room_is_counted_and_not_drawn() {
    let Some(mut backend) = gpu() else { return };
    let (positions, indices) = ball(24);
    let mut list = PassList::new();
    let mut fields =
        Fields::new(&mut *backend, &mut list, &[FieldDesc::new(&positions, &indices).with_nodes(24)]).unwrap();
    let mut surface = FieldSurface::new(&mut *backend, &fields, 0).unwrap();
    fields.record(&mut list);
    backend.run(&list).unwrap();
    let made = |backend: &mut dyn Run, surface: &FieldSurface| {
        let mut list = PassList::new();
        let size = surface.record(&mut list);
        let draw = list.read_buffer(surface.buffers().draw, 0, 16);
        backend.run(&list).unwrap();
        (words::<SurfaceSize>(backend, size)[0], words::<u32>(backend, draw)[0])
    };
    let (size, drawn) = made(&mut *backend, &surface);
    assert!(size.vertices > 500 && size.triangles > 1000 && drawn == 0, "{size:?}");
    let few_vertices = SurfaceSize { vertices: size.vertices / 2, ..size };
    let few_triangles = SurfaceSize { triangles: size.triangles / 2, ..size };
    for few in [few_vertices, few_triangles] {
        for (room, expected) in [(few, 0), (size, 3 * size.triangles)] {
            assert!(surface.make_room(&mut *backend, room).unwrap(), "{room:?}");
            assert_eq!(made(&mut *backend, &surface), (size, expected), "{:?}", surface.room());
        }
        surface.destroy(&mut *backend);
        surface = FieldSurface::new(&mut *backend, &fields, 0).unwrap();
    }
    let error = FieldSurface::new(&mut *backend, &fields, 1).unwrap_err();
    assert_eq!(error, FieldError::NoField { index: 1, count: 1 });
}

/// What nobody looks at costs nothing.
#[test]
fn fields_without_a_view_have_no_pass_and_no_bytes_for_it() {
    let mut backend = NullBackend::default();
    let (positions, indices) = ball(16);
    let mut list = PassList::new();
    let mut fields = Fields::new(&mut backend, &mut list, &[FieldDesc::new(&positions, &indices)]).unwrap();
    fields.record(&mut list);
    assert!(list.labels().all(|label| !label.contains("surface")));
    assert!(backend.shaders.iter().all(|shader| !shader.label.contains("surface")));
    let before = backend.memory().bytes;
    let surface = FieldSurface::new(&mut backend, &fields, 0).unwrap();
    let mut list = PassList::new();
    surface.record(&mut list);
    let labels: Vec<_> = list.labels().filter(|label| label.starts_with("hair.")).collect();
    assert_eq!(labels, ["hair.sim.surface_count", "hair.sim.surface_scan", "hair.sim.surface_emit"]);
    assert!(backend.memory().bytes > before);
    surface.destroy(&mut backend);
    assert_eq!(backend.memory().bytes, before);
}
