//! The chores themselves.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{compilers, driver, programs, validation};

/// Built-in grooms that the demo renders, and where the picture goes.
const DEMO: [(&str, &str); 2] = [("builtin:long", "long.png"), ("builtin:curly", "curly.png")];

/// Pictures of the documentation: what is typed after `tressfx render`, but for `--out`.
const PICTURES: [(&str, &str); 38] = [
    ("long.png", "builtin:long --motion turn --frames 90 --size 960x540"),
    ("straight.png", "builtin:straight --frames 60 --size 960x540"),
    ("wavy.png", "builtin:wavy --frames 60 --size 960x540"),
    ("curly.png", "builtin:curly --frames 60 --size 960x540"),
    ("fur.png", "builtin:fur --wind 3,0,0 --frames 60 --size 960x540"),
    (
        "animal.png",
        "builtin:animal --wind 2,0,1 --frames 60 --size 960x540 --camera 1.25,0.42,0.55,0,0.27,-0.06,30 --tone-map agx --exposure 0.7",
    ),
    ("beard.png", "builtin:beard --frames 30 --size 480x480"),
    ("lod-1-all.png", "builtin:long --frames 0 --size 480x480 --camera 0,-0.17,1.2,0,-0.17,0,26.79"),
    ("lod-2-all.png", "builtin:long --frames 0 --size 240x240 --camera 0,-0.17,2.4,0,-0.17,0,13.58"),
    ("lod-3-all.png", "builtin:long --frames 0 --size 120x120 --camera 0,-0.17,4.8,0,-0.17,0,6.815"),
    ("lod-4-all.png", "builtin:long --frames 0 --size 60x60 --camera 0,-0.17,9.6,0,-0.17,0,3.411"),
    ("lod-5-all.png", "builtin:long --frames 0 --size 30x30 --camera 0,-0.17,19.2,0,-0.17,0,1.706"),
    ("lod-1.png", "builtin:long --frames 0 --size 480x480 --camera 0,-0.17,1.2,0,-0.17,0,26.79 --lod"),
    ("lod-2.png", "builtin:long --frames 0 --size 240x240 --camera 0,-0.17,2.4,0,-0.17,0,13.58 --lod"),
    ("lod-3.png", "builtin:long --frames 0 --size 120x120 --camera 0,-0.17,4.8,0,-0.17,0,6.815 --lod"),
    ("lod-4.png", "builtin:long --frames 0 --size 60x60 --camera 0,-0.17,9.6,0,-0.17,0,3.411 --lod"),
    ("lod-5.png", "builtin:long --frames 0 --size 30x30 --camera 0,-0.17,19.2,0,-0.17,0,1.706 --lod"),
    ("between.png", "builtin:long:400:16 --frames 20 --motion shake --interpolate 16000 --size 500x400"),
    ("between-all.png", "builtin:long:16000:16 --frames 20 --motion shake --size 500x400"),
    ("copies-1.png", "builtin:wavy:300:24 --frames 20 --size 500x400"),
    ("copies-32.png", "builtin:wavy:300:24 --frames 20 --size 500x400 --params docs/copies.toml"),
    ("volume-none.png", "builtin:curly:700 --params docs/soft.toml --frames 50 --size 320x320"),
    ("volume.png", "builtin:curly:700 --params docs/soft.toml --frames 50 --size 320x320 --volume"),
    ("preset-baby.png", "builtin:straight:3000 --motion shake --frames 42 --size 320x320 --preset baby"),
    ("preset-medium.png", "builtin:straight:3000 --motion shake --frames 42 --size 320x320 --preset medium"),
    ("preset-sprayed.png", "builtin:straight:3000 --motion shake --frames 42 --size 320x320 --preset sprayed"),
    ("preset-mohawk.png", "builtin:straight:3000 --motion shake --frames 42 --size 320x320 --preset mohawk"),
    ("look-blond.png", "builtin:long --frames 0 --size 320x400 --look blond"),
    ("look-red.png", "builtin:long --frames 0 --size 320x400 --look red"),
    ("look-brown.png", "builtin:long --frames 0 --size 320x400 --look brown"),
    ("look-black.png", "builtin:long --frames 0 --size 320x400 --look black"),
    ("look-grey.png", "builtin:long --frames 0 --size 320x400 --look grey"),
    ("look-dyed.png", "builtin:long --frames 0 --size 320x400 --look dyed"),
    (
        "root-texture.png",
        "builtin:fur --frames 0 --size 400x400 --scattering fibre --root-texture docs/textures/spots.png",
    ),
    (
        "strand-texture.png",
        "builtin:long --frames 0 --size 320x400 --scattering fibre --strand-texture docs/textures/dyed-tips.png",
    ),
    // Whole periods of the motion, after the first.
    ("long-turn.gif", "builtin:long:2000 --follow 1 --motion turn --fps 20 --from 50 --frames 100 --size 256x256"),
    (
        "ponytail-shake.gif",
        "builtin:ponytail:4000 --follow 1 --motion shake --fps 24 --from 48 --frames 80 --size 300x300 --camera 0.75,0.12,-0.5,0,-0.04,0,30",
    ),
    (
        "mohawk-shake.gif",
        "TRESSFX_ASSETS/tressfx41_ratboy/Ratboy_mohawk.tfx --motion shake --fps 24 --from 48 --frames 80 --size 300x300",
    ),
];
/// Pictures of grooms that are grown for them: what is typed after `tressfx grow`, but for the fox and `--out`.
const GROWN: [(&str, &str); 3] = [
    (
        "grow-maps.png",
        "--guides 70000 --density-map docs/textures/fox-density.png --length 10 --length-map docs/textures/fox-length.png --vertices 6 --comb 0,-0.4,-1 --lie 0.85 --noise 0.2 --clumps 3000 --clump 0.5",
    ),
    (
        "grow-clumps.png",
        "--guides 60000 --density-map docs/textures/fox-density.png --length 9 --length-map docs/textures/fox-length.png --vertices 10 --comb 0,-1,-0.8 --lie 0.9 --noise 0.3 --frizz 0.1 --clumps 3000 --clump 0.9",
    ),
    (
        "grow-curls.png",
        "--guides 60000 --density-map docs/textures/fox-density.png --length 16 --length-map docs/textures/fox-length.png --vertices 48 --comb 0,-1,-0.2 --lie 0.8 --noise 0.2 --frizz 0.05 --clumps 1500 --clump 0.9 --curl-radius 1.2 --curl-length 4.5",
    ),
];
/// What is typed to render them.
const FOX_LOOK: &str = "--frames 0 --size 720x480 --camera 175,66,70,0,40,-11,36 --root-texture docs/textures/fox-colors.png --scattering fibre";
/// What they are grown on.
const FOX: &str = "TRESSFX_ASSETS/gltf_fox/Fox.glb";
/// Where real grooms are, in the words above and in the environment.
const ASSETS: &str = "TRESSFX_ASSETS";

