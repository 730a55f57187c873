//! Hair grown by maps: as many roots as they say, as far apart as they can be, lengths and directions, and what is refused.

use glam::{DVec3, Vec2, Vec3};
use tressfx_asset::character::read_bytes;
use tressfx_asset::grow::{Amount, Direction, GrowError, Growth, SkinPlace, SurfaceMap, grow, roots};
use tressfx_asset::mesh::skinned_obj;
use tressfx_core::asset::HairAsset;
use tressfx_core::body::SkinnedMesh;

/// A square of 2 by 2 in the plane y = 0 under all of a picture: x goes across it, z down it.
const SQUARE: &str =
    "v 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\nvt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\nf 1/1 3/3 2/2\nf 1/1 4/4 3/3\n";

fn square() -> SkinnedMesh {
    skinned_obj("square", SQUARE.as_bytes()).unwrap()
}

/// A picture of `size` by `size` texels from the density at their middles.
fn map(size: u32, density: impl Fn(f64, f64) -> f64) -> SurfaceMap {
    let at = |texel: u32| (f64::from(texel) + 0.5) / f64::from(size);
    let texels = (0..size * size).map(|texel| density(at(texel % size), at(texel / size)) as f32);
    SurfaceMap::new([size; 2], 1, texels.collect()).unwrap()
}

fn by_map(density_map: SurfaceMap, count: u32) -> Growth {
    Growth { amount: Amount::Count(count), density_map: Some(density_map), ..Growth::default() }
}

/// What share of the distance in the densest packing each place has to the others: between two of different density, of the mean of their distances.
fn spacing(places: &[SkinPlace], packed: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let mut sorted: Vec<(DVec3, f64)> = places.iter().map(|place| (place.position, packed(place.position))).collect();
    // Along an axis, so that what is far away along it need not be looked at.
    sorted.sort_by(|one, other| one.0.x.total_cmp(&other.0.x));
    let one = |(index, &(place, packed)): (usize, &(DVec3, f64))| {
        let mut share = f64::INFINITY;
        for side in [&mut sorted[index + 1..].iter() as &mut dyn Iterator<Item = _>, &mut sorted[..index].iter().rev()]
        {
            for (other, other_packed) in side.take_while(|(other, _)| (other.x - place.x).abs() < 2.0 * packed) {
                share = share.min(other.distance(place) / (0.5 * (packed + other_packed)));
            }
        }
        share
    };
    sorted.iter().enumerate().map(one).collect()
}

const COUNT: u32 = 20_000;

/// Which of the parts of a picture a place is in.
type Part<'a> = &'a dyn Fn(f64, f64) -> usize;

/// Sixteen squares.
fn square_part(x: f64, z: f64) -> usize {
    (z * 4.0) as usize * 4 + (x * 4.0) as usize
}

