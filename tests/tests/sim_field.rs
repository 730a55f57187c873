//! Signed distance fields of meshes: each kernel against its reference, and the whole against exact distances.

#[path = "support/mesh.rs"]
mod mesh;
mod support;

use std::time::Instant;

use glam::{DVec3, UVec3, Vec3};
use mesh::{Triangles, ball, body, bust, torus};
use support::gpu;
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::sim::Random;
use tressfx_conformance::solid::Solid;
use tressfx_core::backend::{Backend, BufferDesc, Run};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_sim::field::{FieldDesc, FieldError, Fields, VertexBuffer};
use tressfx_sim::reference::{
    self,
    field::{Field, FieldGrid},
};

/// Points that a field is held to in a mesh.
const POINTS: usize = 50_000;

fn words(backend: &mut dyn Run, ticket: Ticket) -> Vec<u32> {
    bytemuck::pod_collect_to_vec(&backend.read(ticket).ready().expect("the list has run"))
}

/// A field, as words: its header and its distances.
fn field_words(backend: &mut dyn Run, (positions, indices): &Triangles, nodes: u32) -> [Vec<u32>; 2] {
    let mut list = PassList::new();
    let desc = FieldDesc::new(positions, indices).with_nodes(nodes);
    let mut fields = Fields::new(backend, &mut list, &[desc]).expect("the mesh is a body");
    fields.record(&mut list);
    let tickets = fields.read(&mut list, 0).expect("there is one");
    let start = Instant::now();
    backend.run(&list).expect("the list runs");
    println!("{} triangles, {nodes} nodes: {:?}", indices.len() / 3, start.elapsed());
    let words = tickets.map(|ticket| words(backend, ticket));
    fields.destroy(backend);
    words
}

fn field(backend: &mut dyn Run, triangles: &Triangles, nodes: u32) -> Field {
    let [header, distances] = field_words(backend, triangles, nodes);
    Field::from_words(&header, &distances).expect("the field is whole")
}

/// Without some of its triangles, and with some turned inside out.
fn damaged((positions, mut indices): Triangles) -> Triangles {
    indices.drain(300..330);
    for flipped in [12, 600, 909] {
        indices.swap(flipped, flipped + 1);
    }
    let corner = indices[90];
    indices.extend([corner, corner, indices[91], corner, indices[94], corner]);
    (positions, indices)
}

/// The boundary of a mesh whose vertices are all apart, by counting.
fn open_edges(indices: &[u32]) -> Vec<[i32; 3]> {
    let mut times = std::collections::BTreeMap::new();
    for triangle in indices.as_chunks::<3>().0 {
        for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(from, to)| (triangle[from] as i32, triangle[to] as i32)) {
            *times.entry((from.min(to), from.max(to))).or_insert(0) += (to - from).signum();
        }
    }
    times.into_iter().filter(|(_, times)| *times != 0).map(|((from, to), times)| [from, to, times]).collect()
}

