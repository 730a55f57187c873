//! wgpu and raw Vulkan, from simulation to picture: the same, scene by scene. `same_picture` has every technique.

mod support;

use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_compare::{Comparison, Picture, compare};
use tressfx_conformance::show::{Scene, Show};
use tressfx_conformance::sim::{REAL, real};
use tressfx_core::backend::{Backend, Run};
use tressfx_render::{Material, PpllDesc};
use tressfx_sim::SimParams;

use support::gpu;

/// One backend is not made while another one names its objects: the Vulkan loader crashes of that now and then, and wgpu does not
/// wait for it as raw Vulkan does.
static ONE_TEST_AT_A_TIME: Mutex<()> = Mutex::new(());

const SIZE: [u32; 2] = [192, 108];
const FRAMES: u32 = 4;
const GROOMS: [&str; 5] = ["straight:700:16", "wavy:700:24", "curly:500:48", "long:900:32", "fur:2000:6"];

/// Of the pixels, how many may differ.
const DIFFERING: f64 = 1e-5;
const FLIP: f64 = 0.0005;

/// Each groom from in front and from near by as it is, and limp, dark and hardly sorted from the side.
fn scenes(groom: &Scene) -> Vec<Scene> {
    let limp = SimParams { local_stiffness: 0.2, damping: 0.4, ..SimParams::default() };
    let dark = Material::default().with(|m| {
        m.base_color = Vec3::new(0.02, 0.01, 0.01);
        m.opacity = 0.4;
        m.tip_opacity = 0.2;
    });
    let seen = |name: &str, from: Vec3, distance: f32| {
        let name = format!("{} {name}", groom.name);
        Scene { name, from, distance, ..groom.clone() }
    };
    let side = seen("side, limp", Vec3::new(-1.0, 0.2, 0.1), 1.0);
    let technique = PpllDesc::default().k(3).into();
    vec![
        seen("front", Vec3::Z, 1.0),
        Scene { params: limp, material: dark, technique, ..side },
        seen("near", Vec3::new(0.4, 0.5, 1.0), 0.4),
    ]
}

fn shown(backend: impl Run, scene: &Scene) -> (Picture, Vec<u8>, u32) {
    let mut show = Show::new(backend, scene);
    show.play(FRAMES);
    let (picture, counters) = show.picture();
    assert_eq!(counters.dropped, 0, "{}", scene.name);
    (Picture::new(SIZE, picture).unwrap(), show.positions(), counters.pixels_with_hair)
}

/// What both backends make of a scene; `None` where there is no GPU.
fn compared(scene: &Scene) -> Option<Comparison> {
    let (a, a_positions, hair) = shown(*gpu()?, scene);
    let vulkan = VulkanBackend::headless().unwrap();
    let (b, b_positions, _) = shown(vulkan, scene);
    assert!(hair * 50 > SIZE[0] * SIZE[1], "{}: {hair} pixels with hair", scene.name);
    assert!(a_positions == b_positions, "{}: positions differ", scene.name);
    Some(compare(&a, &b).unwrap())
}

fn hold(scenes: &[Scene]) {
    let _alone = ONE_TEST_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    // While a device is open its driver stays loaded. Some can be loaded some thirty times in a process, and no more.
    let driver = VulkanBackend::headless();
    // On the CPU both backends compile the same code; on GPUs two compilers may round in two ways.
    let is_exact = driver.as_ref().is_ok_and(|driver| driver.caps().adapter.contains("llvmpipe"));
    let mut differing = 0.0;
    for scene in scenes {
        let Some(comparison) = compared(scene) else { return };
        let Comparison { flip_mean, max_difference, differing_share, .. } = comparison;
        println!("{}: FLIP {flip_mean:.6}, largest {max_difference}, differing {differing_share:.6}", scene.name);
        assert!(!is_exact || max_difference == 0, "{}: {max_difference} of 255 on one device", scene.name);
        assert!(flip_mean < FLIP, "{}: FLIP {flip_mean}", scene.name);
        assert!(max_difference <= 1 || differing_share <= DIFFERING, "{}: {max_difference} of 255", scene.name);
        differing += if max_difference > 1 { differing_share } else { 0.0 };
    }
    assert!(differing <= DIFFERING * scenes.len() as f64, "{differing} of the pixels differ");
}

#[test]
fn built_in_grooms_are_the_same_on_both_backends() {
    let scenes: Vec<Scene> = GROOMS.iter().flat_map(|name| scenes(&Scene::builtin(name, SIZE))).collect();
    assert!(scenes.len() >= 15);
    hold(&scenes);
}

#[test]
fn real_grooms_are_the_same_on_both_backends() {
    for path in REAL {
        let Some(strands) = real(path) else { return };
        hold(&[Scene::new(path, strands, SIZE)]);
    }
}