/// Grows by a density over the picture and holds the counts of parts to it, and the distances of roots to what their density allows.
fn follows(name: &str, size: u32, density: &dyn Fn(f64, f64) -> f64, parts: &[Part<'_>]) {
    let places = roots(&square(), &by_map(map(size, density), COUNT)).unwrap();
    assert_eq!(places.len(), COUNT as usize);
    let on_picture = |place: DVec3| (0.5 * place.x, 0.5 * place.z);
    // The integral over each part, by many samples.
    let at = |sample: u32| (f64::from(sample) + 0.5) / 512.0;
    let samples: Vec<(f64, f64)> = (0..512 * 512).map(|sample| (at(sample % 512), at(sample / 512))).collect();
    let mean = samples.iter().map(|&(x, z)| density(x, z)).sum::<f64>() / samples.len() as f64;
    let mut worst = 0.0;
    for part in parts {
        let (mut expected, mut found) = ([0.0; 16], [0.0; 16]);
        for &(x, z) in &samples {
            expected[part(x, z)] += density(x, z) / mean * f64::from(COUNT) / samples.len() as f64;
        }
        for place in &places {
            let (x, z) = on_picture(place.position);
            assert!(density(x, z) > 0.0, "{name}: a root at {}", place.position);
            found[part(x, z)] += 1.0;
        }
        let grown = found.iter().zip(expected).filter(|(_, expected)| *expected > 0.0);
        worst = grown.map(|(found, expected)| (found / expected - 1.0f64).abs()).fold(worst, f64::max);
    }
    // The distance in the densest packing of so many in a square unit.
    let packed = |place: DVec3| {
        let (x, z) = on_picture(place);
        (2.0 / (3f64.sqrt() * f64::from(COUNT) * density(x, z) / mean / 4.0)).sqrt()
    };
    let shares = spacing(&places, packed);
    let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    let percent = 100.0 * worst;
    println!("{name}: parts differ by {percent:.2} % at most; nearest at {least:.3} at least, {mean:.3} in the mean");
    assert!(worst < 0.03, "{name}: {worst}");
    assert!(least > 0.45 && mean > 0.7, "{name}: {least} {mean}");
}

#[test]
fn roots_follow_a_gradient() {
    follows("gradient", 256, &|x, _| 0.25 + 0.75 * x, &[&square_part]);
}

#[test]
fn roots_follow_a_checker() {
    // Hair is as dense as it must be in each square, of which there are two of each kind, and in all squares of a kind.
    let is_odd = |x: f64, z: f64| ((x * 8.0) as usize + (z * 8.0) as usize) % 2;
    follows("checker", 1024, &|x, z| [1.0, 0.25][is_odd(x, z)], &[&square_part, &is_odd]);
}

#[test]
fn nothing_grows_where_the_map_is_black() {
    // Between texels of hair and of none the map is neither: the part without hair begins there.
    let size = 1024;
    let edges = 0.25 - 0.5 / f64::from(size)..0.5 + 0.5 / f64::from(size);
    follows("black parts", size, &|x, _| if x > edges.start && x < edges.end { 1.0 } else { 0.0 }, &[&square_part]);
    // A spot of a hundredth of the area gets all that were asked for.
    let spot = by_map(map(200, |x, z| if (x - 0.5).abs().max((z - 0.5).abs()) < 0.05 { 0.1 } else { 0.0 }), 2000);
    let places = roots(&square(), &spot).unwrap();
    assert!(
        places.len() == 2000 && places.iter().all(|place| (place.position - DVec3::new(1.0, 0.0, 1.0)).length() < 0.16)
    );
    // Where hair would have no length, there is none, and a density counts what is left.
    let density = Growth {
        amount: Amount::Density(1000.0),
        length_map: Some(map(256, |x, _| f64::from(x > 0.25 && x < 0.75))),
        ..Growth::default()
    };
    let places = roots(&square(), &density).unwrap();
    assert!((places.len() as f64 / 2000.0 - 1.0).abs() < 0.01, "{}", places.len());
    assert!(places.iter().all(|place| (place.position.x - 1.0).abs() < 0.51));
    let half = Growth { density_map: Some(map(1, |_, _| 0.5)), ..density };
    assert!((roots(&square(), &half).unwrap().len() as f64 / 1000.0 - 1.0).abs() < 0.01);
}

fn strands(asset: &HairAsset) -> Vec<Vec<Vec3>> {
    asset.ranges().map(|range| asset.points[range].iter().map(|&point| point.into()).collect()).collect()
}

#[test]
fn lengths_are_those_of_the_map_and_roots_know_where_they_are() {
    let length_map = Some(map(256, |x, _| 0.1 + 0.9 * x));
    let growth = Growth { amount: Amount::Count(500), length: 0.5, length_map, variation: 0.0, ..Growth::default() };
    let asset = grow(&square(), &growth).unwrap();
    for (strand, uv) in strands(&asset).iter().zip(asset.strand_uvs.as_ref().unwrap()) {
        assert!(
            Vec2::from(*uv).distance(0.5 * Vec2::new(strand[0].x, strand[0].z)) < 1e-6,
            "the texture coordinates of the root"
        );
        let length: f32 = strand.windows(2).map(|edge| edge[0].distance(edge[1])).sum();
        let x = 0.5 * strand[0].x;
        // At the edges of the picture the other side shines in.
        let is_inside = (0.01..0.99).contains(&x);
        assert!(!is_inside || (length / (0.5 * (0.1 + 0.9 * x)) - 1.0).abs() < 2e-3, "{length} at {x}");
    }
}

/// The directions of the last edges under a map of one colour.
fn tips(mesh: &SkinnedMesh, color: [f32; 3]) -> Vec<Vec3> {
    let direction = Direction::Map(SurfaceMap::new([1, 1], 3, color.to_vec()).unwrap());
    let growth =
        Growth { amount: Amount::Count(100), vertices: 16, direction, lie: 1.0, noise: 0.0, ..Growth::default() };
    let strands = strands(&grow(mesh, &growth).unwrap());
    strands.iter().map(|strand| (strand[15] - strand[14]).normalize()).collect()
}

#[test]
fn directions_are_those_of_the_map_on_the_skin() {
    let mesh = square();
    // The picture mirrored, and turned by a right angle with parts that are stretched.
    let mirrored = SkinnedMesh { uvs: mesh.uvs.iter().map(|uv| Vec2::new(-uv.x, uv.y)).collect(), ..mesh.clone() };
    let turned = SkinnedMesh { uvs: mesh.uvs.iter().map(|uv| Vec2::new(7.0 * uv.y, uv.x)).collect(), ..mesh.clone() };
    let half = 0.5f32.sqrt();
    for (mesh, color, expected) in [
        (&mesh, [1.0, 0.5, 0.5], Vec3::X),
        (&mesh, [0.0, 0.5, 0.5], Vec3::NEG_X),
        (&mesh, [0.5, 1.0, 0.5], Vec3::Z),
        (&mesh, [0.5, 0.5, 1.0], Vec3::Y),
        (&mesh, [0.5, 0.5, 0.5], Vec3::Y),
        (&mesh, [1.0, 0.5, 1.0], Vec3::new(half, half, 0.0)),
        (&mesh, [1.0, 0.0, 0.5], Vec3::new(half, 0.0, -half)),
        (&mirrored, [1.0, 0.5, 0.5], Vec3::NEG_X),
        (&turned, [1.0, 0.5, 0.5], Vec3::Z),
        (&turned, [0.5, 1.0, 0.5], Vec3::X),
    ] {
        for tip in tips(mesh, color) {
            assert!(tip.distance(expected) < 0.05, "{color:?}: {tip}, not {expected}");
        }
    }
    // A weak vector bends less: half of a turn to the side is as far up as aside.
    let tip = tips(&mesh, [0.75, 0.5, 0.5])[0];
    assert!((tip.x / tip.y - 1.0).abs() < 0.05, "{tip}");
    // Triangles that have no area in the picture say nothing about directions, and hair stands.
    let folded = SkinnedMesh { uvs: vec![Vec2::splat(0.5); 4], ..mesh };
    assert!(tips(&folded, [1.0, 0.5, 0.5]).iter().all(|tip| tip.y > 0.99));
}

#[test]
fn maps_that_do_not_fit_are_refused() {
    let mesh = square();
    let gray = || map(2, |_, _| 1.0);
    let colors = || SurfaceMap::new([1, 1], 3, vec![0.5; 3]).unwrap();
    let growth = Growth { amount: Amount::Count(100), ..Growth::default() };
    for (wrong, name) in [
        (Growth { density_map: Some(colors()), ..growth.clone() }, "density"),
        (Growth { length_map: Some(colors()), ..growth.clone() }, "length"),
        (Growth { direction: Direction::Map(gray()), ..growth.clone() }, "direction"),
    ] {
        let error = grow(&mesh, &wrong).unwrap_err();
        assert!(matches!(error, GrowError::Channels { map, .. } if map == name), "{error}");
    }
    let black = Growth { density_map: Some(map(2, |_, _| 0.0)), ..growth.clone() };
    assert!(matches!(grow(&mesh, &black).unwrap_err(), GrowError::Bare { share: 0.0, .. }));
    // One texel of a million, and more strands than could be found there.
    let speck = Growth {
        amount: Amount::Count(2_000_000),
        density_map: Some(map(1000, |x, z| f64::from(x < 1e-3 && z < 1e-3))),
        ..growth.clone()
    };
    assert!(matches!(grow(&mesh, &speck).unwrap_err(), GrowError::Bare { .. }));
    let bare = SkinnedMesh { uvs: Vec::new(), ..mesh.clone() };
    for (wrong, name) in [
        (Growth { density_map: Some(gray()), ..growth.clone() }, "density"),
        (Growth { length_map: Some(gray()), ..growth.clone() }, "length"),
        (Growth { direction: Direction::Map(colors()), ..growth.clone() }, "direction"),
    ] {
        let error = grow(&bare, &wrong).unwrap_err();
        assert!(matches!(error, GrowError::NoTextureCoordinates { map, .. } if map == name), "{error}");
        assert!(error.to_string().starts_with("square has no texture coordinates"), "{error}");
    }
    let flat = SkinnedMesh { triangles: vec![[0, 0, 1]], ..mesh.clone() };
    assert!(matches!(grow(&flat, &growth).unwrap_err(), GrowError::Bare { .. }));
    let few = SkinnedMesh { uvs: vec![Vec2::ZERO; 3], ..mesh.clone() };
    assert!(grow(&few, &growth).unwrap_err().to_string().contains("3 texture coordinates, but must be 4"));
    let wild = SkinnedMesh { uvs: vec![Vec2::new(f32::NAN, 0.0); 4], ..mesh };
    assert!(grow(&wild, &growth).unwrap_err().to_string().contains("texture coordinate 0"));
}

#[test]
fn texture_coordinates_are_read_from_obj() {
    // Down the picture, as glTF has them; a vertex with two of them is two vertices.
    assert_eq!(square().uvs, [Vec2::ZERO, Vec2::ONE, Vec2::X, Vec2::Y]);
    let seam = SQUARE.replace("f 1/1 4/4 3/3", "f 1/2 4/4 3/3");
    assert_eq!(skinned_obj("seam", seam.as_bytes()).unwrap().positions.len(), 5);
    // Where a face has none, or the file, there are none.
    assert!(skinned_obj("part", SQUARE.replace("f 1/1 4/4 3/3", "f 1 4 3").as_bytes()).unwrap().uvs.is_empty());
    assert!(skinned_obj("none", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".as_bytes()).unwrap().uvs.is_empty());
    assert!(skinned_obj("nan", SQUARE.replace("vt 1 1", "vt nan 1").as_bytes()).is_err());
}

#[test]
fn texture_coordinates_are_read_from_gltf() {
    // A triangle: positions as floats, texture coordinates as bytes that stand for shares, and the same mesh without them.
    let mut data: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    data.extend([0, 255, 7, 7, 51, 0, 7, 7, 255, 255, 7, 7]);
    let uri = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &data);
    let text = |primitives: &str, count: u32| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":48,"uri":"data:application/octet-stream;base64,{uri}"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":12,"byteStride":4}}],
            "accessors":[{{"bufferView":0,"count":3,"type":"VEC3","componentType":5126,"min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"count":{count},"type":"VEC2","componentType":5121,"normalized":true}}],
            "meshes":[{{"primitives":[{primitives}]}}],"nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}]}}"#
        )
    };
    let with = r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1}}"#;
    let without = r#"{"attributes":{"POSITION":0}}"#;
    let read = |primitives: &str, count| read_bytes("f", text(primitives, count).as_bytes(), None);
    assert_eq!(read(with, 3).unwrap().mesh.uvs, [Vec2::Y, Vec2::new(0.2, 0.0), Vec2::ONE]);
    let both = read(&format!("{with},{with}"), 3).unwrap().mesh;
    assert_eq!((both.uvs.len(), both.positions.len()), (6, 6));
    for primitives in [without.to_owned(), format!("{with},{without}"), format!("{without},{with}")] {
        assert!(read(&primitives, 3).unwrap().mesh.uvs.is_empty(), "{primitives}");
    }
    let error = read(with, 2).unwrap_err().to_string();
    assert!(error.contains("mesh 0, primitive 0, texture coordinates"), "{error}");
}