#[test]
fn each_kernel_matches_its_reference() {
    let meshes = [
        ("a ring", torus(40, 0.7, 14, 0.23)),
        ("a damaged ring", damaged(torus(40, 0.7, 14, 0.23))),
        ("a triangle", (vec![Vec3::ZERO, Vec3::new(1.0, 0.2, 0.1), Vec3::new(-0.2, 0.7, 0.9)], vec![0, 1, 2])),
    ];
    for (name, (positions, indices)) in meshes {
        let Some(mut backend) = gpu() else { return };
        let mut list = PassList::new();
        let desc = FieldDesc::new(&positions, &indices).with_nodes(32);
        let mut fields = Fields::new(&mut *backend, &mut list, &[desc]).unwrap();
        fields.record(&mut list);
        let [header, distances] = fields.read(&mut list, 0).unwrap();
        let steps = fields.read_steps(&mut list, 0).unwrap();
        backend.run(&list).unwrap();
        let [extremes, band, crossings, points] = steps.map(|ticket| words(&mut *backend, ticket));
        let [header, distances] = [header, distances].map(|ticket| words(&mut *backend, ticket));
        let found = Field::from_words(&header, &distances).unwrap();

        let number = |ordered: u32| f32::from_bits(if ordered >> 31 == 1 { ordered & 0x7fff_ffff } else { !ordered });
        let [least, most] = reference::field_bounds(&positions, &indices).unwrap();
        for axis in 0..3 {
            assert_eq!(f64::from(number(extremes[axis])), most[axis], "{name}: the box");
            assert_eq!(f64::from(number(!extremes[3 + axis])), least[axis], "{name}: the box");
        }
        let grid = reference::field_grid(Some([least, most]), found.grid.nodes);
        assert!((grid.cell / found.grid.cell - 1.0).abs() < 1e-6, "{name}: {grid:?}, {:?}", found.grid);
        assert!(grid.origin.distance(found.grid.origin) < 1e-6, "{name}: {grid:?}, {:?}", found.grid);

        // From here on with the grid of the GPU.
        let grid = found.grid;
        let triangles = grid.in_cells(&positions, &indices);
        let near = reference::field_splat(&grid, &triangles);
        let bits = (indices.len() as u32 / 3).next_power_of_two().ilog2().max(1);
        let apart = |node: usize, triangle: u32| {
            let point = grid.node(node).as_dvec3();
            reference::field::nearest_on(&triangles[triangle as usize], point).distance(point)
        };
        for (node, (kept, expected)) in band.iter().zip(&near).enumerate() {
            let kept = (*kept != 0).then(|| !kept & ((1 << bits) - 1));
            // At the edge of the band, rounding decides.
            match (kept, expected) {
                (Some(kept), Some(expected)) => {
                    let off = apart(node, kept) - apart(node, *expected);
                    assert!(
                        off.abs() < 1e-5,
                        "{name}: node {node} is {off} cells further from {kept} than from {expected}"
                    );
                }
                (None, None) => {}
                (one, other) => {
                    let distance = apart(node, one.or(*other).unwrap());
                    assert!((distance - 1.5).abs() < 1e-4, "{name}: node {node}: {one:?}, not {other:?}");
                }
            }
        }
        let expected = reference::field_crossings(&grid, &triangles);
        let crossings: Vec<i32> = crossings.into_iter().map(|word| word as i32).collect();
        // A corner that is rounded to another part of a cell may move a crossing by a node.
        let differing = crossings.iter().zip(&expected).filter(|(one, other)| one != other).count();
        assert!(
            expected.iter().any(|&times| times != 0) && differing <= expected.len() / 2000,
            "{name}: {differing} crossings"
        );

        let mut known = reference::field_seed(&grid, &triangles, &near);
        for reach in [16, 8, 4, 2, 1, 1] {
            known = reference::field_flood(&grid, &triangles, &known, reach);
        }
        let (mut furthest, mut other_ways) = (0.0f64, 0);
        for (node, (point, expected)) in points.as_chunks::<4>().0.iter().zip(&known).enumerate() {
            let at = DVec3::from_array([0, 1, 2].map(|axis| f32::from_bits(point[axis]).into()));
            assert!(point[3] > 0, "{name}: node {node} has a triangle");
            let here = grid.node(node).as_dvec3();
            let off = (at.distance(here) - expected.unwrap().0.distance(here)).abs();
            (furthest, other_ways) = (furthest.max(off), other_ways + usize::from(off > 1e-4));
        }
        let expected = reference::field_sign(&grid, &positions, &known, &expected, &open_edges(&indices));
        let mut wrong = 0;
        for (found, expected) in found.distances.iter().zip(&expected) {
            // On the surface rounding decides.
            wrong += usize::from(found.signum() != expected.signum() && expected.abs() > 0.01 * grid.cell);
        }
        let whole = Field::of(&positions, &indices, grid.nodes, &open_edges(&indices));
        assert_eq!(whole.distances.len(), expected.len());
        let inside = expected.iter().filter(|distance| **distance < 0.0).count();
        println!(
            "{name}: {other_ways} of {} distances differ, by {furthest:.1e} cells, {wrong} signs, {inside} inside",
            expected.len()
        );
        // Of two triangles that are as near, rounding decides which one goes on, and further away it is the wrong one now and then.
        assert!(furthest < 0.1 && other_ways * 50 < expected.len(), "{name}: {furthest} cells");
        assert_eq!(wrong, 0, "{name}: signs");
        assert_eq!(inside > 100, name != "a triangle", "{name}: {inside} nodes inside");
        fields.destroy(&mut *backend);
    }
}

