//! Meshes: read from files, and made.

#[path = "support/assets.rs"]
mod assets;

use glam::Vec3;
use tressfx_asset::builtin::{Builtin, Style};
use tressfx_asset::mesh::{Mesh, MeshError};
use tressfx_core::shape::{Capsule, Ellipsoid};

const QUAD: &str = "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/// Every triangle that has an area turns its front to where its vertices' normals point.
fn faces_outwards(mesh: &Mesh) -> bool {
    mesh.indices.as_chunks::<3>().0.iter().all(|triangle| {
        let [a, b, c] = triangle.map(|index| mesh.positions[index as usize]);
        let normal = triangle.iter().map(|&index| mesh.normals[index as usize]).sum::<Vec3>();
        let face = (b - a).cross(c - a);
        face.length() < 1e-6 || face.dot(normal) > 0.0
    })
}

#[test]
fn polygons_are_triangulated_and_get_normals() {
    let mesh = Mesh::from_obj("quad", QUAD.as_bytes()).expect("sound");
    assert_eq!((mesh.positions.len(), mesh.indices.len()), (4, 6));
    assert_eq!(mesh.normals, [Vec3::Z; 4]);
}

#[test]
fn objects_are_joined_and_given_normals_kept() {
    let second = "o b\nv 0 0 5\nv 1 0 5\nv 0 1 5\nvn 0 0 -2\nf 5//1 6//1 7//1\n";
    let mesh = Mesh::from_obj("two", format!("{QUAD}{second}").as_bytes()).expect("sound");
    assert_eq!((mesh.positions.len(), mesh.indices.len()), (7, 9));
    assert_eq!(mesh.normals[6], Vec3::NEG_Z);
    assert!(mesh.indices.iter().all(|&index| index < 7));
}

#[test]
fn what_is_no_mesh_is_refused_with_the_file_named() {
    let read = |text: &str| Mesh::from_obj("bad.obj", text.as_bytes()).expect_err("no mesh");
    assert!(matches!(read("v 0 0 0\n"), MeshError::Empty { .. }));
    assert!(matches!(read("v 0 0 0\nf 1 2 9\n"), MeshError::Obj { .. }));
    assert!(matches!(read("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), MeshError::NotFinite { vertex: 0, .. }));
    assert!(read("v x y z\n").to_string().contains("bad.obj"));
    assert!(matches!(Mesh::read("no/such/file.obj"), Err(MeshError::Io { .. })));
}

#[test]
fn primitives_lie_on_their_solids_and_face_outwards() {
    let ellipsoid = Ellipsoid { center: Vec3::new(1.0, 2.0, 3.0), radii: Vec3::new(0.5, 1.0, 2.0) };
    let mesh = Mesh::ellipsoid(&ellipsoid, 24);
    assert!(mesh.positions.iter().all(|&p| (ellipsoid.level(p) - 1.0).abs() < 1e-5));
    assert!(faces_outwards(&mesh));

    let capsule = Capsule { a: Vec3::ZERO, b: Vec3::new(3.0, 0.0, 0.0), radius_a: 0.5, radius_b: 0.75 };
    let mesh = Mesh::capsule(&capsule, 24);
    assert!(mesh.positions.iter().all(|&p| capsule.distance(p).abs() < 0.1));
    assert!(faces_outwards(&mesh));
    assert!(mesh.bounds().max.x > 3.7 && mesh.bounds().min.x < -0.45);
}

#[test]
fn capsules_of_an_ellipsoid_stay_inside_of_it() {
    for style in [Style::Long, Style::Fur] {
        let head = Builtin::from(style).head().expect("a head");
        for capsule in head.inscribed_capsules() {
            let mesh = Mesh::capsule(&capsule, 64);
            assert!(mesh.positions.iter().all(|&p| head.level(p) < 1.0 + 1e-5), "{capsule:?}");
        }
        assert!(faces_outwards(&Builtin::from(style).mesh()));
    }
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn real_meshes_are_read() {
    let folder = assets::folder();
    let path = folder.join("sintel_lite/sintel.obj");
    let mesh = Mesh::read(path).expect("a bust");
    assert!(mesh.indices.len() >= 3 * 5952 && mesh.positions.len() >= 3046);
    assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4));
}
