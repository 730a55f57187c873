//! The rules of the house that a compiler does not check: one word for one thing, and files that can be read.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

fn files(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "target" && name != "corpus" && !name.starts_with('.') {
            files(&path, endings, found);
        } else if endings.iter().any(|ending| name.ends_with(ending)) {
            found.push(path);
        }
    }
}

fn sources(endings: &[&str]) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    files(&root(), endings, &mut found);
    assert!(found.len() > 5, "{endings:?}: where are the sources?");
    found.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

#[test]
fn no_file_is_longer_than_500_lines() {
    for (path, text) in sources(&[".rs", ".wgsl"]) {
        let lines = text.lines().count();
        assert!(lines < 500, "{} has {lines} lines: split it by noun", path.display());
    }
}

#[test]
fn every_kernel_has_one_word_for_its_file_its_functions_and_its_label() {
    for (package, group) in [("tressfx-sim", "sim"), ("tressfx-render", "render")] {
        let folder = root().join(package);
        let kernels: Vec<_> = sources(&[".wgsl"])
            .into_iter()
            .filter(|(path, text)| path.starts_with(&folder) && text.contains("@compute"))
            .collect();
        assert!(kernels.len() >= 3, "{package} has its kernels");
        let rust: Vec<_> = sources(&[".rs"]).into_iter().filter(|(path, _)| path.starts_with(&folder)).collect();
        for (path, wgsl) in kernels {
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            assert!(wgsl.contains(&format!("fn {name}(")), "{}: the entry point has another name", path.display());
            let label = format!("\"hair.{group}.{name}\"");
            assert!(rust.iter().any(|(_, text)| text.contains(&label)), "{label} is nowhere in {package}");
            // What places and finds, and computes no picture, is held by a test of what it leaves in its buffers.
            let direct = [("tile_", "render_tiles.rs"), ("occlusion_", "render_occlusion.rs")];
            if let Some((_, test)) = direct.iter().find(|(prefix, _)| name.starts_with(prefix)) {
                let test = root().join("tests/tests").join(test);
                let text = fs::read_to_string(&test).unwrap_or_default();
                assert!(text.contains(&label), "{}: no direct test of {label}", test.display());
                continue;
            }
            let reference = folder.join("src/reference").join(format!("{name}.rs"));
            let text = fs::read_to_string(&reference).unwrap_or_default();
            assert!(text.contains(&format!("pub fn {name}")), "{}: no f64 reference", reference.display());
        }
    }
}

#[test]
fn the_tree_in_the_architecture_is_the_tree_on_the_disk() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let block = text.split("```").nth(1).expect("the first block of code is the tree");
    let mut named: Vec<&str> = block.lines().filter_map(|line| line.split_whitespace().next()).collect();
    let mut members: Vec<String> = fs::read_dir(root())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.join("Cargo.toml").exists())
        .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    named.sort_unstable();
    members.sort();
    assert_eq!(named, members);
}
