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