/// How a field differs from exact distances at random points in its box.
struct Judged {
    /// Errors in cells, ascending.
    errors: Vec<f64>,
    /// Points further from the surface than half a cell on the wrong side, where the winding number is not nearly a half.
    wrong: usize,
    /// Points that exact nodes would put on the wrong side as well; they do not count as wrong.
    thin: usize,
    /// Points where it is.
    unsure: usize,
    inside: usize,
    /// The largest error of a node, in cells.
    node_error: f64,
    /// Points that are off by more than half a cell.
    beyond: usize,
    /// The largest error of an interpolation between exact nodes, where the distance changes by no more than the way; and where it jumps, from one side of a hole to the
    /// other. Then the largest difference of the field from that interpolation. Of points that are off by more than 0.4 cells.
    of_exact: [f64; 3],
}

/// What a field whose nodes around a point were exact would give there, and whether the distances of these nodes differ from that of the point by no more than the way.
fn of_exact_nodes(solid: &Solid, field: &Field, (point, exact): (DVec3, f64)) -> (f64, bool) {
    let FieldGrid { origin, cell, nodes } = field.grid;
    let low = ((point - origin) / cell).floor().min(nodes.as_dvec3() - 2.0).as_uvec3();
    let mut is_steady = true;
    let distances = (0..8).map(|corner| {
        let node = low + UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
        let place = origin + cell * node.as_dvec3();
        let distance = solid.distance(place);
        is_steady &= (distance - exact).abs() <= place.distance(point) + 1e-9 * cell;
        distance
    });
    let distances = distances.collect();
    let grid = FieldGrid { origin: origin + cell * low.as_dvec3(), cell, nodes: UVec3::splat(2) };
    (Field { grid, distances, margin: 0.0 }.sample(point).0, is_steady)
}

