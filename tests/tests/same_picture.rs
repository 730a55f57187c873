//! wgpu and raw Vulkan: the same picture to the bit, of each scene by each technique.

mod support;

#[path = "same_picture/hair.rs"]
mod hair;
#[path = "same_picture/scenes.rs"]
mod scenes;

use glam::camera::rh;
use glam::{Mat4, Quat, Vec3};
use tressfx_asset::mesh::Mesh;
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_conformance::scene::coarse_shadows;
use tressfx_core::backend::DepthOrder;
use tressfx_core::view::{Camera, View};
use tressfx_render::{FibreScattering, Highlight, Material, Technique};

use hair::Grooms;
use scenes::{Eye, Look, OTHERS, SCENES, Scene, Solid};
use support::gpu;

/// Frames in which pools grow to what was measured. Where the technique is chosen by measurements, so many are asked for.
const FRAMES: usize = 8;
const FRAMES_OF_A_CHOICE: usize = 48;

/// Where compilers round in two ways: by how much pixels may differ, and how many may by more.
const TOLERANCE: f64 = 0.004;
const DIFFERING: usize = 1000;

fn look(look: Look) -> Material {
    Material::default().with(|m| match look {
        Look::Default => {}
        Look::Opaque => (m.opacity, m.tip_opacity) = (1.0, 1.0),
        Look::Clear => (m.opacity, m.tip_opacity) = (0.0, 0.0),
        Look::Faint => (m.opacity, m.tip_opacity, m.variation) = (0.15, 0.08, 1.0),
        Look::Fading => (m.opacity, m.tip_opacity) = (1.0, 0.0),
        Look::Varied => (m.opacity, m.tip_opacity, m.variation) = (0.5, 0.7, 1.0),
        Look::Pointed => m.tip_width = 0.0,
        Look::Blunt => (m.tip_width, m.fibre_radius) = (1.0, Some(0.006)),
        Look::NoWidth => m.fibre_radius = Some(0.0),
        Look::Thin => m.fibre_radius = Some(1e-6),
        Look::Wide => m.fibre_radius = Some(0.15),
        Look::Glossy => {
            (m.primary, m.secondary) =
                (Highlight { strength: 4.0, exponent: 900.0 }, Highlight { strength: 4.0, exponent: 300.0 });
            (m.tilt, m.tilt_variation) = (20.0, 1.0);
        }
        Look::Glass => m.fibre = Some(FibreScattering::default()),
        Look::Flat => (m.diffuse, m.self_shadow, m.root_shade) = (0.0, 0.0, 0.0),
    })
}

/// The sections of a scene, each in another colour.
fn sections(grooms: &mut Grooms, scene: &Scene) -> Vec<Groom> {
    let mut sections = grooms.of(scene.grooms);
    for (i, groom) in sections.iter_mut().enumerate() {
        groom.material = look(scene.look);
        groom.material.base_color = [Vec3::new(0.6, 0.3, 0.1), Vec3::new(0.1, 0.2, 0.8), Vec3::ONE, Vec3::Y][i];
    }
    sections
}

fn points(sections: &[Groom]) -> Vec<Vec3> {
    sections.iter().flat_map(|groom| &groom.positions).map(|position| Vec3::from_slice(&position[..3])).collect()
}

fn camera(eye: Eye, points: &[Vec3], size: [u32; 2]) -> Camera {
    let around = Camera::around(points, size);
    let (away, distance) = ((around.eye - around.target).normalize(), around.eye.distance(around.target));
    let at = |share: f32| Camera { eye: around.target + share * distance * away, ..around };
    match eye {
        Eye::Middle | Eye::Parallel | Eye::Rolled => around,
        Eye::Standard => Camera { depth: DepthOrder::Standard, far: f32::INFINITY, ..around },
        Eye::Near => at(0.33),
        Eye::Far => at(8.0),
        Eye::Inside => Camera { eye: around.target, target: around.target - away, near: 1e-3, ..around },
        Eye::Cut => Camera { near: distance, ..around },
        Eye::Aside => Camera { target: around.target + 0.25 * distance * Vec3::new(away.z, 0.0, -away.x), ..around },
        Eye::Above => Camera { eye: around.target + distance * Vec3::Y, ..around },
        Eye::Wide => Camera { fov: 130f32.to_radians(), ..at(0.3) },
        Eye::Away => Camera { target: around.eye + away, ..around },
    }
}

