//! The opaque scene of the studio.

use glam::Vec3;
use tressfx_asset::mesh::Mesh;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::backend::{Backend, Format, Run, TextureDesc};
use tressfx_core::pass::PassList;
use tressfx_core::shape::Ellipsoid;
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::view::{Camera, Pose};
use tressfx_render::{
    Bends, HairRenderer, Light, Lights, Material, RenderDesc, SectionDraw, ShadedStrands, StrandInfo, Targets,
};
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

/// None where a person says that there is no GPU.
fn gpu() -> Option<WgpuBackend> {
    match WgpuBackend::headless() {
        Ok(backend) => Some(backend),
        Err(_) if std::env::var_os("TRESSFX_NO_GPU").is_some() => None,
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn the_scene_is_lit_and_the_backdrop_is_behind_it() {
    let Some(mut backend) = gpu() else { return };
    let backdrop = picture(&mut backend, &[]);
    assert!(backdrop.iter().all(|pixel| pixel.min_element() > 0.01), "every pixel is covered");
    let ball = Mesh::ellipsoid(&Ellipsoid { center: Vec3::ZERO, radii: Vec3::splat(0.5) }, 32);
    let scene = picture(&mut backend, &[ball]);
    let at = |x: f32, y: f32| scene[((32.0 - 34.0 * y) as usize) * 96 + (48.0 + 34.0 * x) as usize];
    assert!(at(0.25, 0.25).x > 1.5 * at(-0.3, -0.35).x, "the key light comes from the upper right");
    let untouched = |x: usize| scene[x] == backdrop[x];
    assert!(untouched(0) && untouched(96 * 64 - 1) && !untouched(32 * 96 + 48));
}

/// Fibres along x before the ball, so many that a ray along z meets `crossings` in the mean, at places that fill the square evenly.
fn curtain(backend: &mut WgpuBackend, list: &mut PassList, crossings: f32, radius: f32) -> (StrandBuffers, StrandInfo) {
    let count = (crossings * 2.0 / (2.0 * radius)) as u32;
    let shape = StrandShape { guides: count, follows: 0, vertices: 2 };
    let buffers = StrandBuffers::new(backend, shape, Vec3::ZERO).unwrap();
    // Additive recurrences of the golden ratio and of the square root of 2.
    let fibre = |i: u32| [1.618_034, std::f32::consts::SQRT_2].map(|step| (i as f32 * step).fract());
    let end = |x: f32, [y, z]: [f32; 2]| [x, 2.0 * y - 1.0, 0.8 + 0.4 * z, 1.0];
    let positions: Vec<[f32; 4]> =
        [-1.0, 1.0].into_iter().flat_map(|x| (0..count).map(move |i| end(x, fibre(i)))).collect();
    list.upload(buffers.positions, 0, &positions);
    list.upload(buffers.tangents, 0, &vec![[1.0f32, 0.0, 0.0, 0.0]; 2 * count as usize]);
    list.upload(buffers.thickness, 0, &vec![1.0f32; 2 * count as usize]);
    let ends = |i: usize| [positions[i], positions[count as usize + i]].map(|[x, y, z, _]| Vec3::new(x, y, z));
    let sample = (0..count as usize).map(|i| (ends(i), [1.0; 2])).collect();
    let reach = (Vec3::ZERO, f32::INFINITY);
    (buffers, StrandInfo { metres_per_unit: 1.0, fitting_radius: radius, sample, bends: Bends::default(), reach })
}

#[test]
fn hair_before_a_light_leaves_the_scene_what_its_fibres_do_not_take() {
    let Some(mut backend) = gpu() else { return };
    let mut list = PassList::new();
    let ball = Mesh::ellipsoid(&Ellipsoid { center: Vec3::ZERO, radii: Vec3::splat(0.5) }, 32);
    let ball = SceneMesh::new(&mut backend, &mut list, &ball).unwrap();
    let draws = [MeshDraw { mesh: &ball, surface: Surface::default(), pose: Pose::IDENTITY }];
    let mut texture = |format| backend.create_texture(&TextureDesc::new("target", SIZE, format)).unwrap();
    let targets = Targets::new(texture(Format::Rgba16F), texture(Format::Depth32F));
    let camera = Camera { eye: Vec3::Z * 3.0, target: Vec3::ZERO, fov: 0.6, ..Camera::around(&[Vec3::ONE], SIZE) };
    let view = Camera { near: 0.05, far: 50.0, ..camera }.view(SIZE).unwrap();
    let scene = ScenePass::new(&mut backend, Format::Rgba16F, view.depth(), true).unwrap();
    let (buffers, info) = curtain(&mut backend, &mut list, 4.0, 0.001);
    let section = ShadedStrands::new(&mut backend, buffers, info).unwrap();
    let mut renderer = HairRenderer::new(&mut backend, &RenderDesc::new(SIZE, Format::Rgba16F)).unwrap();
    let mut brightness = |shadow_alpha: f32, casts: bool| {
        let material = Material::default().with(|m| m.shadow_alpha = shadow_alpha);
        let light = Light::directional(Vec3::Z, Vec3::ONE).casts(casts);
        let lights = Lights { lights: vec![light], ..Lights::default() };
        renderer.cast(&mut list, &lights, &[SectionDraw::new(&section, &material, Pose::IDENTITY)]).unwrap();
        let shadows = renderer.shadow_bindings();
        let opaque = Scene { backdrop: Backdrop::default(), meshes: &draws, shadows: &shadows };
        scene.draw(&mut list, &view, &lights, &targets, &opaque).unwrap();
        let ticket = list.read_texture(targets.color);
        backend.run(&list).unwrap();
        list = PassList::new();
        let bytes = backend.read(ticket).ready().expect("it has run");
        // The middle of the ball, which the light faces.
        let texels = (24..40).flat_map(|y| (40..56).map(move |x| 8 * (y * SIZE[0] as usize + x)));
        texels.map(|at| half::f16::from_le_bytes([bytes[at], bytes[at + 1]]).to_f64()).sum::<f64>()
    };
    let open = brightness(0.3, false);
    assert!(open > 1.0 && brightness(0.0, true) == open, "fibres that take nothing");
    for alpha in [0.1, 0.3, 0.6] {
        let (share, expected) = (brightness(alpha, true) / open, f64::from(-4.0 * alpha).exp());
        eprintln!("{alpha}: {share:.4}, {expected:.4} expected");
        assert!((share / expected - 1.0).abs() < 0.06, "{alpha}: {share} is not {expected}");
    }
}