/// Runs a command to its end.
pub(crate) fn run(command: &mut Command) -> Result<(), String> {
    let shown = format!("{command:?}").replace('"', "");
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{shown}: {status}")),
        Err(error) => Err(format!("{shown}: {error}")),
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace").to_owned()
}

fn cargo(words: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).args(words);
    command
}

fn step(words: &[&str]) -> Result<(), String> {
    println!("cargo {}", words.join(" "));
    run(&mut cargo(words))
}

/// Builds the program `tressfx` and says where it is.
fn tressfx(profile: &str) -> Result<PathBuf, String> {
    let flags: &[&str] = if profile == "release" { &["--release"] } else { &[] };
    step(&[&["build", "--package", "tressfx-viewer"], flags].concat())?;
    Ok(built(profile))
}

/// Where cargo leaves the program.
fn built(profile: &str) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    target.join(profile).join(format!("tressfx{}", std::env::consts::EXE_SUFFIX))
}

/// Renders the built-in grooms.
pub(crate) fn demo() -> Result<(), String> {
    let tressfx = tressfx("release")?;
    driver::ensure(&tressfx)?;
    let folder = root().join("out").join("demo");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for (groom, picture) in DEMO {
        let picture = folder.join(picture);
        println!("tressfx render {groom} --frames 60 --motion turn --out {}", picture.display());
        run(Command::new(&tressfx)
            .args(["render", groom, "--frames", "60", "--motion", "turn", "--out"])
            .arg(picture))?;
    }
    println!("The pictures are in {}", folder.display());
    Ok(())
}

