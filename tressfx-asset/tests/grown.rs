//! Hair grown on a mesh: even by area, far apart, the same each time.

use glam::{DVec3, Vec3};
use tressfx_asset::grow::{Amount, Direction, GrowError, Growth, SkinPlace, grow};
use tressfx_core::body::{Influences, SkinnedMesh};

/// A square of 2 by 2 in the plane y = 0 of triangles whose sizes differ by a factor of hundreds, and a far smaller one above it.
fn square() -> SkinnedMesh {
    let at = |i: u32| 2.0 * (i as f32 / 16.0).powi(3);
    let mut mesh = SkinnedMesh { name: "square".into(), joints: vec!["root".into()], ..SkinnedMesh::default() };
    for row in 0..=16 {
        mesh.positions.extend((0..=16).map(|column| Vec3::new(at(column), 0.0, at(row))));
    }
    for row in 0..16 {
        for column in 0..16 {
            let (corner, up) = (17 * row + column, 17 * row + column + 17);
            mesh.triangles.extend([[corner, up, corner + 1], [corner + 1, up, up + 1]]);
        }
    }
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([Vec3::Y, Vec3::Y + Vec3::Z * 0.5, Vec3::Y + Vec3::X * 0.5]);
    mesh.triangles.push([first, first + 1, first + 2]);
    mesh.normals = vec![Vec3::Y; mesh.positions.len()];
    mesh.influences = vec![Influences::rigid(0); mesh.positions.len()];
    mesh
}

fn roots(mesh: &SkinnedMesh, density: f64, seed: u64) -> Result<Vec<SkinPlace>, GrowError> {
    tressfx_asset::grow::roots(mesh, &Growth { amount: Amount::Density(density), seed, ..Growth::default() })
}

fn nearest(places: &[SkinPlace], of: usize) -> f64 {
    let others = places.iter().enumerate().filter(|&(other, _)| other != of);
    others.map(|(_, place)| place.position.distance(places[of].position)).fold(f64::INFINITY, f64::min)
}

#[test]
fn roots_are_even_by_area_and_far_apart() {
    let places = roots(&square(), 500.0, 3).unwrap();
    let area = 4.0f64 + 0.125;
    assert_eq!(places.len(), (500.0 * area).round() as usize);
    // Parts of the mesh have as many roots as their area asks for.
    let share =
        |is_in: &dyn Fn(DVec3) -> bool| places.iter().filter(|place| is_in(place.position)).count() as f64 / 500.0;
    let parts: [(f64, &dyn Fn(DVec3) -> bool); 6] = [
        (0.125, &|p| p.y > 0.5),
        (1.0, &|p| p.y < 0.5 && p.x < 1.0 && p.z < 1.0),
        (1.0, &|p| p.y < 0.5 && p.x > 1.0 && p.z > 1.0),
        (0.25, &|p| p.y < 0.5 && p.x < 0.5 && p.z < 0.5),
        (2.0, &|p| p.y < 0.5 && p.x < 1.0),
        (0.5, &|p| p.y < 0.5 && (0.75..1.0).contains(&p.x)),
    ];
    for (area, part) in parts {
        let found = share(part);
        // The edge of a part is a strip of the distance between roots, in which a root is here or there.
        assert!((found / area - 1.0).abs() < 0.06 + 0.012 / area, "{found} for an area of {area}");
    }
    // By chance the nearest of so many would be at half the mean distance for a fifth of them, and nearer than a fifth for one of 25.
    let radius = (area / (2.0 * 3f64.sqrt() * places.len() as f64)).sqrt();
    let distances: Vec<f64> = (0..places.len()).map(|place| nearest(&places, place) / (2.0 * radius)).collect();
    let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    println!("nearest roots: {least:.3} at least, {mean:.3} in the mean of what is possible");
    assert!(least > 0.5 && mean > 0.7, "{least} {mean}");
}

