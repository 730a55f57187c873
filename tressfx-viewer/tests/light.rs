//! Lights of a parameter file, exposure, tone mapping and linear light, as users of the program call them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use image::{Rgb32FImage, RgbImage};

fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn render(folder: &Path, words: &[&str]) -> Output {
    let usual = ["render", "builtin:fur:2000:4", "--frames", "0", "--size", "64x48", "--out", "out.png"];
    Command::new(env!("CARGO_BIN_EXE_tressfx")).current_dir(folder).args([&usual, words].concat()).output().unwrap()
}

fn picture(folder: &Path, words: &[&str]) -> RgbImage {
    let output = render(folder, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    image::open(folder.join("out.png")).unwrap().into_rgb8()
}

fn with_lights(folder: &Path, text: &str) -> RgbImage {
    std::fs::write(folder.join("lights.toml"), text).unwrap();
    picture(folder, &["--params", "lights.toml"])
}

/// The mean colour of the middle of a picture.
fn middle(picture: &RgbImage) -> [f64; 3] {
    let inner = picture.enumerate_pixels().filter(|(x, y, _)| x.abs_diff(32) < 8 && y.abs_diff(24) < 8);
    let sum = inner.fold([0.0; 3], |sum: [f64; 3], (_, _, pixel)| [0, 1, 2].map(|i| sum[i] + f64::from(pixel[i])));
    sum.map(|sum| sum / 225.0)
}

const DARK: &str = "[sky]\nabove = [0, 0, 0]\n";

#[test]
fn the_lights_of_a_file_are_those_of_the_picture() {
    let folder = folder("lights");
    assert!(middle(&with_lights(&folder, DARK)).iter().all(|level| *level < 2.0), "no light");
    let red = middle(&with_lights(&folder, "[[light]]\ntowards = [0, 0.3, 1]\ncolor = [2, 0.2, 0.2]\n"));
    assert!(red[0] > 40.0 && red[0] > 2.0 * red[2], "{red:?}");
    let spot = |along: &str| {
        let text = "[[light]]\nposition = [0, 0, 2]\nreach = 2\ncolor = [3, 3, 3]\n";
        middle(&with_lights(&folder, &format!("{text}cone = {{ along = {along}, inner = 20, outer = 30 }}\n")))
    };
    let (on, off) = (spot("[0, 0, -1]"), spot("[0, 0, 1]"));
    assert!(on[0] > 40.0 && off[0] < 2.0, "{on:?} {off:?}");
    // As many as there can be, half of which have their shadows from the sky's.
    let many: String =
        (0..16).map(|i| format!("[[light]]\ntowards = [{}, 0.5, 1]\ncolor = [0.1, 0.1, 0.1]\n", i - 8)).collect();
    assert!(middle(&with_lights(&folder, &many))[0] > 20.0);
}

#[test]
fn light_that_cannot_be_is_an_error_that_names_file_and_light() {
    let folder = folder("bad-lights");
    for (text, expected) in [
        ("[[light]]\ncolor = [1, 1, 1]\n", "light 0: it must have either"),
        ("[[light]]\ntowards = [0, 1, 0]\ncolor = [inf, 1, 1]\n", "light 0: color"),
        ("[[light]]\ntowards = [0, 1, 0]\ncolour = [1, 1, 1]\n", "colour"),
        ("[sky]\nabove = [nan, 0, 0]\n", "sky"),
    ] {
        std::fs::write(folder.join("lights.toml"), text).unwrap();
        let output = render(&folder, &["--params", "lights.toml"]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && message.contains("lights.toml") && message.contains(expected), "{message}");
    }
}

/// Of sRGB, in 8 bits.
fn level(linear: f32) -> u8 {
    let level = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (255.0 * level + 0.5) as u8
}

#[test]
fn linear_light_is_what_the_picture_is_developed_from() {
    let folder = folder("linear");
    let words = ["--linear-out", "light.exr", "--deep-out", "deep.png", "--exposure", "-2"];
    let picture = picture(&folder, &words);
    let light: Rgb32FImage = image::open(folder.join("light.exr")).unwrap().into_rgb32f();
    assert_eq!(light.dimensions(), (64, 48));
    let brightest = light.iter().copied().fold(0.0, f32::max);
    // Two stops down no channel gets to where highlights are rolled off.
    assert!(brightest > 0.3 && brightest < 3.2, "{brightest}");
    for (light, developed) in light.iter().zip(picture.iter()) {
        assert!(level(0.25 * light).abs_diff(*developed) <= 1, "{light} {developed}");
    }
    let deep = image::open(folder.join("deep.png")).unwrap();
    assert_eq!(deep.color(), image::ColorType::Rgb16);
    let mut between = 0;
    for (deep, developed) in deep.into_rgb16().iter().zip(picture.iter()) {
        assert!(deep.abs_diff(257 * u16::from(*developed)) <= 129, "{deep} {developed}");
        between += usize::from(!deep.is_multiple_of(257));
    }
    assert!(between > 1000, "{between} channels are between two steps of 8 bits");
    let output = render(&folder, &["--linear-out", "light.png"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("the ending must be .exr"));
    let output = render(&folder, &["--exposure", "21"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("must be from -20 to 20 stops"));
}
