//! Files of characters: what is in real ones, what bad ones get, and poses against what is known of them.

#[path = "support/assets.rs"]
mod assets;
#[path = "support/bodies.rs"]
mod bodies;
#[path = "support/memory.rs"]
mod memory;

use std::path::Path;
use std::time::{Duration, Instant};

use assets::folder;
use bodies::{SMALL_MESH, small_bones, small_gltf, small_skin};
use glam::{Affine3A, DVec3, Quat, Vec3, Vec4};
use tressfx_asset::character::{Character, read_bytes};
use tressfx_asset::pc2::PointCache;
use tressfx_asset::{FileError, FileKind, bones, pc2, tfxmesh, tfxskin};
use tressfx_core::body::{MeshPose, SkinnedMesh};

/// A reader that is fuzzed.
type Reader = fn(&[u8]) -> Result<(), FileError>;

/// Linear blend skinning in f64.
fn skinned(mesh: &SkinnedMesh, pose: &MeshPose) -> Vec<DVec3> {
    let mut positions: Vec<DVec3> = mesh.positions.iter().map(|position| position.as_dvec3()).collect();
    for (morph, &weight) in mesh.morphs.iter().zip(&pose.morphs) {
        for offset in &morph.offsets {
            positions[offset.vertex as usize] += offset.position.as_dvec3() * f64::from(weight);
        }
    }
    let by = |(position, of): (&DVec3, &tressfx_core::body::Influences)| {
        let parts = of.joints.iter().zip(of.weights);
        let part = |(&joint, weight): (&u32, f32)| {
            pose.joints[joint as usize].as_daffine3().transform_point3(*position) * f64::from(weight)
        };
        parts.map(part).sum::<DVec3>()
    };
    positions.iter().zip(&mesh.influences).map(by).collect()
}

fn bounds(points: &[DVec3]) -> [DVec3; 2] {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    [low, points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max)]
}