fn judged(solid: &Solid, field: &Field, points: usize) -> Judged {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let part = |seed: usize| {
        let mut random = Random::new(seed as u64 + 1);
        let (mut errors, mut wrong, mut thin, mut unsure, mut inside) = (Vec::new(), 0, 0, 0, 0);
        let mut of_exact = [0.0f64; 3];
        let size = field.grid.cell * (field.grid.nodes.as_dvec3() - 1.0);
        for _ in 0..points / threads {
            let point = field.grid.origin + 0.5 * (random.vector().as_dvec3() + 1.0) * size;
            let (found, _) = field.sample(point);
            let (away, winding) = (solid.away(point), solid.winding(point));
            let is_inside = winding > 0.5;
            inside += usize::from(is_inside);
            let is_unsure = (winding - 0.5).abs() < 0.1;
            unsure += usize::from(is_unsure);
            if !is_unsure {
                let exact = if is_inside { -away } else { away };
                let error = (found - exact).abs() / field.grid.cell;
                errors.push(error);
                if error > 0.4 {
                    let (best, is_steady) = of_exact_nodes(solid, field, (point, exact));
                    let kind = if is_steady { 0 } else { 1 };
                    of_exact[kind] = of_exact[kind].max((best - exact).abs() / field.grid.cell);
                    of_exact[2] = of_exact[2].max((best - found).abs() / field.grid.cell);
                    // What is thin between nodes is not there, be they exact.
                    let is_wrong = found.signum() != exact.signum() && away > 0.5 * field.grid.cell;
                    wrong += usize::from(is_wrong && best.signum() == exact.signum());
                    thin += usize::from(is_wrong && best.signum() != exact.signum());
                }
            }
        }
        (errors, [wrong, thin, unsure, inside], of_exact)
    };
    let parts: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|seed| scope.spawn(move || part(seed))).collect();
        threads.into_iter().map(|thread| thread.join().expect("a part")).collect()
    });
    let [wrong, thin, unsure, inside] =
        parts.iter().fold([0; 4], |sums, part| [0, 1, 2, 3].map(|kind| sums[kind] + part.1[kind]));
    let of_exact = [0, 1, 2].map(|kind| parts.iter().map(|part| part.2[kind]).fold(0.0, f64::max));
    let mut errors: Vec<f64> = parts.into_iter().flat_map(|part| part.0).collect();
    errors.sort_by(f64::total_cmp);
    let beyond = errors.iter().filter(|error| **error > 0.5).count();
    let each = field.distances.len().div_ceil(2000).max(1);
    let nodes = field.distances.iter().enumerate().step_by(each).map(|(node, distance)| {
        let point = field.grid.origin + field.grid.cell * field.grid.node(node).as_dvec3();
        (distance.abs() - solid.away(point)).abs() / field.grid.cell
    });
    Judged { errors, wrong, thin, unsure, inside, node_error: nodes.fold(0.0, f64::max), beyond, of_exact }
}

#[test]
fn distances_are_those_of_the_mesh() {
    let points = std::env::var("TRESSFX_FIELD_POINTS").map_or(POINTS, |points| points.parse().expect("a number"));
    let real = [("Sintel's bust", bust()), ("the Ratboy", body())];
    let meshes = [("a ball", Some(ball(64))), ("a ring", Some(torus(120, 0.7, 40, 0.23)))];
    for (name, triangles) in meshes.into_iter().chain(real) {
        let (Some(triangles), Some(mut backend)) = (triangles, gpu()) else { continue };
        let field = field(&mut *backend, &triangles, 64);
        let start = Instant::now();
        let solid = Solid::new(&triangles.0, &triangles.1);
        let Judged { errors, wrong, thin, unsure, inside, node_error, beyond, of_exact } =
            judged(&solid, &field, points);
        let share = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
        println!(
            "{name}: errors {:.4} (median) {:.4} (99 %) {:.4} (99.99 %) {:.4} (largest) cells, {node_error:.4} at nodes, {wrong} wrong sides, {thin} of exact nodes too, {unsure} unsure, {inside} inside of {points} points, {:?}",
            share(0.5),
            share(0.99),
            share(0.9999),
            share(1.0),
            start.elapsed()
        );
        println!(
            "{name}: {beyond} points are off by more than half a cell; exact nodes by {:.4} at most, by {:.4} where holes are closed; the field differs from those by {:.4}",
            of_exact[0], of_exact[1], of_exact[2]
        );
        assert_eq!(wrong, 0, "{name}: points on the wrong side");
        assert!(node_error < 0.2 && share(0.999) < 0.5, "{name}");
        // Where two or more parts of the surface are as near, such as in the middle of a ball, the distance has a ridge or a peak between nodes, which an interpolation
        // cuts: by half the diagonal of a cell at most, since a distance changes by no more than the way. No better nodes would change that.
        assert!(of_exact[0] < 0.75f64.sqrt() && of_exact[2] < 0.2, "{name}: {of_exact:?}");
        assert!(inside > points / 50, "{name}: {inside} inside");
    }
}

