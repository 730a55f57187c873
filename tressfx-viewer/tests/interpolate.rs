//! `tressfx render --interpolate`, as it is typed.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

fn folder() -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("interpolate");
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn tressfx(words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tressfx")).current_dir(folder()).args(words.split(' ')).output().unwrap()
}

#[test]
fn both_backends_draw_the_same_strands_between_guides() {
    fs::write(folder().join("fur.toml"), "[interpolation]\nvertices = 9\nclump = 0.4\nnoise = 0.1\nshorter = 0.3\n")
        .unwrap();
    let output = tressfx(
        "render builtin:fur:300:5 --frames 3 --motion shake --interpolate 5000 --params fur.toml --size 160x120 --backend both --stats s.json --out p.png",
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    let picture = |name: &str| fs::read(folder().join(name)).unwrap();
    assert!(picture("p.wgpu.png") == picture("p.vulkan.png"), "{said}");
    let stats: serde_json::Value = serde_json::from_slice(&picture("s.vulkan.json")).unwrap();
    assert_eq!(stats["render"]["vertices"], 5000 * 9, "all strands are drawn, and no guide");
    assert!(stats["passes"].as_array().unwrap().iter().any(|pass| pass["label"] == "hair.sim.interpolate"), "{stats}");
}

#[test]
fn what_has_no_triangles_is_refused_by_name() {
    let output = tressfx("render builtin:fur:2:5 --frames 0 --interpolate 100 --size 64x64 --out none.png");
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && message.contains("between 2 guides there is no triangle"), "{message}");
    let output = tressfx("render builtin:fur:50:5 --interpolate 100 --follow 2 --out none.png");
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && message.contains("--follow"), "{message}");
}