fn view(eye: Eye, camera: &Camera, size: [u32; 2]) -> View {
    let (plain, depth) = (camera.view(size).unwrap(), camera.depth);
    let aspect = size[0] as f32 / size[1] as f32;
    let made = match eye {
        Eye::Parallel => {
            let half = 0.3 * camera.eye.distance(camera.target);
            let lens =
                rh::proj::directx::orthographic(-half * aspect, half * aspect, -half, half, camera.far, camera.near);
            View::new(plain.view_matrix(), lens, depth, size)
        }
        Eye::Rolled => {
            let turn = Mat4::from_quat(Quat::from_rotation_z(0.7)) * Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
            View::new(turn * plain.view_matrix(), plain.projection_matrix(), depth, size)
        }
        _ => Ok(plain),
    };
    made.unwrap()
}

/// Something opaque in the way, as the eye sees it.
fn solid(solid: Solid, camera: &Camera) -> Option<Mesh> {
    let to_world = camera.view_matrix().inverse();
    let distance = camera.eye.distance(camera.target);
    let corners = match solid {
        Solid::Nothing => return None,
        Solid::Roof => [Vec3::new(-0.6, -0.5, -1.3), Vec3::new(0.5, -0.4, -0.8), Vec3::new(0.1, 0.6, -1.0)],
        Solid::Wall => [Vec3::new(-9.0, -9.0, -0.02), Vec3::new(9.0, -9.0, -0.02), Vec3::new(0.0, 20.0, -0.02)],
    };
    let positions = corners.map(|corner| to_world.transform_point3(distance * corner)).to_vec();
    Some(Mesh { positions, normals: vec![Vec3::Z; 3], indices: vec![0, 1, 2] })
}

/// A scene as it is drawn.
struct Stage {
    setup: Setup,
    view: View,
    mesh: Option<Mesh>,
    sections: Vec<Groom>,
}

impl Stage {
    fn new(grooms: &mut Grooms, scene: &Scene) -> Self {
        let sections = sections(grooms, scene);
        let camera = camera(scene.eye, &points(&sections), scene.size);
        Self {
            setup: Setup {
                camera,
                size: scene.size,
                technique: Technique::default(),
                storage_target: false,
                hair_output: false,
                copies: false,
                own_colors: true,
                shadows: Some(coarse_shadows()),
            },
            view: view(scene.eye, &camera, scene.size),
            mesh: solid(scene.solid, &camera),
            sections,
        }
    }

    /// The picture without hair.
    fn empty(&self, screen: &mut Screen) -> Picture {
        screen.turn_to(&self.setup);
        screen.view = self.view;
        screen.scene(&self.mesh.iter().collect::<Vec<_>>(), &[])
    }

    /// The picture once there is room for everything.
    fn drawn(&self, screen: &mut Screen, technique: Technique, chooses: bool) -> Picture {
        screen.turn_to(&Setup { technique, ..self.setup });
        screen.view = self.view;
        let meshes: Vec<&Mesh> = self.mesh.iter().collect();
        let grooms: Vec<&Groom> = self.sections.iter().collect();
        let frames = if chooses { FRAMES_OF_A_CHOICE } else { FRAMES };
        let mut picture = screen.scene(&meshes, &grooms);
        for _ in 1..frames {
            let grown = screen.renderer.grow_to_measured(&mut *screen.backend, &picture.counters).unwrap();
            if !grown && !chooses {
                break;
            }
            picture = screen.scene(&meshes, &grooms);
        }
        picture
    }
}