/// The bound of the errors between nodes is met: all eight nodes around the middle of a ball are as far from it.
#[test]
fn an_interpolation_cuts_a_peak_by_half_the_diagonal_of_a_cell() {
    let grid = FieldGrid { origin: DVec3::splat(-0.5), cell: 1.0, nodes: UVec3::splat(2) };
    let distance = |node| (grid.origin + grid.node(node).as_dvec3()).length() - 9.0;
    let field = Field { grid, distances: (0..8).map(distance).collect(), margin: 0.0 };
    let (found, _) = field.sample(DVec3::ZERO);
    assert!((found + 9.0 - 0.75f64.sqrt()).abs() < 1e-12, "{found}");
}

/// Of what is no mesh, what is said about it.
#[test]
fn what_is_no_body_is_refused_by_name() {
    let Some(mut backend) = gpu() else { return };
    let (positions, indices) = ball(8);
    let mut refused = |desc: &FieldDesc| {
        Fields::new(&mut *backend, &mut PassList::new(), &[FieldDesc::new(&positions, &indices), *desc])
            .unwrap_err()
            .to_string()
    };
    let good = FieldDesc::new(&positions, &indices);
    assert_eq!(
        refused(&FieldDesc::new(&positions, &[])),
        "field 1: 0 indices are no triangles: there are three a triangle, and at least one triangle"
    );
    assert!(refused(&FieldDesc::new(&positions, &indices[1..])).contains("indices are no triangles"));
    assert!(refused(&FieldDesc::new(&positions, &[0, 1, 2, 0, 1, 999])).contains("triangle 1 has the vertex 999 of"));
    let mut spoiled = positions.clone();
    for wrong in [f32::NAN, f32::INFINITY, 1e30] {
        spoiled[5].y = wrong;
        assert!(refused(&FieldDesc::new(&spoiled, &indices)).contains("field 1: vertex 5 is not finite"));
    }
    for nodes in [0, 15, 257, u32::MAX] {
        assert!(refused(&good.with_nodes(nodes)).contains("nodes along the longest side"));
    }
    for margin in [-1.0, f32::NAN] {
        assert!(refused(&good.with_margin(margin)).contains("is negative or not finite"));
    }
    // Triangles that hang together nowhere.
    let mut random = Random::new(1);
    let loose: Vec<Vec3> = (0..6000).map(|_| random.vector()).collect();
    let each: Vec<u32> = (0..6000).collect();
    assert_eq!(
        refused(&FieldDesc::new(&loose, &each)),
        "field 1: 6000 edges are open, there may be 4096: the mesh is no body"
    );
}

/// Whatever a mesh is like, a field comes out whose distances are those of its triangles.
#[test]
fn meshes_that_are_hardly_bodies_have_fields() {
    let Some(mut backend) = gpu() else { return };
    let mut random = Random::new(2);
    let loose: Vec<Vec3> = (0..3000).map(|_| random.vector()).collect();
    let flat = (0..40).flat_map(|i| [Vec3::X * i as f32, Vec3::X * (i + 1) as f32, Vec3::Y]).collect::<Vec<_>>();
    let needle = vec![Vec3::ZERO, Vec3::new(7.0, 9.0, 8.0), Vec3::new(3.5, 4.5, 4.0)];
    let huge = vec![Vec3::ZERO, Vec3::X * 1e14, Vec3::Y * 1e14, Vec3::Z * 1e14];
    let far = ball(24).0.iter().map(|point| *point + Vec3::new(3e4, 0.0, 0.0)).collect();
    let cases: [(&str, Triangles); 8] = [
        ("loose triangles", (loose, (0..3000).collect())),
        ("a plane", (flat, (0..120).collect())),
        ("a needle", (needle, vec![0, 1, 2])),
        ("a point", (vec![Vec3::ONE; 3], vec![0, 1, 2])),
        ("huge", (huge, vec![0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3])),
        ("tiny", (ball(24).0.iter().map(|point| *point * 1e-6).collect(), ball(24).1)),
        ("far away", (far, ball(24).1)),
        ("damaged", damaged(torus(40, 0.7, 14, 0.23))),
    ];
    for (name, triangles) in cases {
        let field = field(&mut *backend, &triangles, 24);
        let solid = Solid::new(&triangles.0, &triangles.1);
        let (mut furthest, mut wrong) = (0.0f64, 0);
        for (node, distance) in field.distances.iter().enumerate().step_by(7) {
            let point = field.grid.origin + field.grid.cell * field.grid.node(node).as_dvec3();
            furthest = furthest.max((distance.abs() - solid.away(point)).abs() / field.grid.cell);
            let winding = solid.exact_winding(point);
            let is_sure = (winding - 0.5).abs() > 0.01 && distance.abs() > 0.02 * field.grid.cell;
            wrong += usize::from(is_sure && (winding > 0.5) != (*distance < 0.0));
        }
        println!("{name}: {furthest:.4} cells off, {wrong} wrong sides");
        // Loose triangles are smaller than cells and one behind the other: what the flood misses is more.
        assert!(furthest < 0.5 && wrong == 0, "{name}: {furthest} cells off, {wrong} wrong sides");
    }
}

