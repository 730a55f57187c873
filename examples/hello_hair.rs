//! Hair in a few lines: a built-in groom, a second of simulation, a picture.
//!
//! `cargo run --release -p tressfx-examples --example hello_hair -- [OUT.png [GROOM]]`

use anyhow::{Context, Result};
use tressfx_asset::builtin::Builtin;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::backend::{Backend, Format, Run, TextureDesc};
use tressfx_core::pass::PassList;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::{Camera, Pose};
use tressfx_render::{HairRenderer, Material, RenderDesc, SectionDraw, ShadedStrands, StrandInfo, Targets, ViewDraw};
use tressfx_sim::{Collider, HairSim, SectionDesc, SimParams, StepInput};
use tressfx_viewer::scene::{Backdrop, MeshDraw, Scene, SceneMesh, ScenePass, Surface, studio_lights};

const SIZE: [u32; 2] = [640, 640];
const FORMAT: Format = Format::Rgba8Srgb;

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let out = args.next().unwrap_or_else(|| String::from("hello_hair.png"));
    let groom = Builtin::parse(&args.next().unwrap_or_else(|| String::from("wavy")))?;
    let strands = Strands::new(&groom.asset(), &StrandOptions::default())?;
    let mut gpu = WgpuBackend::headless()?;

    // A second of simulation. Nothing runs before the backend is given the list.
    let mut list = PassList::new();
    let section = SectionDesc::new(&strands, SimParams::default());
    let colliders = Collider::all_with_head(&groom.capsules());
    let mut sim = HairSim::new(&mut gpu, &mut list, &[section], colliders.len())?;
    for _ in 0..60 {
        sim.step(&mut list, &StepInput::new(1.0 / 60.0, Pose::IDENTITY).with_colliders(&colliders))?;
    }

    // What is needed to draw it.
    let mut texture = |label, format| gpu.create_texture(&TextureDesc::new(label, SIZE, format));
    let targets = Targets::new(texture("color", FORMAT)?, texture("depth", Format::Depth32F)?);
    let view =
        Camera::around(&strands.rest.iter().map(|vertex| vertex.truncate()).collect::<Vec<_>>(), SIZE).view(SIZE)?;
    let (lights, material) = (studio_lights(), Material::default());
    let scene = ScenePass::new(&mut gpu, FORMAT, view.depth(), true)?;
    let head = SceneMesh::new(&mut gpu, &mut list, &groom.mesh())?;
    let hair = ShadedStrands::new(&mut gpu, sim.buffers()[0], StrandInfo::new(&strands))?;
    let mut renderer = HairRenderer::new(&mut gpu, &RenderDesc::new(SIZE, FORMAT))?;

    // The shadow of the hair, the head in it, and the hair over the head.
    let head = MeshDraw { mesh: &head, surface: Surface::default(), pose: Pose::IDENTITY };
    let draws = [SectionDraw::new(&hair, &material, sim.pose())];
    renderer.grow_to_predicted(&mut gpu, &view, &draws)?;
    renderer.cast(&mut list, &lights, &draws)?;
    let shadows = renderer.shadow_bindings();
    let opaque = Scene { backdrop: Backdrop::default(), meshes: &[head], shadows: &shadows };
    scene.draw(&mut list, &view, &lights, &targets, &opaque)?;
    renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &draws)?;
    let picture = list.read_texture(targets.color);

    gpu.run(&list)?;
    let texels = gpu.read(picture).ready().context("the list has run, so the picture is there")?;
    image::save_buffer(&out, &texels, SIZE[0], SIZE[1], image::ColorType::Rgba8)?;
    println!("{out}: {} strands on {}", strands.strand_count(), gpu.caps().adapter);
    Ok(())
}