/// How many pixels of two pictures differ.
fn differing(a: &Picture, b: &Picture, by: f64) -> usize {
    a.pixels().iter().zip(b.pixels()).filter(|(a, b)| (**a - *b).abs().max_element() > by).count()
}

/// What is wrong with a picture by itself, beside the one without hair.
fn faults(scene: &Scene, picture: &Picture, empty: &Picture) -> Vec<String> {
    let counters = picture.counters;
    let changed = differing(picture, empty, 0.0);
    let pixels = (scene.size[0] * scene.size[1]) as usize;
    let least = if scene.eye == Eye::Far { pixels / 1000 } else { pixels / 50 };
    let shows_hair = changed > least && counters.pixels_with_hair as usize >= changed;
    let is_empty = changed == 0 && counters.fragments == 0;
    let held = [
        (picture.pixels().iter().all(|pixel| pixel.is_finite()), "numbers that are not finite"),
        (counters.dropped == 0, "something has no room"),
        (if scene.shows_hair() { shows_hair } else { is_empty }, "hair that should be there is not, or the reverse"),
    ];
    let broken = held.into_iter().filter(|(holds, _)| !holds);
    broken.map(|(_, fault)| format!("{fault}: {changed} of {pixels} pixels, {counters:?}")).collect()
}

/// How two pictures of one scene differ, where they may not.
fn difference(one: &Picture, other: &Picture, is_exact: bool) -> Option<String> {
    if is_exact {
        let count = differing(one, other, 0.0);
        let is_same = one.bytes == other.bytes && one.counters == other.counters;
        return (!is_same).then(|| format!("{count} pixels differ: {:?}, {:?}", one.counters, other.counters));
    }
    let count = differing(one, other, TOLERANCE);
    let [width, height] = one.size;
    (count * DIFFERING > (width * height) as usize).then(|| format!("{count} pixels differ"))
}

/// Holds each scene by each technique, and by so many of what they can do beside.
fn hold(beside: usize) {
    assert!(SCENES.len() >= 60, "{} scenes", SCENES.len());
    let Some(wgpu) = gpu() else { return };
    // Whatever the validation layer says fails the run of a list.
    let watched = VulkanOptions { validation: true, ..VulkanOptions::default() };
    let vulkan = VulkanBackend::headless_with(&watched).unwrap();
    let shadowed = |setup: &mut Setup| (setup.own_colors, setup.shadows) = (true, Some(coarse_shadows()));
    let mut screens = [Screen::new(wgpu, shadowed), Screen::new(Box::new(vulkan), shadowed)];
    // On the CPU both backends compile the same code; on GPUs two compilers may round in two ways.
    let is_exact = screens[0].backend.caps().is_cpu;
    let (mut grooms, mut wrong) = (Grooms::default(), Vec::new());
    for (index, scene) in SCENES.iter().enumerate() {
        let stage = Stage::new(&mut grooms, scene);
        let empty = stage.empty(&mut screens[0]);
        for (technique, desc) in scene.setting.techniques(index, beside) {
            let chooses = technique == "auto" && scene.setting.grows_dense;
            let is_for_tiles = technique.starts_with("tiles") || (technique == "auto" && scene.setting.is_for_tiles());
            let mut say = |fault| wrong.push(format!("{}, {technique}: {fault}", scene.name));
            let [one, other] = screens.each_mut().map(|screen| {
                let drawn = stage.drawn(screen, desc, chooses);
                if screen.renderer.uses_tiles() != is_for_tiles {
                    say(String::from("the other technique was chosen"));
                }
                faults(scene, &drawn, &empty).into_iter().for_each(&mut say);
                drawn
            });
            difference(&one, &other, is_exact).into_iter().for_each(say);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Two of what techniques can do beside, in turns; all of it where `TRESSFX_LONG_TESTS` is set, which takes a quarter of an hour on a CPU.
#[test]
fn each_scene_by_each_technique() {
    hold(if std::env::var_os("TRESSFX_LONG_TESTS").is_some() { OTHERS } else { 2 });
}
