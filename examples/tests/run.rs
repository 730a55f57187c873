//! The examples run, and their pictures show hair where it should be.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

use image::RgbaImage;
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_compare::{Picture, compare};

/// An example, which `cargo test` builds beside its tests.
fn example(name: &str) -> Command {
    let test = std::env::current_exe().unwrap();
    let folder = test.ancestors().nth(2).unwrap().join("examples");
    let program = folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    assert!(
        program.exists(),
        "{}: `cargo test -p tressfx-examples` builds it, `--test run` alone does not",
        program.display()
    );
    Command::new(program)
}

fn out(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Runs an example; its standard output.
fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {error}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn picture(path: &Path) -> RgbaImage {
    image::open(path).unwrap().into_rgba8()
}

/// Whether there is no adapter, and somebody said that this is known.
fn skipped<T>(opened: Result<T, tressfx_core::Error>) -> bool {
    match opened {
        Ok(_) => false,
        Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => {
            eprintln!("skipped: {error}");
            true
        }
        Err(error) => panic!("{error}"),
    }
}

/// Mean colour of a part of a picture, given in shares of its width and height.
fn mean(picture: &RgbaImage, x: Range<f32>, y: Range<f32>) -> [f32; 3] {
    let [width, height] = [picture.width() as f32, picture.height() as f32];
    let inside = |px: u32, py: u32| x.contains(&(px as f32 / width)) && y.contains(&(py as f32 / height));
    let pixels: Vec<_> = picture.enumerate_pixels().filter(|&(px, py, _)| inside(px, py)).collect();
    [0, 1, 2].map(|c| pixels.iter().map(|(.., pixel)| f32::from(pixel.0[c])).sum::<f32>() / pixels.len() as f32)
}

#[test]
fn hello_hair_draws_a_picture() {
    if skipped(WgpuBackend::headless()) {
        return;
    }
    let path = out("hello_hair.png");
    run(example("hello_hair").arg(&path).arg("wavy:2000:12"));
    let picture = picture(&path);
    assert_eq!(picture.dimensions(), (640, 640));
    assert!(picture.pixels().all(|pixel| pixel.0[3] == 255), "the backdrop is opaque, and hair over it stays so");
    // Hair is brown, the backdrop is blue.
    let ([red, _, blue], [back_red, _, back_blue]) =
        (mean(&picture, 0.4..0.6, 0.08..0.2), mean(&picture, 0.0..0.1, 0.0..0.1));
    assert!(red > blue + 10.0 && back_blue > back_red, "{red} {blue}, {back_red} {back_blue}");
}

#[test]
fn both_engines_show_the_same_picture_and_the_validation_layer_is_silent() {
    if skipped(WgpuBackend::headless()) || skipped(VulkanBackend::headless()) {
        return;
    }
    let [wgpu, vulkan] = [out("embed_wgpu.png"), out("embed_vulkan.png")];
    let words = ["long:1500:12", "5", "320x180"];
    run(example("embed_wgpu").arg(&wgpu).args(words));
    let layer = Path::new("/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json").exists();
    let validate: &[&str] = if layer { &["--validate"] } else { &[] };
    run(example("embed_vulkan").args(validate).arg(&vulkan).args(words));
    let [wgpu, vulkan] = [picture(&wgpu), picture(&vulkan)];
    upright(&wgpu);
    upright(&vulkan);
    let [a, b] = [wgpu, vulkan].map(|shown| Picture::new(shown.dimensions().into(), shown.into_raw()).unwrap());
    let result = compare(&a, &b).unwrap();
    let same = result.psnr_db.is_none_or(|psnr| psnr > 45.0);
    println!("{:?} dB, FLIP {}", result.psnr_db, result.flip_mean);
    assert!(same, "{:?} dB, FLIP {}", result.psnr_db, result.flip_mean);
}

/// The floor, which is warm, is at the bottom, and the blue dusk above it; in the middle of both stands somebody with hair.
fn upright(picture: &RgbaImage) {
    let [dusk, floor, hair] =
        [mean(picture, 0.0..0.2, 0.0..0.2), mean(picture, 0.0..0.2, 0.85..1.0), mean(picture, 0.45..0.55, 0.07..0.13)];
    let warmth = |[red, _, blue]: [f32; 3]| red - blue;
    assert!(warmth(dusk) < 0.0 && warmth(floor) > 0.0 && warmth(hair) > warmth(floor), "{dusk:?} {floor:?} {hair:?}");
}

#[test]
fn my_backend_says_what_it_cannot_do() {
    let said = run(&mut example("my_backend"));
    assert!(said.contains("[1, 0, 3, 4]") && said.contains("nothing: needs compute passes"), "{said}");
}