fn text(json: &str) -> Result<Character, FileError> {
    read_bytes("made", json.as_bytes(), None)
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn the_fox_has_its_joints_and_walks() {
    let fox = Character::read(folder().join("gltf_fox/Fox.glb")).unwrap();
    let names: Vec<_> = fox.animations.iter().map(|animation| animation.name.as_str()).collect();
    assert_eq!(names, ["Survey", "Walk", "Run"]);
    assert_eq!((fox.mesh.positions.len(), fox.mesh.triangles.len(), fox.mesh.joints.len()), (1728, 576, 24));
    assert_eq!((fox.normalised, fox.reduced, fox.mesh.uvs.len()), (0, 0, 1728));
    let seconds: Vec<_> = fox.animations.iter().map(|animation| animation.seconds).collect();
    println!("{seconds:?} s");
    assert!((seconds[0] - 3.416).abs() < 1e-2 && (seconds[1] - 0.708).abs() < 1e-2, "{seconds:?}");
    let walk = fox.animation("Walk").unwrap();
    let size = 155.0;
    let mut moved = 0.0f64;
    let (first, mut last) = (skinned(&fox.mesh, &fox.pose(Some(walk), 0.0)), Vec::new());
    for step in 0..=8 {
        last = skinned(&fox.mesh, &fox.pose(Some(walk), walk.seconds * f64::from(step) / 8.0));
        let [low, high] = bounds(&last);
        assert!((high - low).max_element() < 1.3 * size && low.y > -5.0 && high.y < 90.0, "{low} to {high}");
        moved = last.iter().zip(&first).map(|(a, b)| a.distance(*b)).fold(moved, f64::max);
    }
    println!("a vertex moves by up to {moved:.1} of {size}");
    assert!(moved > 0.05 * size, "it walks");
    let closed = last.iter().zip(&first).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(closed < 0.02 * size, "the walk ends as it begins: {closed}");
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn a_morphing_cube_reads_its_buffer_and_bends() {
    let path = folder().join("gltf_animatedmorphcube/AnimatedMorphCube.gltf");
    let cube = Character::read(&path).unwrap();
    assert_eq!((cube.mesh.positions.len(), cube.mesh.morphs.len(), cube.mesh.joints.len()), (24, 2, 1));
    let square = cube.animation("Square").unwrap();
    let weights: Vec<_> =
        (0..=40).map(|i| cube.pose(Some(square), square.seconds * f64::from(i) / 40.0).morphs).collect();
    assert!(weights.iter().all(|w| w.iter().all(|w| (-1e-6..=1.0 + 1e-6).contains(w))));
    assert!((0..2).all(|morph| weights.iter().any(|w| w[morph] > 0.9)), "{weights:?}");
    // Its node enlarges it a hundred times: what is shown is what hair is bound to.
    let [low, high] = bounds(&skinned(&cube.mesh, &cube.pose(None, 0.0)));
    let [low_bound, high_bound] = bounds(&skinned(&cube.mesh, &cube.mesh.bind_pose()));
    assert!(low.distance(low_bound) < 1e-6 && high.distance(high_bound) < 1e-6, "{low} {low_bound}");
    // Without a folder its buffer cannot be found.
    let error = read_bytes("cube", &std::fs::read(path).unwrap(), None).unwrap_err();
    assert!(error.to_string().contains("buffer 0"), "{error}");
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn the_smallest_skin_bends_at_its_joint() {
    let skin = Character::read(folder().join("gltf_simpleskin/SimpleSkin.gltf")).unwrap();
    assert_eq!((skin.mesh.positions.len(), skin.mesh.joints.len(), skin.animations.len()), (10, 2, 1));
    let bend = &skin.animations[0];
    // Its skeleton stands half a unit beside the mesh as it is stored.
    let beside = DVec3::new(-0.5, 0.0, 0.0);
    let at_rest = skinned(&skin.mesh, &skin.pose(None, 0.0));
    let bent = skinned(&skin.mesh, &skin.pose(Some(bend), 1.5));
    for ((stored, rest), point) in skin.mesh.positions.iter().zip(&at_rest).zip(&bent) {
        assert!(rest.distance(stored.as_dvec3() + beside) < 1e-6, "{stored} {rest}");
        // The foot has the first joint alone, the top the second, which has turned by more than a half of a right angle about the first.
        let (joint, top) = (DVec3::Y, stored.y > 1.9);
        assert!(stored.y > 0.1 || point.distance(*rest) < 1e-6, "{rest} {point}");
        assert!(!top || (point.distance(joint) - rest.distance(joint)).abs() < 1e-5, "{rest} {point}");
        assert!(!top || (*point - joint).angle_between(*rest - joint) > 0.7, "{rest} {point}");
    }
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn ratboy_has_bones_for_every_strand_and_a_skinned_body() {
    let at = |name: &str| std::fs::read(folder().join("tressfx41_ratboy").join(name)).unwrap();
    for (name, strands, normalised) in [("Ratboy_mohawk.tfxbone", 2228, None), ("Ratboy_short.tfxbone", 37747, Some(1))]
    {
        let data = at(name);
        assert_eq!(FileKind::of(&data), FileKind::StrandBones);
        let read = bones::read(name, &data).unwrap();
        assert_eq!((read.bones.len(), read.strands.len()), (105, strands), "{name}");
        println!("{name}: {} strands whose weights are made to sum to 1", read.normalised);
        assert!(normalised.is_none_or(|least| read.normalised >= least));
        let sums = read.strands.iter().map(|of| of.weights.iter().sum::<f32>());
        assert!(sums.map(|sum| (sum - 1.0).abs()).fold(0.0, f32::max) < 1e-6);
    }
    for (name, bones, vertices, triangles) in
        [("Ratboy_body.tfxmesh", 86, 12909, 25814), ("Ratboy_left_hand.tfxmesh", 16, 1247, 2490)]
    {
        let data = at(name);
        assert_eq!(FileKind::of(&data), FileKind::SkinnedMesh);
        let mesh = tfxmesh::read(name, &data).unwrap();
        assert_eq!((mesh.joints.len(), mesh.positions.len(), mesh.triangles.len()), (bones, vertices, triangles));
    }
    let mohawk = bones::read("mohawk", &at("Ratboy_mohawk.tfxbone")).unwrap();
    let error = mohawk.on_joints("mohawk", &["nobody".to_owned()]).unwrap_err().to_string();
    assert!(error.contains("strand 0") && error.contains("absent"), "{error}");
    assert_eq!(mohawk.on_joints("mohawk", &mohawk.bones).unwrap(), mohawk.strands);
}

#[test]
fn curves_of_each_kind_are_sampled_as_the_format_says() {
    let character = text(&small_gltf()).unwrap();
    let half = 0.5f32.sqrt();
    assert!(character.mesh.tangents[0].abs_diff_eq(Vec4::new(half, half, 0.0, 1.0), 1e-6), "of length 1");
    assert_eq!(character.mesh.tangents[1..], [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 1.0, 0.0, 1.0)]);
    let untold = text(&small_gltf().replace(r#","TANGENT":1"#, "")).unwrap();
    assert!(untold.mesh.tangents.is_empty());
    let all = character.animation("all").unwrap();
    assert_eq!(all.seconds, 1.0);
    // The skeleton is a hundred times the mesh: hair is bound to what is shown.
    assert_eq!(character.mesh.positions[1], Vec3::X * 100.0);
    assert_eq!(character.mesh.morphs[0].offsets[0].position, Vec3::Z * 200.0);
    assert_eq!(character.pose(None, 0.0).morphs, [0.5], "the weight of the file");
    let rest = character.pose(None, 0.0);
    assert!(rest.joints.iter().all(|joint| joint.abs_diff_eq(Affine3A::IDENTITY, 1e-6)), "{rest:?}");
    let pose = character.pose(Some(all), 0.25);
    let (_, rotation, translation) = pose.joints[1].to_scale_rotation_translation();
    // An eighth of a turn about z by slerp, and the Hermite polynomial from 0 to 1 with flat ends, in units of the parent.
    assert!(rotation.angle_between(Quat::from_rotation_z(std::f32::consts::FRAC_PI_4)) < 1e-3, "{rotation}");
    let share = 3.0 * 0.0625 - 2.0 * 0.015625;
    assert!((translation.x - 100.0 * share).abs() < 1e-3, "{translation}");
    assert_eq!(pose.morphs, [0.0], "a step stays");
    assert_eq!(character.pose(Some(all), 1.0).morphs, [1.0]);
    assert_eq!(character.pose(Some(all), 9.0), character.pose(Some(all), 1.0), "it stands still behind its end");
    assert_eq!(character.pose(Some(all), -9.0), character.pose(Some(all), 0.0));
}

#[test]
fn what_is_wrong_is_named() {
    let wrong = |from: &str, to: &str| {
        let made = small_gltf();
        assert!(made.contains(from), "{from}");
        text(&made.replacen(from, to, 1)).expect_err(to).to_string()
    };
    assert!(wrong(r#""children":[1]"#, r#""children":[0]"#).contains("children of themselves"));
    assert!(wrong(r#""joints":[0,1]"#, r#""joints":[0]"#).contains("weights of vertex 0"));
    assert!(wrong(r#""joints":[0,1]"#, r#""joints":[]"#).contains("skin 0"));
    assert!(wrong(r#""bufferView":1,"count":3"#, r#""bufferView":1,"count":4"#).contains("weights"));
    assert!(wrong(r#""bufferView":0,"count":3"#, r#""bufferView":0,"count":3000000000"#).contains("2^24 vertices"));
    assert!(wrong(r#""scale":[100,100,100]"#, r#""scale":[0,0,0]"#).contains("inverse bind matrices"));
    assert!(wrong("data:application/octet-stream;base64,", "../").contains("outside"));
    assert!(wrong(r#""2.0"}"#, r#""2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]"#).contains("draco"));
    let mut bad = small_bones();
    bad[38..42].copy_from_slice(&(-1i32).to_le_bytes());
    assert!(bones::read("b", &bad).unwrap_err().to_string().contains("bone 0 of strand 0 (byte 38): is -1"));
    bad = small_bones();
    bad[42..46].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(bones::read("b", &bad).unwrap_err().to_string().contains("weight 0 of strand 0 (byte 42)"));
    bad = small_bones();
    bad[42..46].fill(0);
    bad[50..54].fill(0);
    assert!(bones::read("b", &bad).unwrap_err().to_string().contains("a sum above 0"));
    bad = small_bones();
    bad[8] = 200;
    assert!(bones::read("b", &bad).unwrap_err().to_string().contains("name of bone 0"));
    bad = small_bones();
    bad[16] = b'x';
    assert!(bones::read("b", &bad).unwrap_err().to_string().contains("ended by a 0"));
    let read = bones::read("b", &small_bones()).unwrap();
    assert_eq!((read.normalised, read.strands[0].weights[0]), (1, 2.0 / 3.0));
    for (from, to, says) in [
        ("0 0 1 2", "0 0 1 3", "triangle 0"),
        ("0 0 1 2", "0 0 -1 2", "triangle 0"),
        ("1 1 0 0 0 0 1 0 0 0 0 0.5", "1 1 0 0 0 0 1 0 0 0 0 -1", "vertex 1"),
        ("1 1 0 0 0 0 1 0 0 0 0 0.5", "1 1 nan 0 0 0 1 0 0 0 0 0.5", "vertex 1"),
        ("1 1 0 0 0 0 1 0 0 0 0 0.5", "1 1 0 0 0 0 1 9 0 0 0 0.5", "vertex 1"),
        ("numOfTriangles 1", "numOfTriangles 2", "triangle 1"),
        ("numOfVertices 3", "numOfVertices 4000000000", "vertex 3"),
    ] {
        let error = tfxmesh::read("m", SMALL_MESH.replace(from, to).as_bytes()).expect_err(to).to_string();
        assert!(error.contains(says) && error.contains("line"), "{error}");
    }
    let skin = tfxskin::read("s", &small_skin()).unwrap();
    assert_eq!((skin.roots[0].triangle, skin.roots[0].barycentric), (7, [0.25, 0.0, 0.75]));
    let mut bad = small_skin();
    bad[276..280].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(tfxskin::read("s", &bad).unwrap_err().to_string().contains("strand 0"));
}

/// Such a file made the crate that reads JSON of glTF panic, which takes the chunk for another `.glb`.
#[test]
fn a_glb_whose_json_begins_as_a_glb_does_is_refused() {
    let inner = b"glTF\x02\0\0\0\0\0\0\0";
    let mut file = b"glTF".to_vec();
    for number in [2, 20 + inner.len() as u32, inner.len() as u32] {
        file.extend(number.to_le_bytes());
    }
    file.extend(b"JSON");
    file.extend(inner);
    let error = read_gltf(&file).unwrap_err().to_string();
    assert!(error.contains("JSON") && error.contains("expected value"), "{error}");
}

#[test]
fn a_point_cache_is_the_same_when_read_again() {
    let positions = (0..30).map(|i| Vec3::new(i as f32, -0.0, 1e-40 * i as f32)).collect();
    let cache = PointCache { points: 10, start_frame: 1.5, sample_rate: 0.5, positions };
    let bytes = pc2::to_bytes("cache", &cache).unwrap();
    let again = pc2::read("cache", &bytes).unwrap();
    assert_eq!((again.points, again.samples()), (10, 3));
    assert!(pc2::to_bytes("again", &again).unwrap() == bytes, "every bit is kept");
    assert_eq!(cache.at(1.75)[3].x, 8.0, "half-way");
    assert_eq!((cache.at(-9.0)[0].x, cache.at(f64::NAN)[0].x, cache.at(99.0)[9].x), (0.0, 0.0, 29.0));
    for (at, value) in [(16, 0u32), (28, u32::MAX), (16, 1 << 30), (12, 2), (24, 0)] {
        let mut bad = bytes.clone();
        bad[at..at + 4].copy_from_slice(&value.to_le_bytes());
        pc2::read("bad", &bad).expect_err("a wrong header");
    }
    assert!(pc2::to_bytes("odd", &PointCache { points: 7, ..cache }).is_err());
}

fn read_gltf(bytes: &[u8]) -> Result<(), FileError> {
    let character = read_bytes("fuzz", bytes, None)?;
    character.mesh.check().expect("a reader accepted it");
    for animation in &character.animations {
        let pose = character.pose(Some(animation), 0.4 * animation.seconds);
        assert_eq!((pose.joints.len(), pose.morphs.len()), (character.mesh.joints.len(), character.mesh.morphs.len()));
    }
    Ok(())
}

/// Changes files at random for some seconds: a reader gives an error or what it read, never a panic, nor much more memory than there are bytes.
fn mutate(name: &str, file: &[u8], reader: Reader) {
    reader(file).unwrap_or_else(|error| panic!("{name}: {error}"));
    let (mut seed, start, mut rounds, mut accepted) = (0x9e37_79b9_7f4a_7c15u64, Instant::now(), 0, 0);
    let mut next = move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed as usize
    };
    while start.elapsed() < Duration::from_millis(700) {
        let mut bytes = file.to_vec();
        for _ in 0..1 + next() % 4 {
            let at = next() % bytes.len();
            match next() % 5 {
                0 => bytes[at] ^= 1 << (next() % 8),
                1 => bytes[at] = next() as u8,
                2 => bytes.truncate(at.max(1)),
                3 => drop(bytes.remove(at)),
                _ => {
                    let value = [0, u32::MAX, 1 << 31, 0x7fc0_0000, 0x7f80_0000][next() % 5].to_le_bytes();
                    let end = (at + 4).min(bytes.len());
                    bytes[at..end].copy_from_slice(&value[..end - at]);
                }
            }
            if bytes.is_empty() {
                bytes.push(0);
            }
        }
        let _ = FileKind::of(&bytes);
        let peak = memory::peak_of(|| accepted += usize::from(reader(&bytes).is_ok()));
        assert!(peak < 256 * bytes.len() + (1 << 20), "{name}: {peak} bytes for a file of {}", bytes.len());
        rounds += 1;
    }
    println!("{name}: {rounds} files, {accepted} accepted");
    assert!(rounds > 20, "{name}: only {rounds}");
}

#[test]
fn changed_files_are_read_or_refused() {
    for (name, files) in bodies::all() {
        let reader: Reader = match name {
            "gltf" => read_gltf,
            "tfxbone" => |bytes| bones::read("fuzz", bytes).map(drop),
            "tfxmesh" => |bytes| tfxmesh::read("fuzz", bytes).map(drop),
            "tfxskin" => |bytes| tfxskin::read("fuzz", bytes).map(drop),
            "pc2" => |bytes| pc2::read("fuzz", bytes).map(drop),
            other => panic!("{other} has no reader here"),
        };
        files.iter().for_each(|file| mutate(name, file, reader));
    }
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn changed_real_files_are_read_or_refused() {
    let read = |name: &str| std::fs::read(folder().join(name)).unwrap();
    mutate("Fox.glb", &read("gltf_fox/Fox.glb"), read_gltf);
    mutate("SimpleSkin.gltf", &read("gltf_simpleskin/SimpleSkin.gltf"), read_gltf);
    let bone_file = read("tressfx41_ratboy/Ratboy_mohawk.tfxbone");
    mutate("mohawk.tfxbone", &bone_file, |bytes| bones::read("fuzz", bytes).map(drop));
    let hand = read("tressfx41_ratboy/Ratboy_left_hand.tfxmesh");
    mutate("left_hand.tfxmesh", &hand, |bytes| tfxmesh::read("fuzz", bytes).map(drop));
    assert!(Path::new(&folder()).is_dir());
}
