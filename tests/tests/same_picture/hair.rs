//! The grooms of the scenes, by name, in metres about the origin.

use std::collections::HashMap;
use std::f32::consts::TAU;

use glam::Vec3;
use tressfx_asset::builtin::Builtin;
use tressfx_conformance::render::{Groom, Random};
use tressfx_core::asset::HairAsset;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_render::{Lod, Material};

/// What of each groom a scene takes is made once.
#[derive(Default)]
pub(crate) struct Grooms(HashMap<&'static str, Groom>);

impl Grooms {
    pub(crate) fn of(&mut self, names: &[&'static str]) -> Vec<Groom> {
        names.iter().map(|name| self.0.entry(name).or_insert_with(|| made(name)).clone()).collect()
    }
}

fn made(name: &str) -> Groom {
    let material = Material::default();
    let mut groom = match name {
        "loose" => Groom::wavy(40, 12, 1, material),
        "dense" => Groom::wavy(1200, 12, 3, material),
        "some" => Groom { lod: Lod { share: 0.2511, step: 5 }, ..Groom::wavy(1200, 12, 3, material) },
        "other" => Groom::wavy(60, 9, 8, material),
        "one strand" => Groom::wavy(1, 24, 2, material),
        "two vertices" => Groom::new(&lines(200, |from, to| vec![from, to]), material),
        "most vertices" => Groom::new(&lines(6, |from, to| (0..256).map(|i| coil(from, to, i)).collect()), material),
        "one depth" => Groom::new(&grid(), material),
        "towards the eye" => Groom::new(&lines(120, |from, _| vec![from, from + 1.5 * Vec3::Z]), material),
        "points" => Groom::new(&lines(50, |from, _| vec![from; 4]), material),
        builtin => return grown(builtin, material),
    };
    groom.info.fitting_radius = 0.003;
    groom
}

/// Random pairs of points in a cube.
fn lines(count: u32, strand: impl Fn(Vec3, Vec3) -> Vec<Vec3>) -> Vec<Vec<Vec3>> {
    let mut random = Random(count);
    let mut point = || 1.2 * Vec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5);
    (0..count).map(|_| strand(point(), point())).collect()
}

/// A vertex of 256.
fn coil(from: Vec3, to: Vec3, i: u32) -> Vec3 {
    let along = i as f32 / 255.0;
    let (sin, cos) = (6.0 * TAU * along).sin_cos();
    from.lerp(to, along) + 0.1 * Vec3::new(sin, 0.0, cos)
}

/// Strands that cross in one plane.
fn grid() -> Vec<Vec<Vec3>> {
    let at = |i: i32| i as f32 / 12.0 - 0.5;
    let across = (0..13).map(|i| (0..4).map(|v| Vec3::new(v as f32 / 3.0 - 0.5, at(i), 0.0)).collect());
    let down = (0..13).map(|i| (0..4).map(|v| Vec3::new(at(i), 0.5 - v as f32 / 3.0, 0.0)).collect());
    across.chain(down).collect()
}

/// Colours, opacities and widths that differ from vertex to vertex.
fn colour(asset: &mut HairAsset) {
    let mut random = Random(4);
    let mut some = || [(); 4].map(|()| random.unit());
    asset.vertex_colors = Some(asset.points.iter().map(|_| some()).collect());
    asset.vertex_thickness = Some(asset.points.iter().map(|_| 3.0 * some()[0]).collect());
}

/// A built-in groom, `NAME:strands:vertices`, about the middle of it; with ` coloured` behind it, it brings a look along; with `+2` behind that two strands follow
/// each guide.
fn grown(name: &str, material: Material) -> Groom {
    let (name, follows) = name.split_once('+').unwrap_or((name, "0"));
    let (name, brings_along) = name.strip_suffix(" coloured").map_or((name, false), |name| (name, true));
    let mut asset = Builtin::parse(name).expect("a built-in groom").asset();
    if brings_along {
        colour(&mut asset);
    }
    let follows = Some(follows.parse().expect("a number"));
    let strands = Strands::new(&asset, &StrandOptions { follows, ..StrandOptions::default() }).expect("strands");
    Groom::of(&strands, material)
}
