//! The opaque scene of the studio.

use glam::Vec3;
use tressfx_asset::mesh::Mesh;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::backend::{Backend, Format, Run, TextureDesc};
use tressfx_core::pass::PassList;
use tressfx_core::shape::Ellipsoid;
use tressfx_core::view::{Camera, Pose};
use tressfx_render::Targets;
use tressfx_viewer::scene::{Backdrop, MeshDraw, Scene, SceneMesh, ScenePass, Surface, studio_lights};

const SIZE: [u32; 2] = [96, 64];

/// Red, green and blue of each pixel.
fn picture(backend: &mut WgpuBackend, meshes: &[Mesh]) -> Vec<Vec3> {
    let mut list = PassList::new();
    let made: Vec<_> = meshes.iter().map(|mesh| SceneMesh::new(backend, &mut list, mesh).unwrap()).collect();
    let draws: Vec<_> =
        made.iter().map(|mesh| MeshDraw { mesh, surface: Surface::default(), pose: Pose::IDENTITY }).collect();
    let mut texture =
        |label, format| backend.create_texture(&TextureDesc::new(label, SIZE, format)).expect("a texture");
    let targets = Targets::new(texture("color", Format::Rgba16F), texture("depth", Format::Depth32F));
    let camera = Camera { eye: Vec3::Z * 3.0, target: Vec3::ZERO, fov: 0.6, ..Camera::around(&[Vec3::ONE], SIZE) };
    let view = Camera { near: 0.05, far: 50.0, ..camera }.view(SIZE).unwrap();
    let scene = ScenePass::new(backend, Format::Rgba16F, view.depth(), false).unwrap();
    let opaque = Scene { backdrop: Backdrop::default(), meshes: &draws, shadows: &[] };
    scene.draw(&mut list, &view, &studio_lights(), &targets, &opaque).unwrap();
    let ticket = list.read_texture(targets.color);
    backend.run(&list).unwrap();
    let bytes = backend.read(ticket).ready().expect("it has run");
    let channel = |texel: &[u8], i: usize| half::f16::from_le_bytes([texel[2 * i], texel[2 * i + 1]]).to_f32();
    bytes.chunks(8).map(|texel| Vec3::from_array([0, 1, 2].map(|i| channel(texel, i)))).collect()
}

#[test]
fn the_scene_is_lit_and_the_backdrop_is_behind_it() {
    let mut backend = match WgpuBackend::headless() {
        Ok(backend) => backend,
        Err(_) if std::env::var_os("TRESSFX_NO_GPU").is_some() => return,
        Err(error) => panic!("{error}"),
    };
    let backdrop = picture(&mut backend, &[]);
    assert!(backdrop.iter().all(|pixel| pixel.min_element() > 0.01), "every pixel is covered");
    let ball = Mesh::ellipsoid(&Ellipsoid { center: Vec3::ZERO, radii: Vec3::splat(0.5) }, 32);
    let scene = picture(&mut backend, &[ball]);
    let at = |x: f32, y: f32| scene[((32.0 - 34.0 * y) as usize) * 96 + (48.0 + 34.0 * x) as usize];
    assert!(at(0.25, 0.25).x > 1.5 * at(-0.3, -0.35).x, "the key light comes from the upper right");
    let untouched = |x: usize| scene[x] == backdrop[x];
    assert!(untouched(0) && untouched(96 * 64 - 1) && !untouched(32 * 96 + 48));
}
