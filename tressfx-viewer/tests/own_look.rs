//! Colours and widths that grooms bring along, and pictures over them, as users of the program call them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb, RgbImage};

fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn tressfx(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tressfx")).current_dir(folder).args(words).output().unwrap()
}

fn render(folder: &Path, words: &[&str]) -> Output {
    let usual = ["render", "--frames", "0", "--size", "64x48", "--no-shadows", "--out", "out.png"];
    tressfx(folder, &[&usual, words].concat())
}

/// The mean colour of the pixels that differ from those without hair.
fn hair(folder: &Path, words: &[&str]) -> [f64; 3] {
    let output = render(folder, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    let picture = image::open(folder.join("out.png")).unwrap().into_rgb8();
    let inner = picture.enumerate_pixels().filter(|(x, y, _)| x.abs_diff(32) < 8 && y.abs_diff(24) < 8);
    let sum = inner.fold([0.0; 3], |sum: [f64; 3], (_, _, pixel)| [0, 1, 2].map(|i| sum[i] + f64::from(pixel[i])));
    sum.map(|sum| sum / 225.0)
}

const FUR: &str = "builtin:fur:3000:4";

fn filled(color: [u8; 3]) -> DynamicImage {
    RgbImage::from_pixel(8, 8, Rgb(color)).into()
}

#[test]
fn a_texture_colours_the_hair_in_any_format() {
    let folder = folder("texture");
    let to = |name: &str, image: DynamicImage, format| image.save_with_format(folder.join(name), format).unwrap();
    to("red.png", filled([200, 20, 20]), ImageFormat::Png);
    // The content says the format, not the name.
    to("blue.png", filled([20, 20, 200]), ImageFormat::Jpeg);
    let deep: ImageBuffer<Luma<u16>, Vec<u16>> = ImageBuffer::from_pixel(3, 1, Luma([30_000]));
    to("gray.png", deep.into(), ImageFormat::Png);
    let red = hair(&folder, &[FUR, "--root-texture", "red.png"]);
    let redder = |color: [f64; 3]| color[0] - color[2];
    let plain = redder(hair(&folder, &[FUR]));
    assert!(redder(red) > plain + 20.0, "{red:?}, {plain}");
    let blue = hair(&folder, &[FUR, "--strand-texture", "blue.png"]);
    assert!(redder(blue) < plain - 20.0, "{blue:?}, {plain}");
    let gray = hair(&folder, &[FUR, "--root-texture", "gray.png"]);
    assert!(redder(gray) < plain && redder(gray) > redder(blue) + 20.0, "{gray:?}, {plain}");
}

#[test]
fn a_texture_that_is_none_is_an_error_that_names_it() {
    let folder = folder("bad-texture");
    filled([1, 2, 3]).save(folder.join("whole.png")).unwrap();
    let whole = std::fs::read(folder.join("whole.png")).unwrap();
    std::fs::write(folder.join("cut.png"), &whole[..whole.len() / 2]).unwrap();
    // A header that claims more than there is room for.
    let mut huge = whole;
    huge[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
    std::fs::write(folder.join("huge.png"), huge).unwrap();
    std::fs::write(folder.join("text.png"), "a letter").unwrap();
    let line = "v 0 0 0\nv 0 1 0\nv 0 2 0\nl 1 2 3\n";
    std::fs::write(folder.join("bald.obj"), line).unwrap();
    for name in ["cut.png", "huge.png", "text.png", "none.png"] {
        let output = render(&folder, &[FUR, "--root-texture", name]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && message.contains(name), "{name}: {message}");
    }
    let output = render(&folder, &["bald.obj", "--root-texture", "whole.png"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("bald.obj: its strands have no texture coordinates"), "{message}");
}

/// A `.hair` file of a comb of strands of two vertices, all of one colour.
fn comb(folder: &Path, color: [f32; 3]) {
    let strands = 400u32;
    let mut file = b"HAIR".to_vec();
    [strands, 2 * strands, 0b11110, 1].iter().for_each(|word| file.extend(word.to_le_bytes()));
    file.resize(128, 0);
    let mut push = |values: &[f32]| values.iter().for_each(|value| file.extend(value.to_le_bytes()));
    (0..strands).for_each(|i| push(&[0.05 * i as f32, 0.0, 0.0, 0.05 * i as f32, 16.0, 0.0]));
    (0..strands).for_each(|i| push(&[0.1 + 0.1 * (i % 2) as f32; 2]));
    (0..2 * strands).for_each(|_| push(&[0.125]));
    (0..2 * strands).for_each(|_| push(&color));
    std::fs::write(folder.join("comb.hair"), file).unwrap();
}

#[test]
fn colours_of_a_file_are_said_drawn_and_kept() {
    let folder = folder("file-look");
    comb(&folder, [0.1, 0.7, 0.1]);
    let said = String::from_utf8(tressfx(&folder, &["info", "comb.hair"]).stdout).unwrap();
    assert!(said.contains("colour     0.100, 0.700, 0.100 (sRGB) in the mean, opacity 0.875"), "{said}");
    assert!(said.contains("thickness  0.1 to 0.2"), "{said}");
    assert!(tressfx(&folder, &["convert", "comb.hair", "comb.tfx"]).status.success());
    let again = String::from_utf8(tressfx(&folder, &["info", "comb.tfx"]).stdout).unwrap();
    assert!(again.contains("opacity 0.875") && again.contains("thickness  0.1 to 0.2"), "{again}");
    let green = hair(&folder, &["comb.hair", "--follow", "0"]);
    assert!(green[1] > 1.3 * green[0], "{green:?}");
    let from_tfx = hair(&folder, &["comb.tfx", "--follow", "0"]);
    assert_eq!(green, from_tfx);
    let red = hair(&folder, &["comb.hair", "--follow", "0", "--look", "red"]);
    assert!(red[0] > red[1], "a look that was asked for is seen: {red:?}");
    comb(&folder, [0.1, 7.0, 0.1]);
    let output = render(&folder, &["comb.hair"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("comb.hair: colour (byte 16132): is 7, but must be from 0 to 1"), "{message}");
}