#[test]
fn a_million_triangles_are_a_field() {
    let Some(mut backend) = gpu() else { return };
    let mesh = torus(1000, 0.7, 500, 0.23);
    assert_eq!(mesh.1.len(), 3_000_000);
    let field = field(&mut *backend, &mesh, 32);
    let exact = |point: DVec3| (point.x.hypot(point.z) - 0.7).hypot(point.y) - 0.23;
    let error = |(node, distance): (usize, &f64)| {
        let point = field.grid.origin + field.grid.cell * field.grid.node(node).as_dvec3();
        (distance - exact(point)).abs() / field.grid.cell
    };
    let furthest = field.distances.iter().enumerate().map(error).fold(0.0, f64::max);
    println!("{furthest} cells off");
    assert!(furthest < 0.15, "{furthest}");
}

/// Vertices that somebody else writes, without a look at them: the triangles of those that are no places are passed over.
#[test]
fn vertices_that_are_no_numbers_on_the_gpu_are_passed_over() {
    let Some(mut backend) = gpu() else { return };
    let (positions, indices) = ball(16);
    let mut list = PassList::new();
    let buffer = backend.create_buffer(&BufferDesc::storage("vertices", 20 * positions.len() as u64 + 8)).unwrap();
    let upload = |list: &mut PassList, positions: &[Vec3]| {
        let rows = positions.iter().flat_map(|point| [point.x, point.y, point.z, f32::NAN, 7.0]);
        list.upload(buffer, 8, &rows.collect::<Vec<f32>>());
    };
    let desc = FieldDesc::new(&positions, &indices).with_nodes(24);
    let of_buffer = desc.with_vertices(VertexBuffer { buffer, first: 2, stride: 5 });
    let mut fields = Fields::new(&mut *backend, &mut list, &[desc, of_buffer]).unwrap();
    let mut distances = Vec::new();
    for spoiled in [None, Some(f32::NAN), Some(f32::INFINITY), Some(1e20)] {
        let mut given = positions.clone();
        given[40].x = spoiled.unwrap_or(given[40].x);
        upload(&mut list, &given);
        fields.mark_changed(1).unwrap();
        fields.record(&mut list);
        let [_, values] = fields.read(&mut list, 1).unwrap();
        let [_, own] = fields.read(&mut list, 0).unwrap();
        backend.run(&list).unwrap();
        list.clear_commands();
        distances.push([values, own].map(|ticket| words(&mut *backend, ticket)));
    }
    let [[of_buffer, own], spoiled @ ..] = &distances[..] else { unreachable!() };
    assert!(of_buffer == own, "the same vertices in another layout");
    for [values, _] in spoiled {
        assert!(values.iter().all(|&word| f32::from_bits(word).is_finite()));
        let near = values
            .iter()
            .zip(own)
            .filter(|(one, other)| (f32::from_bits(**one) - f32::from_bits(**other)).abs() < 0.2)
            .count();
        assert!(near * 10 > own.len() * 9, "{near} of {} nodes are as before", own.len());
    }
    // None is left: nothing is near, and nothing is inside.
    upload(&mut list, &vec![Vec3::NAN; positions.len()]);
    fields.mark_changed(1).unwrap();
    fields.record(&mut list);
    let [_, values] = fields.read(&mut list, 1).unwrap();
    backend.run(&list).unwrap();
    assert!(words(&mut *backend, values).iter().all(|&word| f32::from_bits(word) == 1e10));
}

