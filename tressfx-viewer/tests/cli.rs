//! The program as its users call it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A folder of its own for each test, in cargo's folder for such things.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn tressfx(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tressfx")).current_dir(folder).args(words).output().unwrap()
}

fn passes(folder: &Path, words: &[&str]) -> String {
    let output = tressfx(folder, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The message of a call that must fail, and its exit code.
fn fails(folder: &Path, words: &[&str]) -> (String, i32) {
    let output = tressfx(folder, words);
    assert!(!output.status.success(), "{words:?} must fail");
    (String::from_utf8(output.stderr).unwrap(), output.status.code().unwrap())
}

const SMALL: [&str; 6] = ["builtin:wavy:60:12", "--frames", "8", "--motion", "shake", "--wind=2,0,1"];

fn render(folder: &Path, extra: &[&str]) -> String {
    passes(folder, &[&["render"], &SMALL[..], &["--size", "160x90"], extra].concat())
}

#[test]
fn info_says_what_is_there_as_text_and_as_json() {
    let folder = folder("info");
    let text = passes(&folder, &["info", "builtin:fur:70:5"]);
    assert!(text.contains("strands    70") && text.contains("vertices   350 (5 a strand"), "{text}");
    let json: Value = serde_json::from_str(&passes(&folder, &["info", "--json", "builtin:fur:70:5"])).unwrap();
    assert_eq!((&json[0]["strands"], &json[0]["vertices"]), (&70.into(), &350.into()));
}

#[test]
fn convert_goes_there_and_back_without_a_change() {
    let folder = folder("convert");
    passes(&folder, &["convert", "builtin:curly:30:16", "a.tfx"]);
    passes(&folder, &["convert", "a.tfx", "b.txt"]);
    passes(&folder, &["convert", "b.txt", "c.txt"]);
    passes(&folder, &["convert", "a.tfx", "d.tfx"]);
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert!(read("a.tfx") == read("d.tfx"));
    assert!(read("b.txt") == read("c.txt"));
    let (message, _) = fails(&folder, &["convert", "a.tfx", "a.fbx"]);
    assert!(message.contains(".tfx or .txt"), "{message}");
}

#[test]
fn bad_files_are_refused_with_file_place_and_field() {
    let folder = folder("bad_files");
    passes(&folder, &["convert", "builtin:curly:30:16", "whole.tfx"]);
    let whole = std::fs::read(folder.join("whole.tfx")).unwrap();
    std::fs::write(folder.join("cut.tfx"), &whole[..whole.len() / 2]).unwrap();
    let (message, code) = fails(&folder, &["info", "cut.tfx"]);
    assert!(message.contains("cut.tfx: positions (byte 160)"), "{message}");
    assert_eq!(code, 1);
    std::fs::write(folder.join("noise.tfx"), b"\x89PNG nothing of the kind").unwrap();
    assert!(fails(&folder, &["render", "noise.tfx", "--out", "x.png"]).0.contains("noise.tfx"));
    assert!(fails(&folder, &["info", "absent.tfx"]).0.contains("absent.tfx"));
}

#[test]
fn a_run_that_fails_leaves_the_pictures_as_they_were() {
    let folder = folder("no_picture");
    std::fs::write(folder.join("noise.tfx"), b"\x89PNG nothing of the kind").unwrap();
    std::fs::write(folder.join("earlier.png"), b"a picture").unwrap();
    for name in ["earlier.png", "never.png"] {
        fails(&folder, &["render", "noise.tfx", "--out", name]);
    }
    assert_eq!(std::fs::read(folder.join("earlier.png")).unwrap(), b"a picture");
    assert!(!folder.join("never.png").exists());
}

#[test]
fn bad_words_are_refused_by_name() {
    let folder = folder("bad_words");
    let words = |extra: &[&str]| fails(&folder, &[&["render", "builtin:fur:10:4", "--out", "x.png"], extra].concat());
    assert!(words(&["--size", "0x9"]).0.contains("between 1 and 16384"));
    assert_eq!(words(&["--camera", "1,2"]).1, 2);
    assert!(words(&["--adapter", "no such thing"]).0.contains("no adapter is named `no such thing`"));
    std::fs::write(folder.join("bad.toml"), "[sim]\ndamping = 7.0\n").unwrap();
    let (message, _) = words(&["--params", "bad.toml"]);
    assert!(message.contains("bad.toml") && message.contains("damping"), "{message}");
    assert!(words(&["--oit-k", "33"]).0.contains("--oit-k 33: it must be from 0 to 32"));
    assert!(words(&["--oit", "shortcut", "--oit-k", "9"]).0.contains("--oit-k 9: it must be from 1 to 8"));
    assert!(words(&["--oit", "tiles", "--oit-tail", "none"]).0.contains("--oit-tail belongs to --oit ppll"));
    assert!(words(&["--oit", "auto", "--oit-k", "33"]).0.contains("--oit-k 33: it must be from 0 to 32"));
    assert!(words(&["--oit-ordered"]).0.contains("--oit shortcut"));
    assert!(words(&["--oit", "shortcut", "--places", "4"]).0.contains("--places belongs to --oit ppll, --oit tiles"));
    assert!(words(&["--oit", "tiles", "--places", "2"]).0.contains("--places 2: it must be 1, 4, 16 or 64"));
    assert!(fails(&folder, &["render", "builtin:wig", "--out", "x.png"]).0.contains("wig"));
    assert!(fails(&folder, &["render", "builtin:fur:10:4", "--out", "x.bmp"]).0.contains(".png"));
}

#[test]
fn depth_and_coverage_are_pictures_of_their_own() {
    let folder = folder("outputs");
    let outputs = ["--depth-out", "depth.png", "--coverage-out", "coverage.png"];
    render(&folder, &["--out", "plain.png"]);
    for (technique, also) in [("ppll", "--out=a.png"), ("shortcut", "--out=b.png"), ("tiles", "--out=c.png")] {
        let text = render(&folder, &[&outputs[..], &["--oit", technique, also]].concat());
        assert!(text.contains("depth.png: distance from the eye") && text.contains("is 65535"), "{text}");
        let open = |name: &str| image::open(folder.join(name)).unwrap().into_luma16();
        let (depth, coverage) = (open("depth.png"), open("coverage.png"));
        assert_eq!((depth.dimensions(), coverage.dimensions()), ((160, 90), (160, 90)));
        let hair = depth.pixels().filter(|pixel| pixel[0] >= 4096).count();
        assert_eq!(hair, coverage.pixels().filter(|pixel| pixel[0] > 0).count(), "{technique}");
        assert!(hair > 300 && depth.pixels().filter(|pixel| pixel[0] == 65_535).count() >= 1, "{technique}: {hair}");
    }
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert!(read("a.png") == read("plain.png"), "the picture is the same");
    let both = [&["render", "builtin:fur:10:4", "--out", "x.png", "--reference"], &outputs[..2]].concat();
    let (message, code) = fails(&folder, &both);
    assert!(code == 2 && message.contains("--depth-out"), "{message}");
}

#[test]
fn motion_is_a_picture_of_its_own() {
    let folder = folder("motion");
    render(&folder, &["--out", "plain.png"]);
    let text = render(&folder, &["--out", "a.png", "--velocity-out", "motion.png"]);
    assert!(text.contains("motion.png: motion since the frame before") && text.contains("65535 is"), "{text}");
    let motion = image::open(folder.join("motion.png")).unwrap().into_rgb16();
    let hair = motion.pixels().filter(|pixel| pixel.0 != [0; 3]).count();
    let moved = motion.pixels().filter(|pixel| pixel[0].abs_diff(32_768) > 3000).count();
    assert!(hair > 300 && moved > 100, "{hair} pixels with hair, {moved} that move");
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert!(read("a.png") == read("plain.png"), "the picture is the same");
}

#[test]
fn what_finds_no_room_is_said_and_is_an_error_if_asked_for() {
    let folder = folder("no_room");
    let words = |extra: &[&str]| {
        let common = ["render", "builtin:long:400", "--frames", "1", "--size", "160x90", "--out", "x.png"];
        common.iter().chain(extra).map(|word| (*word).to_owned()).collect::<Vec<_>>()
    };
    let drawn = |extra: &[&str]| {
        let words = words(&[extra, &["--stats", "x.json"]].concat());
        passes(&folder, &words.iter().map(String::as_str).collect::<Vec<_>>());
        let stats: Value = serde_json::from_slice(&std::fs::read(folder.join("x.json")).unwrap()).unwrap();
        ["fragments", "dropped", "merged"].map(|key| stats["render"][key].as_u64().unwrap())
    };
    let [fragments, ..] = drawn(&["--strict"]);
    assert_eq!(drawn(&["--strict", "--oit-cap", "2"]), [fragments, 0, 0], "nobody asked for more");
    let [all, dropped, merged] = drawn(&["--oit-bytes", "16000"]);
    assert!((all, dropped) == (fragments, 0) && merged > 0, "{all}, {dropped}, {merged}");
    let strict = words(&["--oit-bytes", "16000", "--strict"]);
    let (message, _) = fails(&folder, &strict.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(message.contains("were merged: hair is there"), "{message}");
}

#[test]
fn the_same_command_gives_the_same_picture_and_the_same_pose() {
    let folder = folder("twice");
    for name in ["a", "b"] {
        render(&folder, &["--out", &format!("{name}.png")]);
        let pose = format!("{name}.tfx");
        passes(&folder, &[&["simulate"], &SMALL[..], &["--follow", "2", "--all", "--out", &pose]].concat());
    }
    let same = |a: &str, b: &str| std::fs::read(folder.join(a)).unwrap() == std::fs::read(folder.join(b)).unwrap();
    assert!(same("a.png", "b.png"));
    assert!(same("a.tfx", "b.tfx"));
    let text = passes(&folder, &["info", "a.tfx"]);
    assert!(text.contains("strands    180"), "guides and two follow strands each: {text}");
}

#[test]
fn figures_have_their_keys_and_sensible_values() {
    let folder = folder("stats");
    let table = render(&folder, &["--out", "frames/", "--stats", "s.json", "--print-passes"]);
    for label in ["hair.sim.direct", "hair.render.fill", "hair.render.composite"] {
        assert!(table.contains(label), "{table}");
    }
    assert_eq!(std::fs::read_dir(folder.join("frames")).unwrap().count(), 8);
    let stats: Value = serde_json::from_slice(&std::fs::read(folder.join("s.json")).unwrap()).unwrap();
    assert_eq!((&stats["groom"]["strands"], &stats["groom"]["vertices"]), (&60.into(), &720.into()));
    assert_eq!((&stats["frames"], &stats["backend"]), (&8.into(), &"wgpu".into()));
    assert_eq!((&stats["sim"]["non_finite"], &stats["sim"]["resets"]), (&0.into(), &0.into()));
    assert!(stats["sim"]["max_edge_error"].as_f64().unwrap() < 1e-4, "{}", stats["sim"]);
    // Edges of the published method stretch.
    render(&folder, &["--out", "other.png", "--solver", "tressfx", "--stats", "other.json"]);
    let other: Value = serde_json::from_slice(&std::fs::read(folder.join("other.json")).unwrap()).unwrap();
    let stretched = other["sim"]["rms_edge_error"].as_f64().unwrap();
    assert!((1e-3..0.3).contains(&stretched), "{stretched}");
    assert_eq!(stats["render"]["dropped"], 0);
    for key in ["fragments", "pixels_with_hair", "peak_gpu_bytes", "oit_bytes"] {
        assert!(stats["render"][key].as_u64().unwrap() > 100, "{key}: {stats}");
    }
    for pass in stats["passes"].as_array().unwrap() {
        let figure = |key: &str| pass[key].as_f64().unwrap();
        assert!(figure("min_ms") <= figure("median_ms"), "{pass}");
        assert!(figure("frames") >= 1.0 && figure("frames") <= figure("runs"), "{pass}");
        assert!((figure("passes_per_frame") * figure("frames") / figure("runs") - 1.0).abs() < 1e-9, "{pass}");
    }
}

#[test]
fn each_technique_draws_the_hair_and_says_what_it_takes() {
    let folder = folder("techniques");
    let shown = |name: &str, words: &[&str], labels: &[&str]| {
        let (picture, figures) = (format!("{name}.png"), format!("{name}.json"));
        let table = render(&folder, &[&["--out", &picture, "--stats", &figures, "--print-passes"], words].concat());
        assert!(labels.iter().all(|label| table.contains(label)), "{table}");
        let stats: Value = serde_json::from_slice(&std::fs::read(folder.join(figures)).unwrap()).unwrap();
        (std::fs::read(folder.join(picture)).unwrap(), stats["render"].clone())
    };
    let (compute, lists) = shown("compute", &[], &["hair.render.fill ", "hair.render.resolve"]);
    let (raster, _) = shown("raster", &["--fill", "raster"], &["hair.render.fill_raster", "hair.render.resolve"]);
    assert!(compute == raster, "the fill makes no difference");
    let three = ["hair.render.shortcut_depths", "hair.render.shortcut_colors", "hair.render.shortcut_resolve"];
    for (k, ordered, bytes) in [(3, false, 32), (8, false, 52), (3, true, 48), (8, true, 108)] {
        let mut words = vec!["--oit", "shortcut", "--oit-k", if k == 3 { "3" } else { "8" }];
        words.extend(ordered.then_some("--oit-ordered"));
        let (picture, render) = shown("shortcut", &words, &three);
        words.extend(["--fill", "raster"]);
        let by_raster = ["hair.render.shortcut_depths_raster", "hair.render.shortcut_colors_raster"];
        let (raster, _) = shown("raster", &words, &by_raster);
        assert!(picture == raster, "the fill makes no difference");
        for key in ["fragments", "pixels_with_hair", "dropped"] {
            assert_eq!(render[key], lists[key], "{key}");
        }
        let [width, height] = [160, 90u64];
        // Eight bytes a pixel are those of whole tiles.
        let tiles = (8 * 64 + 8) * width.div_ceil(8) * height.div_ceil(8);
        // Of one view; and the arguments of the draw over the tiles.
        let counters = 32 + 16;
        assert_eq!(render["oit_bytes"].as_u64(), Some((bytes - 8) * width * height + tiles + counters), "{words:?}");
        let flip = flip_to_lists(&folder, "shortcut.png");
        assert!(flip < 0.03, "{words:?}: FLIP {flip} to the lists");
    }
}

/// FLIP between a picture and that of the lists.
fn flip_to_lists(folder: &Path, picture: &str) -> f64 {
    let json: Value = serde_json::from_str(&passes(folder, &["compare", "compute.png", picture, "--json"])).unwrap();
    json["flip_mean"].as_f64().unwrap()
}

#[test]
fn animations_hold_every_frame() {
    let folder = folder("animation");
    render(&folder, &["--out", "a.gif"]);
    render(&folder, &["--out", "a.apng"]);
    let gif = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(std::fs::read(folder.join("a.gif")).unwrap()));
    let frames = image::AnimationDecoder::into_frames(gif.unwrap()).collect_frames().unwrap();
    assert_eq!(frames.len(), 4, "a GIF shows every second of 60 frames a second");
    render(&folder, &["--out", "late.apng", "--from", "5"]);
    let late = png::Decoder::new(std::io::Cursor::new(std::fs::read(folder.join("late.apng")).unwrap()));
    assert_eq!(late.read_info().unwrap().info().animation_control().unwrap().num_frames, 3);
    let (message, _) = fails(&folder, &[&["render"], &SMALL[..], &["--out", "a.gif", "--from", "8"]].concat());
    assert!(message.contains("--from 8: frames are from 0 to 7"), "{message}");
    let apng = png::Decoder::new(std::io::Cursor::new(std::fs::read(folder.join("a.apng")).unwrap()));
    let reader = apng.read_info().unwrap();
    assert_eq!(reader.info().animation_control().unwrap().num_frames, 8);
}

#[test]
fn without_frames_the_rest_pose_is_drawn_and_written() {
    let folder = folder("rest");
    let rest = ["builtin:wavy:60:12", "--frames", "0", "--motion", "shake"];
    let out = ["--size", "160x90", "--out", "a.png", "--stats", "a.json"];
    passes(&folder, &[&["render"], &rest[..], &out].concat());
    let stats: Value = serde_json::from_slice(&std::fs::read(folder.join("a.json")).unwrap()).unwrap();
    assert_eq!(stats["frames"], 0);
    assert!(stats["render"]["pixels_with_hair"].as_u64().unwrap() > 100, "{stats}");
    assert!(stats["sim"]["max_edge_error"].as_f64().unwrap() < 1e-5, "{stats}");
    passes(&folder, &[&["simulate"], &rest[..], &["--out", "a.tfx"]].concat());
    passes(&folder, &["convert", "builtin:wavy:60:12", "b.tfx"]);
    let [a, b] = ["a.tfx", "b.tfx"].map(|name| tressfx_asset::read(folder.join(name)).unwrap());
    let far = a.points.iter().zip(&b.points).map(|(a, b)| glam::Vec3::from(*a).distance((*b).into()));
    assert!(a.points.len() == b.points.len() && far.fold(0.0, f32::max) < 1e-6);
}

#[test]
fn the_reference_draws_the_same_frame() {
    let folder = folder("reference");
    render(&folder, &["--out", "a.png"]);
    let reference = ["--reference", "--samples", "16", "--reference-light", "given"];
    let said = render(&folder, &[&["--out", "b.png", "--stats", "b.json"], &reference[..]].concat());
    assert!(said.contains("16 samples a pixel") && said.contains("RMS"), "{said}");
    let stats: Value = serde_json::from_slice(&std::fs::read(folder.join("b.json")).unwrap()).unwrap();
    let figures = &stats["render"]["reference"];
    assert_eq!((&figures["samples"], &figures["shadow_rays"]), (&16.into(), &0.into()));
    assert!(figures["rms_error"].as_f64().unwrap() < 0.02, "{figures}");
    let compared: Value = serde_json::from_str(&passes(&folder, &["compare", "a.png", "b.png", "--json"])).unwrap();
    assert!(compared["psnr_db"].as_f64().unwrap() > 35.0, "the same hair: {compared}");
    let differing = compared["differing_share"].as_f64().unwrap();
    assert!(differing > 0.001 && differing < 0.5, "by another method: {compared}");
    let refused = |extra: &[&str]| fails(&folder, &[&["render"], &SMALL[..], extra].concat()).0;
    assert!(refused(&["--out", "c.png", "--fibre-spacing", "4"]).contains("--reference"));
    assert!(refused(&["--out", "c.png", "--samples", "4"]).contains("--reference"));
    assert!(refused(&["--out", "c.png", "--reference-light", "given"]).contains("--reference"));
    assert!(refused(&["--out", "c.png", "--reference", "--samples", "0"]).contains("--samples"));
}

#[test]
fn the_reference_traces_light() {
    let folder = folder("reference_light");
    let bright = |name: &str| {
        let picture = image::open(folder.join(name)).unwrap().into_rgb8();
        picture.pixels().map(|pixel| f64::from(pixel.0[1])).sum::<f64>()
    };
    let shadow_rays = |name: &str, extra: &[&str]| {
        let out = [&format!("{name}.png"), "--stats", &format!("{name}.json")];
        let small =
            ["render", "builtin:curly:300:24", "--frames", "0", "--size", "160x90", "--reference", "--samples", "16"];
        passes(&folder, &[&small[..], &["--out"], &out, extra].concat());
        let stats: Value = serde_json::from_slice(&std::fs::read(folder.join(out[2])).unwrap()).unwrap();
        stats["render"]["reference"]["shadow_rays"].as_u64().unwrap()
    };
    std::fs::write(folder.join("open.toml"), "[material]\nself_shadow = 0.0\n").unwrap();
    let open = ["--params", "open.toml"];
    assert_eq!(shadow_rays("given", &[&open[..], &["--reference-light", "given"]].concat()), 0);
    assert_eq!(shadow_rays("open", &open), 0, "no shadow is seen, none is traced");
    assert!(shadow_rays("traced", &[]) > 1000);
    // The sky apart, of which the shader takes what is in one direction, the colours are the same.
    let compared: Value =
        serde_json::from_str(&passes(&folder, &["compare", "given.png", "open.png", "--json"])).unwrap();
    assert!(compared["psnr_db"].as_f64().unwrap() > 35.0, "{compared}");
    assert!(bright("traced.png") < bright("open.png"), "hair shades hair");
    // Another method in its place: strands shade, without rays, the more the nearer they are taken to be.
    let nearest =
        |name: &str, spacing| shadow_rays(name, &["--reference-light", "nearest", "--fibre-spacing", spacing]);
    assert_eq!([nearest("dense", "0.4"), nearest("thin", "1e9")], [0, 0]);
    assert!(bright("dense.png") < bright("thin.png") && bright("thin.png") < bright("open.png"));
    assert_eq!(
        shadow_rays("turned", &["--light-turn", "90"]),
        shadow_rays("traced", &[]),
        "the first frame has not turned"
    );
    assert_eq!(bright("turned.png"), bright("traced.png"));
    assert_eq!(shadow_rays("again", &[]), shadow_rays("traced", &[]));
    assert_eq!(bright("again.png"), bright("traced.png"));
    // Every frame where that is asked for, in light that turns.
    let film =
        ["--frames", "3", "--size", "160x90", "--reference", "--samples", "2", "--light-turn", "90", "--out", "film/"];
    passes(&folder, &[&["render", "builtin:curly:300:24"], &film[..]].concat());
    assert!(bright("film/0000.png") > 0.0 && bright("film/0000.png") != bright("film/0002.png"));
}

#[test]
fn adapters_are_listed() {
    assert!(!passes(&folder("adapters"), &["adapters"]).trim().is_empty());
}

#[test]
fn rods_say_which_stand_and_refuse_a_material_that_is_none() {
    let folder = folder("rods");
    let simulate = ["simulate", "builtin:wavy:20:12", "--frames", "8", "--solver", "direct", "--out", "pose.tfx"];
    let output = tressfx(&folder, &simulate);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    assert!(said.contains("of 20 guides is raised"), "{said}");
    std::fs::write(folder.join("soft.toml"), "[sim]\nbending_length = 0.0\n").unwrap();
    let (message, _) = fails(&folder, &[&simulate[..], &["--params", "soft.toml"]].concat());
    assert!(message.contains("parameter bending_length = 0 must be from 0.002 to 10"), "{message}");
    let pose = |words: &[&str]| {
        let shaken = ["--motion", "shake"];
        let output = tressfx(&folder, &[&simulate[..], &shaken, words].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        (std::fs::read(folder.join("pose.tfx")).unwrap(), said)
    };
    let (stiff, _) = pose(&["--preset", "mohawk"]);
    let (soft, said) = pose(&["--local-stiffness", "0.5"]);
    assert!(said.contains("a local stiffness of 0.5 is a bending length of") && said.contains("12 vertices"), "{said}");
    assert!(stiff != soft && stiff != pose(&[]).0, "materials move in their own ways");
    let (message, _) = fails(&folder, &[&simulate[..], &["--preset", "bald"]].concat());
    assert!(message.contains("bald") && message.contains("sprayed"), "{message}");
}

#[test]
fn that_nobody_reads_to_the_end_is_no_error() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tressfx"));
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = command.args(["info", "builtin:long:10"]).stdout(writer).stderr(Stdio::piped()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
