//! The examples run, and their pictures show hair where it should be.

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
    assert!(program.exists(), "{}: `cargo test -p tressfx-examples` builds it, `--test run` alone does not", program.display());
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

/// Mean brightness of a part of a picture, given in shares of its width and height.
fn brightness(picture: &RgbaImage, x: [f32; 2], y: [f32; 2]) -> f32 {
    let [width, height] = [picture.width() as f32, picture.height() as f32];
    let inside = |share: f32, range: [f32; 2]| (range[0]..range[1]).contains(&share);
    let pixels = picture.enumerate_pixels().filter(|(px, py, _)| inside(*px as f32 / width, x) && inside(*py as f32 / height, y));
    let values: Vec<f32> = pixels.map(|(_, _, pixel)| pixel.0[..3].iter().map(|&v| f32::from(v)).sum::<f32>() / 3.0).collect();
    values.iter().sum::<f32>() / values.len() as f32
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
    // The top of the head has hair, the corner of the backdrop has none.
    let [hair, backdrop] = [brightness(&picture, [0.4, 0.6], [0.08, 0.2]), brightness(&picture, [0.0, 0.1], [0.0, 0.1])];
    assert!((hair - backdrop).abs() > 10.0, "{hair} {backdrop}");
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
    let result = compare(&of(&wgpu), &of(&vulkan)).unwrap();
    assert!(result.psnr_db > 40.0, "{result:?}");
}

fn of(picture: &RgbaImage) -> Picture {
    todo!()
}

/// The floor is at the bottom, brighter than the dusk above it is at its sides.
fn upright(picture: &RgbaImage) {
    let [top, bottom] = [brightness(picture, [0.0, 0.2], [0.0, 0.2]), brightness(picture, [0.0, 0.2], [0.85, 1.0])];
    assert!(bottom > top + 10.0, "the floor is at the bottom: {bottom} {top}");
}

#[test]
fn my_backend_says_what_it_cannot_do() {
    let said = run(&mut example("my_backend"));
    assert!(said.contains("[1, 0, 3, 4]") && said.contains("nothing: needs compute passes"), "{said}");
}
