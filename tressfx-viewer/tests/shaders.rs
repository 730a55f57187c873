//! `tressfx shaders`: every kernel in every language, and what the compilers of others say about it.

mod compilers;

use std::collections::{BTreeSet, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use serde_json::Value;

use crate::compilers::{Compiler, installed};

const LANGUAGES: &str = "wgsl,spirv,hlsl,msl,glsl,essl";

/// Without the shapes and without iterations, with hair against hair.
const BARE: &str = "[sim]\nglobal_stiffness = 0.0\nlocal_stiffness = 0.0\nlength_iterations = 0\n[volume]\n";

/// Rods with all that they may have, hair against hair too.
const RODS: &str = "[sim]\ninternal_damping = 0.001\npull_frequency = 1.0\n[volume]\n";

/// Strands that are drawn three times.
const COPIES: &str = "[material]\ncopies = 3\n";

/// What is typed after `tressfx shaders`, so that each feature is on once and off once, and each constant small and large.
const VARIANTS: [&[&str]; 29] = [
    &["builtin:long:40:8"],
    &["builtin:long:40:8", "--solver", "tressfx"],
    &["builtin:fur:40:3", "--solver", "tressfx", "--follow", "2", "--oit-k", "1", "--params", "bare.toml", "--fields"],
    &["pinned.tfx", "--solver", "tressfx", "--oit-k", "32", "--oit-tail", "unshaded"],
    &["--oit-k", "0", "--oit-tail", "none"],
    &["pinned.tfx", "--solver", "tressfx", "--params", "bare.toml"],
    &["--fill", "raster"],
    &["--oit-cap", "8"],
    &["--oit-cap", "2", "--fill", "raster", "--params", "copies.toml"],
    &["--oit", "shortcut", "--oit-k", "1"],
    &["--oit", "shortcut", "--oit-ordered", "--oit-k", "8"],
    &["--oit", "shortcut", "--oit-ordered", "--fill", "raster", "--params", "copies.toml"],
    &["pinned.tfx"],
    &["builtin:long:40:8", "--params", "rods.toml", "--fields"],
    &["builtin:long:40:8", "--params", "rods.toml", "--fields", "--for-cpu"],
    &["--oit-cap", "8", "--hair-output", "--own-colors"],
    &["--oit", "shortcut", "--hair-output", "--params", "copies.toml"],
    &["--oit", "tiles"],
    &["--oit", "tiles", "--composite", "compute", "--for-cpu"],
    &["--oit", "tiles", "--places", "4", "--hair-output", "--params", "copies.toml"],
    &["--oit", "tiles", "--places", "16", "--hair-output"],
    &["--oit", "tiles", "--places", "64", "--hair-output", "--for-cpu"],
    &["--oit", "ppll", "--places", "4", "--fill", "raster"],
    &["--oit", "ppll", "--places", "16", "--oit-cap", "8", "--hair-output"],
    &["--oit", "ppll", "--oit-tail", "weighted"],
    &["--oit", "ppll", "--skip-hidden", "true", "--for-least-limits"],
    &["--oit", "ppll", "--skip-hidden", "true", "--oit-cap", "8", "--fill", "raster", "--params", "copies.toml"],
    &["--oit", "shortcut", "--skip-hidden", "true"],
    &["--oit", "ppll", "--places", "64", "--oit-tail", "weighted", "--oit-cap", "8", "--hair-output"],
];

fn tressfx(folder: &Path, words: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_tressfx");
    Command::new(program).current_dir(folder).arg("shaders").args(words).output().unwrap()
}

/// A folder for a test, with the files that the variants name.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("shaders").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("bare.toml"), BARE).unwrap();
    fs::write(folder.join("rods.toml"), RODS).unwrap();
    fs::write(folder.join("copies.toml"), COPIES).unwrap();
    let convert = ["convert", "builtin:wavy:30:8", "pinned.tfx"];
    let done = Command::new(env!("CARGO_BIN_EXE_tressfx")).current_dir(&folder).args(convert).status().unwrap();
    assert!(done.success());
    // The inverse mass of the tip of the first strand: positions of 16 bytes lie behind a header of 160.
    let mut groom = fs::read(folder.join("pinned.tfx")).unwrap();
    groom[160 + 16 * 7 + 12..160 + 16 * 8].fill(0);
    fs::write(folder.join("pinned.tfx"), groom).unwrap();
    folder
}

/// The languages that the kernels of a variant can be written in: GLSL ES has no textures that are read and written at once.
fn languages(words: &[&str]) -> &'static str {
    if words.contains(&"--composite") { LANGUAGES.strip_suffix(",essl").expect("the last one") } else { LANGUAGES }
}

