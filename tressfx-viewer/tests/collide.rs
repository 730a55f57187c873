//! `--collide`: hair stays outside of the mesh that it is drawn with.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glam::{DVec3, Vec3};
use tressfx_asset::mesh::Mesh;
use tressfx_conformance::solid::Solid;

const GROOM: &str = "sintel_lite/GEO-sintel_hair_emit.002-sintel_hair.tfx";

fn tressfx(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tressfx")).args(words).output().unwrap()
}

/// A file to write.
fn temporary(name: &str) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("collide");
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name).to_string_lossy().into_owned()
}

/// The folder of assets; none, visibly, without it.
fn assets() -> Option<PathBuf> {
    let folder = std::env::var_os("TRESSFX_ASSETS").map(PathBuf::from);
    if folder.is_none() {
        tressfx_conformance::suite::say_skipped("Sintel", "TRESSFX_ASSETS is not set");
    }
    folder
}

/// How deep the deepest vertex is inside the mesh after some frames, when the motion is where it began (after 120 both are), as a share of the length of its
/// strand. Vertices that the file holds, roots and those next to them, do not count.
fn deepest(assets: &Path, solid: &Solid, motion: &str, solver: &str, collide: &str, frames: &str) -> f64 {
    let (groom, mesh) = (assets.join(GROOM), assets.join("sintel_lite/sintel.obj"));
    let out = temporary(&format!("{motion}-{solver}-{collide}.tfx"));
    let (groom, mesh) = (groom.to_string_lossy(), mesh.to_string_lossy());
    let words = ["simulate", &groom, "--mesh", &mesh, "--motion", motion, "--solver", solver, "--collide", collide];
    let done = tressfx(&[&words[..], &["--frames", frames, "--follow", "0", "--out", &out]].concat());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let pose = tressfx_asset::read(&out).unwrap();
    let masses = pose.inverse_mass.as_ref().unwrap();
    let (mut start, mut deepest) = (0, 0.0f64);
    for &count in &pose.counts {
        let range = start..start + count as usize;
        let points: Vec<DVec3> = pose.points[range.clone()].iter().map(|point| Vec3::from(*point).as_dvec3()).collect();
        let length: f64 = points.windows(2).map(|edge| edge[0].distance(edge[1])).sum();
        for (point, mass) in points.iter().zip(&masses[range.clone()]) {
            if *mass > 0.0 {
                deepest = deepest.max(-solid.distance(*point) / length);
            }
        }
        start = range.end;
    }
    deepest
}

#[test]
fn sintels_hair_stays_outside_of_her_bust() {
    let Some(assets) = assets() else { return };
    let mesh = Mesh::read(assets.join("sintel_lite/sintel.obj")).unwrap();
    let solid = Solid::new(&mesh.positions, &mesh.indices);
    for (solver, motion) in [("tressfx", "walk"), ("direct", "shake")] {
        let deepest = deepest(&assets, &solid, motion, solver, "sdf", "120");
        println!("{solver}, {motion}: deepest {deepest:.5} of the length of its strand");
        assert!(deepest < 0.01, "{solver}, {motion}: {deepest}");
    }
    let without = deepest(&assets, &solid, "walk", "tressfx", "none", "60");
    println!("walk, without: deepest {without:.5}");
    assert!(without > 0.02, "{without}: it is the field that holds it");
}

#[test]
fn what_is_collided_with_is_what_was_asked_for() {
    let passes = |words: &[&str]| {
        let out = temporary("passes.tfx");
        let words =
            [&["simulate", "builtin:long:60:8", "--frames", "1", "--print-passes", "--out", &out], words].concat();
        let done = tressfx(&words);
        assert!(done.status.success(), "{words:?}: {}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stdout).unwrap()
    };
    let [sdf, capsules, none] =
        ["sdf", "capsules", "none"].map(|collide| passes(&["--solver", "tressfx", "--collide", collide]));
    assert!(sdf.contains("hair.sim.field_sign") && sdf.contains("fields (read)"), "{sdf}");
    assert!(!sdf.contains("hair.sim.surface"), "nobody looks at it: {sdf}");
    assert!(!capsules.contains("field") && capsules.contains("colliders (read)"), "{capsules}");
    assert!(!none.contains("field") && !none.contains("colliders"), "{none}");
    assert_eq!(passes(&["--solver", "tressfx"]), capsules);

    let out = temporary("no-mesh.tfx");
    let groom = temporary("groom.tfx");
    assert!(tressfx(&["convert", "builtin:long:20:8", &groom]).status.success());
    let error = tressfx(&["simulate", &groom, "--collide", "sdf", "--out", &out]);
    let said = String::from_utf8_lossy(&error.stderr).into_owned();
    assert!(
        !error.status.success() && said.contains("there is no mesh to collide with; name one with --mesh"),
        "{said}"
    );
}

#[test]
fn the_field_of_a_body_is_made_anew_where_the_body_moves() {
    let Some(assets) = assets() else { return };
    let (fox, groom, out) = (assets.join("gltf_fox/Fox.glb"), temporary("fur.tfx"), temporary("walked.png"));
    let fox = fox.to_string_lossy();
    let grown = tressfx(&["grow", &fox, "--density", "0.02", "--length", "4", "--out", &groom]);
    assert!(grown.status.success(), "{}", String::from_utf8_lossy(&grown.stderr));
    let passes = |words: &[&str]| {
        let scene = ["render", &groom, "--character", &fox, "--collide", "sdf", "--solver", "tressfx", "--frames", "2"];
        let done = tressfx(&[&scene, &["--size", "64x64", "--print-passes", "--out", &out][..], words].concat());
        assert!(done.status.success(), "{words:?}: {}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stdout).unwrap()
    };
    let (still, walks) = (passes(&[]), passes(&["--animation", "Walk"]));
    assert!(still.contains("fields (read)") && !still.contains("hair.sim.field_sign"), "made once: {still}");
    assert!(walks.contains("hair.sim.skin") && walks.contains("hair.sim.field_sign"), "{walks}");
}

#[test]
fn a_field_is_drawn_in_place_of_its_mesh() {
    let render = |out: &str, words: &[&str]| {
        let scene = ["render", "builtin:long:40:8", "--frames", "0", "--size", "96x96", "--print-passes", "--out", out];
        let done = tressfx(&[&scene, words].concat());
        (done.status.success(), [done.stdout, done.stderr].map(|said| String::from_utf8(said).unwrap()))
    };
    let [of_field, of_mesh] = ["field.png", "mesh.png"].map(temporary);
    let (is_done, [passes, _]) = render(&of_field, &["--collide", "sdf", "--show", "sdf"]);
    assert!(is_done && passes.contains("hair.sim.field_sign") && passes.contains("hair.sim.surface_emit"), "{passes}");
    let (is_done, [passes, _]) = render(&of_mesh, &["--collide", "sdf"]);
    assert!(is_done && !passes.contains("hair.sim.surface"), "{passes}");
    // The field of a head looks as the head does, but not to the bit.
    let pictures = [of_field, of_mesh].map(|path| image::open(path).unwrap().to_rgb8());
    let off = pictures[0].iter().zip(pictures[1].iter()).map(|(one, other)| u64::from(one.abs_diff(*other)));
    let mean = off.sum::<u64>() as f64 / pictures[0].len() as f64;
    println!("off by {mean:.2} of 255 in the mean");
    assert!(mean > 0.0 && mean < 3.0, "{mean}");
    let (is_done, [_, said]) = render(&temporary("none.png"), &["--show", "sdf"]);
    assert!(!is_done && said.contains("--show sdf: there is no field; ask for one with --collide sdf"), "{said}");
}