/// Raw Vulkan, under the eyes of the validation layer, and wgpu, twice.
#[test]
fn a_field_is_the_same_to_the_bit_on_both_backends() {
    let Some(mut wgpu) = gpu() else { return };
    let mesh = damaged(torus(40, 0.7, 14, 0.23));
    let first = field_words(&mut *wgpu, &mesh, 48);
    assert!(first == field_words(&mut *wgpu, &mesh, 48), "another run");
    let options = VulkanOptions { validation: true, ..Default::default() };
    let mut vulkan = VulkanBackend::headless_with(&options).unwrap();
    assert!(first == field_words(&mut vulkan, &mesh, 48), "another backend");
}

#[test]
fn a_mesh_that_has_not_changed_records_nothing() {
    let mut backend = NullBackend::default();
    let (positions, indices) = ball(8);
    let mut list = PassList::new();
    let desc = FieldDesc::new(&positions, &indices);
    let mut fields = Fields::new(&mut backend, &mut list, &[desc, desc.with_nodes(32)]).unwrap();
    let recorded = |fields: &mut Fields| {
        let mut list = PassList::new();
        fields.record(&mut list);
        list.labels().collect::<Vec<_>>()
    };
    let both = recorded(&mut fields);
    assert_eq!(both.iter().filter(|label| **label == "hair.sim.field_sign").count(), 2, "{both:?}");
    assert_eq!(both.iter().filter(|label| **label == "hair.sim.field_flood").count(), 7 + 6, "{both:?}");
    assert!(recorded(&mut fields).is_empty());
    let before = [fields.shape(0).unwrap(), fields.shape(1).unwrap()];
    fields.set_positions(&mut list, 1, &positions).unwrap();
    assert_eq!(recorded(&mut fields).len(), 12);
    assert_eq!(fields.shape(0), Ok(before[0]));
    assert_ne!(fields.shape(1), Ok(before[1]), "what sleeps on it wakes");
    assert!(recorded(&mut fields).is_empty());

    let wrong = [
        fields.set_positions(&mut list, 2, &positions).unwrap_err(),
        fields.set_positions(&mut list, 0, &positions[1..]).unwrap_err(),
        fields.set_positions(&mut list, 0, &vec![Vec3::NAN; positions.len()]).unwrap_err(),
        fields.mark_changed(9).unwrap_err(),
    ];
    let vertices = positions.len();
    assert_eq!(wrong[0], FieldError::NoField { index: 2, count: 2 });
    assert_eq!(wrong[1], FieldError::PositionCount { field: 0, given: vertices - 1, expected: vertices });
    assert_eq!(wrong[2], FieldError::NotFinite { field: 0, vertex: 0 });
    assert_eq!(wrong[3], FieldError::NoField { index: 9, count: 2 });
    // A mesh without holes has no kernel for them.
    let open = |backend: &NullBackend| {
        backend.shaders.iter().any(|shader| shader.slots.iter().any(|slot| slot.name == "open_edges"))
    };
    assert!(!open(&backend));
    Fields::new(&mut backend, &mut list, &[FieldDesc::new(&positions, &indices[..indices.len() / 2])]).unwrap();
    assert!(open(&backend));
}