/// The kernels of a variant.
struct Written {
    words: &'static [&'static str],
    /// Where they are.
    folder: PathBuf,
    /// Their descriptions.
    entries: Vec<Value>,
}

/// All variants, written once for all tests.
static WRITTEN: LazyLock<Vec<Written>> = LazyLock::new(|| {
    let folder = folder("written");
    let write = |(number, words): (usize, &&'static [&'static str])| {
        let out = format!("out{number}");
        Written { words, entries: emit(&folder, words, &out), folder: folder.join(out) }
    };
    VARIANTS.iter().enumerate().map(write).collect()
});

/// Writes the kernels of a variant into a folder in another one, and reads their descriptions.
fn emit(folder: &Path, words: &[&str], out: &str) -> Vec<Value> {
    let output = tressfx(folder, &[words, &["--emit", languages(words), "--out", out]].concat());
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    let entries = fs::read(folder.join(out).join("bindings.json")).unwrap();
    serde_json::from_slice::<Value>(&entries).unwrap().as_array().unwrap().clone()
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_else(|| panic!("no text `{key}` in {value}"))
}

fn file_of(entry: &Value, language: &str) -> String {
    text(&entry["languages"][language], "file").to_owned()
}

#[test]
fn every_kernel_is_written_in_every_language_with_its_bindings() {
    let (mut labels, mut features) = (BTreeSet::new(), BTreeSet::new());
    for Written { words, folder, entries } in WRITTEN.iter() {
        let files: BTreeSet<_> = entries.iter().map(|entry| file_of(entry, "wgsl")).collect();
        assert_eq!(files.len(), entries.len(), "each entry point has a file of its own: {files:?}");
        for entry in entries {
            labels.insert(text(entry, "label").to_owned());
            features.extend(entry["features"].as_object().unwrap().iter().map(|(name, on)| format!("{name} {on}")));
            languages(words).split(',').for_each(|language| check_text(folder, entry, language));
        }
    }
    assert_eq!(labels, labels_of_kernels());
    let both = |name| [format!("{name} false"), format!("{name} true")];
    let names = [
        "bounded",
        "clump",
        "contacts",
        "copies",
        "ends_apart",
        "few_turns",
        "fibre",
        "fields",
        "follows",
        "global_shape",
        "hair_output",
        "internal_damping",
        "inverse_masses",
        "listed",
        "more_nodes",
        "morphs",
        "noise",
        "occluded",
        "open_edges",
        "ordered",
        "own_colors",
        "pinned_tips",
        "places",
        "pull",
        "push",
        "rods",
        "roots",
        "shaded",
        "shadows",
        "spline",
        "tangents",
        "together",
        "unshaded",
        "volume",
        "weighted",
    ];
    // It is always written for capsules.
    let all = names
        .into_iter()
        .flat_map(both)
        .chain(["capsules true", "colliders true", "half_floats true"].map(String::from));
    assert_eq!(features, all.collect());
}

/// Every binding stands in the text, with its name in the declaration that says where it is.
fn check_text(folder: &Path, entry: &Value, language: &str) {
    let file = file_of(entry, language);
    let code = fs::read(folder.join(&file)).unwrap();
    if language == "spirv" {
        assert_eq!(code[..4], 0x0723_0203_u32.to_ne_bytes(), "{file}");
        return;
    }
    let code = String::from_utf8(code).unwrap().replace("\nvar", " var");
    assert!(code.contains(&format!(" {}(", text(&entry["languages"][language], "entry_point"))), "{file}");
    let places = entry["bindings"].as_array().unwrap().iter().map(|binding| (binding, &binding["places"]));
    for (name, place) in places.map(|(binding, places)| (text(binding, "name"), text(places, language))) {
        let stands = |text: &String| text.contains(place) && text.contains(name);
        assert!(declarations(&code).iter().any(stands), "{file}: no declaration with `{name}` and `{place}`");
    }
    if let Some(extra) = entry["languages"][language].get("extra") {
        let stands = |line: &str| line.contains(text(extra, "name")) && line.contains(text(extra, "place"));
        assert!(code.lines().any(stands), "{file}: no line with {extra}");
    }
}

/// The lines of a text without comments. A block of GLSL, whose name follows its fields, is one line.
fn declarations(code: &str) -> Vec<String> {
    let mut found: Vec<String> = vec![];
    let mut in_block = false;
    for line in code.lines().filter(|line| !line.starts_with("//")) {
        match found.last_mut().filter(|_| in_block) {
            Some(block) => *block += line,
            None => found.push(line.to_owned()),
        }
        in_block = (in_block && !line.starts_with('}')) || (line.starts_with("layout(") && line.ends_with('{'));
    }
    found
}

