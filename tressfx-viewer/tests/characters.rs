//! `tressfx grow`, `bind`, `info` and `render --character`, as they are typed.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A tetrahedron of the size of a head, in metres.
const BODY: &str =
    "v 0.1 0.1 0.1\nv 0.1 -0.1 -0.1\nv -0.1 0.1 -0.1\nv -0.1 -0.1 0.1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
/// The same body for the bones of strands.
const SKINNED: &str = "numOfBones 1\n0 head\nnumOfVertices 3\n0 0.1 0.1 0.1 0 1 0 0 0 0 0 1 0 0 0\n1 0.1 -0.1 -0.1 0 1 0 0 0 0 0 1 0 0 0\n\
                       2 -0.1 0.1 -0.1 0 1 0 0 0 0 0 1 0 0 0\nnumOfTriangles 1\n0 0 1 2\n";

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("characters").join(name);
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        fs::write(path.join("body.obj"), BODY).unwrap();
        fs::write(path.join("body.tfxmesh"), SKINNED).unwrap();
        Self(path)
    }

    fn tressfx(&self, words: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_tressfx")).current_dir(&self.0).args(words.split(' ')).output().unwrap()
    }

    /// What is printed.
    fn says(&self, words: &str) -> String {
        let output = self.tressfx(words);
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// What is printed as an error.
    fn refuses(&self, words: &str) -> String {
        let output = self.tressfx(words);
        assert!(!output.status.success(), "{words} was accepted");
        String::from_utf8(output.stderr).unwrap()
    }
}

#[test]
fn hair_that_was_grown_is_bound_where_it_grew() {
    let folder = Folder::new("grown");
    let said = folder.says("grow body.obj --density 5000 --length 0.03 --comb 0,-1,0 --out fur.tfx");
    // Four faces of sqrt(3) / 4 * 0.08 square metres each.
    assert!(said.starts_with("693 strands of 8 vertices"), "{said}");
    let said = folder.says("bind fur.tfx body.obj");
    assert!(said.contains("roots       693") && said.contains("median      0.000000 away"), "{said}");
    let error = folder.refuses("bind builtin:long:50 body.obj --within 0.001");
    assert!(error.contains("root of strand") && error.contains("body.obj"), "{error}");
    assert!(folder.refuses("grow body.obj --density 0 --length 1 --out x.tfx").contains("density is 0"));
    assert!(folder.refuses("grow body.obj --density 1e9 --length 1 --out x.tfx").contains("2 million"));
}

#[test]
fn hair_grows_by_pictures_over_a_body() {
    let folder = Folder::new("maps");
    let at = |name: &str| folder.0.join(name);
    // A square of 1 by 1, on whose right half hair grows.
    fs::write(
        at("square.obj"),
        "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nvt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\nf 1/1 3/3 2/2\nf 1/1 4/4 3/3\n",
    )
    .unwrap();
    let half = |x: u32| if (64..120).contains(&x) { 1.0 } else { 0.0f32 };
    image::GrayImage::from_fn(128, 2, |x, _| image::Luma([(255.0 * half(x)) as u8])).save(at("half.png")).unwrap();
    let deep = image::ImageBuffer::from_fn(1, 1, |_, _| image::Luma([32768u16]));
    deep.save(at("deep.png")).unwrap();
    image::RgbImage::from_pixel(1, 1, image::Rgb([255, 128, 128])).save(at("right.png")).unwrap();
    let words = "grow square.obj --guides 200 --density-map half.png --length 0.4 --length-map deep.png --variation 0 --noise 0";
    folder.says(&format!("{words} --direction-map right.png --lie 1 --out right.tfx"));
    let asset = tressfx_asset::read(at("right.tfx")).unwrap();
    assert_eq!(asset.strand_count(), 200);
    for strand in asset.ranges().map(|range| &asset.points[range]) {
        let (root, tip) = (glam::Vec3::from(strand[0]), glam::Vec3::from(strand[7]));
        assert!(root.x > 0.49 && root.x < 0.95 && tip.x > root.x + 0.1, "{root} {tip}");
        let length: f32 = strand.windows(2).map(|pair| glam::Vec3::from(pair[0]).distance(pair[1].into())).sum();
        assert!((length / 0.2 - 1.0).abs() < 1e-3, "16 bits of half the length are {length}");
    }
    for (more, says) in [
        ("--direction-map right.png --comb 1,0,0", "cannot be used with"),
        ("--density 5", "cannot be used with"),
        ("--clump 2", "--clump <0..1>"),
        ("--frizz 2", "--frizz <0..1>"),
        ("--clumps 500", "clumps is 500"),
        ("--curl-radius 0.1", "--curl-length <LENGTH>"),
        ("--curl-radius 0.1 --curl-length 0.01", "curl length is 0.01"),
        ("--direction-map square.obj", "square.obj"),
        ("--direction-map none.png", "none.png"),
    ] {
        let error = folder.refuses(&format!("{words} {more} --out x.tfx"));
        assert!(error.contains(says), "{more}: {error}");
    }
    let error = folder.refuses("grow body.obj --guides 9 --length 1 --density-map half.png --out x.tfx");
    assert!(error.contains("body.obj has no texture coordinates") && error.contains("density map"), "{error}");
    assert!(folder.refuses("grow body.obj --length 1 --out x.tfx").contains("--density <N>|--guides <N>"));
}

#[test]
fn files_of_characters_are_reported() {
    let folder = Folder::new("reported");
    let said = folder.says("info body.tfxmesh");
    assert!(said.contains("TfxMesh") && said.contains("triangles   1") && said.contains("joints      head"), "{said}");
    let json: serde_json::Value = serde_json::from_str(&folder.says("info body.tfxmesh --json")).unwrap();
    assert_eq!((&json[0]["vertices"], &json[0]["name"]), (&3.into(), &"body.tfxmesh".into()));
    fs::write(folder.0.join("cut.tfxmesh"), &SKINNED[..80]).unwrap();
    assert!(folder.refuses("info cut.tfxmesh").contains("vertex"));
    assert!(folder.refuses("info body.tfxmesh builtin:long:9").contains("it is no groom"));
}

#[test]
fn hair_is_drawn_on_a_body_and_what_does_not_fit_is_refused() {
    if std::env::var_os("TRESSFX_NO_GPU").is_some() {
        return;
    }
    let folder = Folder::new("drawn");
    folder.says("grow body.obj --density 5000 --length 0.03 --out fur.tfx");
    let passes = folder.says("render fur.tfx --character body.obj --frames 2 --size 64x64 --print-passes --out a.png");
    assert!(passes.contains("hair.sim.skin") && passes.contains("hair.sim.triangle_roots"), "{passes}");
    let bare = folder.says("render fur.tfx --frames 2 --size 64x64 --print-passes --out b.png");
    assert!(!bare.contains("hair.sim.skin") && !bare.contains("roots"), "{bare}");
    let error = folder.refuses("render fur.tfx --character body.obj --animation Walk --out a.png");
    assert!(error.contains("it has no animations"), "{error}");
    let error = folder.refuses("render builtin:long:50 --character body.tfxmesh --out a.png");
    assert!(error.contains("away from body.tfxmesh"), "{error}");
}