#[test]
fn two_sides_of_an_ear_take_no_room_from_each_other() {
    let mut mesh = square();
    let count = mesh.positions.len() as u32;
    let behind: Vec<_> = mesh.positions.iter().map(|position| *position - Vec3::Y * 1e-3).collect();
    mesh.positions.extend(behind);
    mesh.normals.extend(vec![Vec3::NEG_Y; count as usize]);
    mesh.influences.extend(vec![Influences::rigid(0); count as usize]);
    let back: Vec<_> = mesh.triangles.iter().map(|&[a, b, c]| [a + count, c + count, b + count]).collect();
    mesh.triangles.extend(back);
    let places = roots(&mesh, 200.0, 1).unwrap();
    let front = places.iter().filter(|place| place.normal.y > 0.0).count() as f64;
    assert!((front / places.len() as f64 - 0.5).abs() < 0.03, "{front} of {}", places.len());
}

#[test]
fn hair_does_not_part_at_the_edges_of_flat_triangles() {
    // A roof whose two sides have vertices and normals of their own.
    let slope = Vec3::new(0.6, 0.8, 0.0);
    let side = |sign: f32| [Vec3::ZERO, Vec3::Z, Vec3::new(sign * 0.8, -0.6, 0.0), Vec3::new(sign * 0.8, -0.6, 1.0)];
    let mesh = SkinnedMesh {
        name: "roof".into(),
        positions: [side(1.0), side(-1.0)].concat(),
        normals: [[slope; 4], [slope * Vec3::new(-1.0, 1.0, 1.0); 4]].concat(),
        triangles: vec![[0, 1, 2], [2, 1, 3], [4, 6, 5], [6, 7, 5]],
        joints: vec!["root".into()],
        influences: vec![Influences::rigid(0); 8],
        ..SkinnedMesh::default()
    };
    let places = roots(&mesh, 2000.0, 0).unwrap();
    let near_ridge: Vec<_> = places.iter().filter(|place| place.position.x.abs() < 0.03).collect();
    assert!(near_ridge.len() > 50 && near_ridge.iter().all(|place| place.normal.x.abs() < 0.05), "{near_ridge:?}");
    assert!(places.iter().filter(|place| place.position.x > 0.75).all(|place| place.normal.x > 0.5));
}

#[test]
fn strands_are_as_asked_for_and_the_same_each_time() {
    let growth = Growth {
        amount: Amount::Density(100.0),
        length: 0.3,
        direction: Direction::Comb(Vec3::X),
        ..Growth::default()
    };
    let asset = grow(&square(), &growth).unwrap();
    asset.check().unwrap();
    assert_eq!(asset.points, grow(&square(), &growth).unwrap().points);
    assert_ne!(asset.points, grow(&square(), &Growth { seed: 1, ..growth.clone() }).unwrap().points);
    for strand in asset.points.chunks(8) {
        let points: Vec<Vec3> = strand.iter().map(|&point| point.into()).collect();
        let length: f32 = points.windows(2).map(|edge| edge[0].distance(edge[1])).sum();
        assert!((0.24 - 1e-4..=0.3 + 1e-4).contains(&length), "{length}");
        let [first, last] = [points[1] - points[0], points[7] - points[6]].map(Vec3::normalize);
        assert!(
            first.y > 0.7 && last.x > 0.7 && last.y < first.y,
            "it leaves along the normal and is combed: {first} {last}"
        );
    }
    let mesh = square();
    for (wrong, name) in [
        (Growth { amount: Amount::Density(f64::NAN), ..growth.clone() }, "density"),
        (Growth { amount: Amount::Density(1e12), ..growth.clone() }, "density times the area of the mesh"),
        (Growth { amount: Amount::Density(1e-3), ..growth.clone() }, "density times the area of the mesh"),
        (Growth { length: 0.0, ..growth.clone() }, "length"),
        (Growth { lie: 1.5, ..growth.clone() }, "lie"),
        (Growth { vertices: 1, ..growth.clone() }, "vertices"),
        (Growth { direction: Direction::Comb(Vec3::NAN), ..growth.clone() }, "comb"),
    ] {
        match grow(&mesh, &wrong).unwrap_err() {
            GrowError::Number { name: found, .. } => assert_eq!(found, name),
            other => panic!("{other}"),
        }
    }
}
