//! Meshes that tests of fields share.
#![allow(dead_code, reason = "each test takes what it needs")]

use std::path::PathBuf;

use glam::Vec3;
use tressfx_asset::mesh::Mesh;
use tressfx_core::shape::Ellipsoid;

/// Positions and indices.
pub(crate) type Triangles = (Vec<Vec3>, Vec<u32>);

/// A ball of a metre or so.
pub(crate) fn ball(segments: u32) -> Triangles {
    let mesh = Mesh::ellipsoid(&Ellipsoid { center: Vec3::new(0.3, -0.2, 0.1), radii: Vec3::splat(0.9) }, segments);
    (mesh.positions, mesh.indices)
}

/// A ring about y with these radii.
pub(crate) fn torus(around: u32, radius: f32, tube: u32, tube_radius: f32) -> Triangles {
    let angle = |index: u32, count: u32| std::f32::consts::TAU * (index % count) as f32 / count as f32;
    let vertex = |i: u32, j: u32| {
        let (u, v) = (angle(i, around), angle(j, tube));
        let out = radius + tube_radius * v.cos();
        Vec3::new(out * u.cos(), tube_radius * v.sin(), out * u.sin())
    };
    let positions = (0..around).flat_map(|i| (0..tube).map(move |j| vertex(i, j))).collect();
    let index = |i: u32, j: u32| i % around * tube + j % tube;
    let face = |i: u32, j: u32| {
        let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
        [a, b, c, a, c, d]
    };
    (positions, (0..around).flat_map(|i| (0..tube).flat_map(move |j| face(i, j))).collect())
}

/// A file of the folder that TRESSFX_ASSETS names; `None`, visibly, without it.
pub(crate) fn asset(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("TRESSFX_ASSETS").map(PathBuf::from);
    if folder.is_none() {
        tressfx_conformance::suite::say_skipped(path, "TRESSFX_ASSETS is not set");
    }
    Some(folder?.join(path))
}

/// The bust that Sintel's hair grows on: it is open below and where the eyes are.
pub(crate) fn bust() -> Option<Triangles> {
    let mesh = Mesh::read(asset("sintel_lite/sintel.obj")?).expect("the mesh reads");
    Some((mesh.positions, mesh.indices))
}

/// The body of AMD's Ratboy: its rows of vertices and triangles.
pub(crate) fn body() -> Option<Triangles> {
    let text = std::fs::read_to_string(asset("tressfx41_ratboy/Ratboy_body.tfxmesh")?).expect("the mesh is there");
    let rows = |heading: &str| {
        let lines = text.lines().skip_while(|line| !line.starts_with(heading)).skip(1);
        let rows = lines
            .skip_while(|line| line.starts_with('#'))
            .take_while(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        rows.map(|line| line.split_whitespace().skip(1).take(3).map(str::to_owned).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    };
    let number = |word: &String| word.parse::<f32>().expect("a number");
    let vertices =
        rows("numOfVertices").iter().map(|row| Vec3::new(number(&row[0]), number(&row[1]), number(&row[2]))).collect();
    let indices = rows("numOfTriangles").iter().flatten().map(|word| word.parse().expect("an index")).collect();
    Some((vertices, indices))
}