/// The labels of all kernels there are: each is a WGSL file beside those that are imported.
fn labels_of_kernels() -> BTreeSet<String> {
    let mut labels = BTreeSet::new();
    let folders = [
        ("sim", "shaders"),
        ("render", "shaders"),
        ("render", "shaders/occlusion"),
        ("render", "shaders/ppll"),
        ("render", "shaders/shadow"),
        ("render", "shaders/shortcut"),
        ("render", "shaders/tiles"),
        ("render", "shaders/velocity"),
    ];
    for (group, folder) in folders {
        let folder = format!("{}/../tressfx-{group}/{folder}", env!("CARGO_MANIFEST_DIR"));
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file()) {
            let wgsl = fs::read_to_string(&path).unwrap();
            if wgsl.contains("@compute") || wgsl.contains("@fragment") {
                labels.insert(format!("hair.{group}.{}", path.file_stem().unwrap().to_string_lossy()));
            }
        }
    }
    labels
}

#[test]
fn compilers_take_every_kernel() {
    let compilers: Vec<_> = Compiler::ALL.into_iter().filter(|&compiler| installed(compiler)).collect();
    // Most kernels are the same in many variants.
    let mut seen = HashSet::new();
    for Written { words, folder, entries } in WRITTEN.iter() {
        for entry in entries {
            for &compiler in compilers.iter().filter(|compiler| !entry["languages"][compiler.language()].is_null()) {
                let code = fs::read(folder.join(file_of(entry, compiler.language()))).unwrap();
                if !seen.insert((compiler.language(), code)) {
                    continue;
                }
                compile(compiler, folder, entry).unwrap_or_else(|message| panic!("{words:?}: {message}"));
            }
        }
    }
}

fn compile(compiler: Compiler, folder: &Path, entry: &Value) -> Result<(), String> {
    let written = &entry["languages"][compiler.language()];
    let file = folder.join(text(written, "file"));
    compiler.compile(&file, text(entry, "stage"), text(written, "entry_point"))
}

#[test]
fn what_gl_es_cannot_do_is_said() {
    let folder = folder("es");
    let output = tressfx(&folder, &["--oit", "tiles", "--composite", "compute", "--emit", "essl", "--out", "out"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && message.contains("`picture`: GLSL ES reads and writes"), "{message}");
}

#[test]
fn compilers_refuse_a_broken_kernel() {
    let folder = folder("broken");
    let out = folder.join("out");
    for compiler in Compiler::ALL.into_iter().filter(|&compiler| installed(compiler)) {
        let entries = emit(&folder, &["--kernel", "hair.sim.tangents"], "out");
        let path = out.join(file_of(&entries[0], compiler.language()));
        let mut code = fs::read(&path).unwrap();
        match compiler.language() {
            // Its last instruction, the end of a function, goes.
            "spirv" => code.truncate(code.len() - 4),
            _ => code = String::from_utf8(code).unwrap().replace("normalize(", "normalise(").into_bytes(),
        }
        fs::write(&path, code).unwrap();
        let message = compile(compiler, &out, &entries[0]).expect_err(compiler.language());
        assert!(message.contains("hair.sim.tangents"), "{message}");
    }
}

#[test]
fn one_kernel_is_chosen_by_its_name() {
    let folder = folder("chosen");
    let entries = emit(&folder, &["builtin:fur:40:3", "--solver", "tressfx", "--kernel", "hair.sim.tressfx"], "out");
    let files: Vec<_> = entries.iter().map(|entry| file_of(entry, "hlsl")).collect();
    let expected = ["", ".roots"].map(|roots| format!("hair.sim.tressfx.capsules.global_shape{roots}.comp.hlsl"));
    assert_eq!(files, expected);
    assert_eq!(fs::read_dir(folder.join("out")).unwrap().count(), 2 * 6 + 1);
    let kernel = &entries[0];
    assert_eq!((&kernel["constants"]["LOCAL"], &kernel["constants"]["LENGTHS"]), (&2.into(), &2.into()));
    assert_eq!(kernel["workgroup_size"], serde_json::json!([64, 1, 1]));
    assert_eq!(kernel["bindings"][0]["places"]["hlsl"], "register(b0)");
    let step = kernel["structs"].as_array().unwrap().iter().find(|layout| layout["name"] == "Step").unwrap();
    assert_eq!(
        step["fields"][2],
        serde_json::json!({ "name": "center_displacement", "type": "vec3<f32>", "offset": 32 })
    );
    let output = tressfx(&folder, &["--solver", "tressfx", "--kernel", "hair.sim.tresfx", "--out", "none"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        message.contains("`hair.sim.tresfx`") && message.contains("hair.sim.tangents, hair.sim.tressfx"),
        "{message}"
    );
    assert!(!folder.join("none").exists());
}
