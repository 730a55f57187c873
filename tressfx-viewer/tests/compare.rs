//! `tressfx compare` as its users call it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use image::{ImageBuffer, Luma, Rgb, RgbImage};
use serde_json::Value;

/// A folder of its own for each test, in cargo's folder for such things, with a picture in it.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("compare").join(test);
    std::fs::create_dir_all(&folder).unwrap();
    picture(0).save(folder.join("a.png")).unwrap();
    folder
}

/// Slanting stripes, moved by some pixels.
fn picture(shift: u32) -> RgbImage {
    RgbImage::from_fn(
        60,
        40,
        |x, y| if (x + shift + y / 2) % 12 < 4 { Rgb([220, 170, 110]) } else { Rgb([30, 25, 40]) },
    )
}

fn tressfx(folder: &Path, words: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_tressfx");
    Command::new(program).current_dir(folder).arg("compare").args(words).output().unwrap()
}

fn json(folder: &Path, a: &str, b: &str) -> Value {
    let output = tressfx(folder, &[a, b, "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// What is said about a file, called `b.png`, that cannot be compared with `a.png`.
fn refused(folder: &Path, bytes: &[u8]) -> String {
    std::fs::write(folder.join("b.png"), bytes).unwrap();
    let output = tressfx(folder, &["a.png", "b.png", "--heat-map", "never.png"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!folder.join("never.png").exists());
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.starts_with("error: ") && message.contains("b.png"), "{message}");
    message
}

#[test]
fn equal_pictures_differ_in_nothing() {
    let folder = folder("equal");
    let expected = r#"{"flip_mean": 0.0, "psnr_db": null, "max_difference": 0, "differing_share": 0.0}"#;
    assert_eq!(json(&folder, "a.png", "a.png"), serde_json::from_str::<Value>(expected).unwrap());
    let text = tressfx(&folder, &["a.png", "a.png"]).stdout;
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("| PSNR") && text.contains("equal") && text.contains("0 of 255"), "{text}");
}

#[test]
fn one_changed_pixel_is_found_and_shown() {
    let folder = folder("pixel");
    let mut changed = picture(0);
    changed[(30, 20)].0[1] += 50;
    changed.save(folder.join("b.png")).unwrap();
    let figures = json(&folder, "a.png", "b.png");
    assert_eq!((&figures["max_difference"], &figures["differing_share"]), (&50.into(), &(1.0 / 2400.0).into()));
    assert!(figures["flip_mean"].as_f64().unwrap() > 0.0 && figures["psnr_db"].as_f64().unwrap() > 40.0, "{figures}");
    assert!(tressfx(&folder, &["a.png", "b.png", "--heat-map", "map.png"]).status.success());
    let map = image::open(folder.join("map.png")).unwrap().into_rgb8();
    assert_eq!(map.dimensions(), (60, 40));
    assert_eq!(map[(0, 0)], Rgb([0, 0, 4]), "far from the change");
    assert!(map[(30, 20)][0] > 10, "at the change: {:?}", map[(30, 20)]);
}

#[test]
fn the_farther_a_picture_is_shifted_the_more_it_differs() {
    let folder = folder("shift");
    picture(1).save(folder.join("near.png")).unwrap();
    picture(4).save(folder.join("far.png")).unwrap();
    let [near, far] = ["near.png", "far.png"].map(|name| json(&folder, "a.png", name));
    let figure = |figures: &Value, key: &str| figures[key].as_f64().unwrap();
    assert!(figure(&near, "flip_mean") < figure(&far, "flip_mean"), "{near} {far}");
    assert!(figure(&near, "psnr_db") > figure(&far, "psnr_db"), "{near} {far}");
    assert_eq!(far, json(&folder, "far.png", "a.png"), "the order is all the same");
}

#[test]
fn grey_and_alpha_are_pictures_too() {
    let folder = folder("kinds");
    let grey = ImageBuffer::from_pixel(60, 40, Luma([90_u8]));
    grey.save(folder.join("grey.png")).unwrap();
    image::DynamicImage::from(grey).to_rgba8().save(folder.join("rgba.png")).unwrap();
    assert_eq!(json(&folder, "grey.png", "rgba.png")["max_difference"], 0);
}

#[test]
fn sixteen_bits_tell_what_eight_do_not() {
    let folder = folder("deep");
    let grey = |level: u16| ImageBuffer::from_pixel(60, 40, Luma([level]));
    for (name, level) in [("deep.png", 90 * 257), ("little.png", 90 * 257 + 40)] {
        grey(level).save(folder.join(name)).unwrap();
    }
    ImageBuffer::from_pixel(60, 40, Luma([90_u8])).save(folder.join("grey.png")).unwrap();
    assert_eq!(json(&folder, "deep.png", "grey.png")["flip_mean"], 0.0);
    let little = json(&folder, "little.png", "grey.png")["flip_mean"].as_f64().unwrap();
    assert!(little > 1e-4 && little < 0.02, "{little}");
}

#[test]
fn what_cannot_be_compared_is_refused_with_the_name_of_the_file() {
    let folder = folder("refused");
    let whole = std::fs::read(folder.join("a.png")).unwrap();
    refused(&folder, &whole[..whole.len() / 2]);
    refused(&folder, &whole[..20]);
    refused(&folder, b"");
    refused(&folder, b"GIF89a nothing of the kind");
    let save = |name: &str, picture: image::DynamicImage| {
        picture.save(folder.join(name)).unwrap();
        std::fs::read(folder.join(name)).unwrap()
    };
    let small = save("small.png", RgbImage::new(40, 60).into());
    assert!(refused(&folder, &small).contains("60x40 and 40x60"));
    let output = tressfx(&folder, &["a.png", "absent.png"]);
    assert!(String::from_utf8(output.stderr).unwrap().contains("absent.png"));
    assert_eq!(tressfx(&folder, &["a.png", "a.png", "--heat-map", "map.jpg"]).status.code(), Some(2));
}

#[test]
fn a_size_in_a_file_is_not_believed() {
    let folder = folder("size");
    for (edge, complaint) in [(10_000, "10000x10000 pixels are more than"), (i32::MAX as u32, "limit exceeded")] {
        let mut huge = Vec::new();
        let mut encoder = png::Encoder::new(&mut huge, edge, edge);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_chunk(png::chunk::IDAT, b"").unwrap();
        let message = refused(&folder, &huge);
        assert!(message.contains(complaint), "{message}");
    }
}