/// Makes the pictures of the documentation anew; those of real grooms where they are.
pub(crate) fn docs() -> Result<(), String> {
    let tressfx = tressfx("release")?;
    driver::ensure(&tressfx)?;
    let folder = root().join("docs").join("pictures");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let folder = folder.display();
    for (picture, words) in PICTURES {
        typed(&tressfx, &format!("render {words} --out {folder}/{picture}"))?;
    }
    let out = root().join("out");
    std::fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let groom = out.join("grown.tfx");
    let groom = groom.display();
    for (picture, grow) in GROWN {
        typed(&tressfx, &format!("grow {FOX} {grow} --out {groom}"))?;
        typed(&tressfx, &format!("render {groom} --character {FOX} {FOX_LOOK} --out {folder}/{picture}"))?;
    }
    Ok(())
}

/// Runs the program with what would be typed after its name, unless it needs real grooms that are not there.
fn typed(tressfx: &Path, words: &str) -> Result<(), String> {
    println!("tressfx {words}");
    let assets = std::env::var(ASSETS);
    if words.contains(ASSETS) && assets.is_err() {
        println!("  left as it is: {ASSETS} is not set");
        return Ok(());
    }
    let words = words.split(' ').map(|word| word.replace(ASSETS, assets.as_deref().unwrap_or_default()));
    run(Command::new(tressfx).current_dir(root()).args(words))
}

/// Measures error against run time: of pictures, of the release program unless `--program` names one, or with `--motion` of solvers.
/// What measures are programs of their own: so xtask has no dependencies, and whoever wants the demo does not build what draws
/// plots.
pub(crate) fn accuracy(words: &[&str]) -> Result<(), String> {
    let given = words.iter().position(|word| *word == "--program").and_then(|at| words.get(at + 1));
    let program = given.map_or_else(|| tressfx("release"), |path| Ok(PathBuf::from(path)))?;
    if words.iter().all(|word| *word != "--help") {
        driver::ensure(&program)?;
    }
    let is_motion = words.contains(&"--motion");
    // The motion's references are simulated by the program that measures: it is built to be fast.
    let package: &[&str] = if is_motion { &["tressfx-motion", "--release"] } else { &["tressfx-accuracy"] };
    let mut command = cargo(&["run", "--quiet", "--package"]);
    command.args(package).arg("--").args(words.iter().filter(|word| **word != "--motion"));
    if given.is_none() && !is_motion {
        command.arg("--program").arg(program);
    }
    command.arg("--docs").arg(root().join("docs").join("accuracy"));
    run(command.arg("--work").arg(root().join("out").join("accuracy")))
}

/// Plays random and hostile cases.
pub(crate) fn stress(words: &[&str]) -> Result<(), String> {
    if words.iter().all(|word| *word != "--help") {
        driver::ensure(&tressfx("debug")?)?;
    }
    let mut command = cargo(&["run", "--quiet", "--package", "tressfx-stress", "--"]);
    command.args(words).arg("--docs").arg(root().join("docs"));
    run(command.arg("--work").arg(root().join("out").join("stress")))
}

/// Everything that a change must pass.
pub(crate) fn test() -> Result<(), String> {
    step(&["fmt", "--all", "--check"])?;
    step(&["clippy", "--workspace", "--all-targets", "--quiet", "--", "--deny", "warnings"])?;
    println!("cargo test --workspace");
    // With tests, dependencies have other features: the program `tressfx` is built with them, or it would be built once more.
    let programs = programs::build(&mut cargo(&[]))?;
    let tressfx = built("debug");
    driver::ensure(&tressfx)?;
    validation::ensure(&tressfx)?;
    compilers::ensure()?;
    // Tests that read real grooms are ignored unless the grooms are there.
    let ignored = std::env::var_os("TRESSFX_ASSETS").is_some().then_some("--include-ignored");
    let words: Vec<&str> = ["--quiet"].into_iter().chain(ignored).collect();
    programs::run(&programs, &words, &[("TRESSFX_SHADER_COMPILERS", "required")])?;
    step(&["test", "--workspace", "--doc", "--quiet"])?;
    println!("cargo doc --workspace --no-deps");
    run(cargo(&["doc", "--workspace", "--no-deps", "--quiet"]).env("RUSTDOCFLAGS", "--deny warnings"))
}
