//! Copies of strands: they are drawn as strands of their own would be, by every technique, and take no memory beside the strands.

mod support;

use glam::Vec3;
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_conformance::render::{Groom, Screen, Setup};
use tressfx_core::backend::{Backend, Format, TextureDesc};
use tressfx_core::hash::hash;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::view::{Camera, Pose};
use tressfx_render::{
    AutoDesc, Fill, HairRenderer, Light, Lights, Lod, Material, PpllDesc, RenderDesc, SectionDraw, ShadedStrands,
    ShadowDesc, ShortCutDesc, Targets, Technique, TilesDesc, ViewDraw,
};

use support::{gpu, screen};

const STRANDS: u32 = 60;
const COPIES: u32 = 4;
const SPREAD: f32 = 0.05;

/// Strands that change their colour on the way to the tip, and look the same from everywhere.
fn material() -> Material {
    Material::default().with(|m| {
        (m.copies, m.copy_spread) = (COPIES, SPREAD);
        m.fibre_radius = Some(0.004);
        (m.base_color, m.tip_color) = (Vec3::new(0.9, 0.2, 0.1), Vec3::new(0.1, 0.3, 0.9));
        (m.variation, m.tilt_variation) = (0.0, 0.0);
        (m.primary.strength, m.secondary.strength) = (0.0, 0.0);
    })
}

fn groom() -> Groom {
    Groom::wavy(STRANDS, 11, 8, material())
}

/// The same with the copies as strands of the groom, behind the others and in their order.
fn written_out(groom: &Groom) -> Groom {
    let row = groom.shape.strands() as usize;
    let repeated = |values: &[[f32; 4]]| -> Vec<[f32; 4]> {
        values.chunks(row).flat_map(|row| row.repeat(COPIES as usize)).collect()
    };
    let mut positions = repeated(&groom.positions);
    for (place, position) in positions.iter_mut().enumerate() {
        let strand = place % (row * COPIES as usize);
        if strand >= row {
            let random = |axis: usize| 2.0 * hash((3 * strand + axis) as u32) as f32 - 1.0;
            (0..3).for_each(|axis| position[axis] += SPREAD * random(axis));
        }
    }
    Groom {
        shape: StrandShape { follows: COPIES - 1, ..groom.shape },
        positions,
        tangents: repeated(&groom.tangents),
        material: groom.material.with(|m| m.copies = 1),
        ..groom.clone()
    }
}

fn even_light(screen: &mut Screen) {
    (screen.lights.sky, screen.lights.ground) = (Vec3::ONE, Vec3::splat(0.4));
    screen.lights.lights = Vec::<Light>::new();
}

fn techniques() -> Vec<Technique> {
    let (lists, layers) = (PpllDesc::default(), ShortCutDesc::default());
    vec![
        lists.into(),
        lists.fill(Fill::Raster).into(),
        layers.into(),
        layers.ordered(true).fill(Fill::Raster).into(),
        TilesDesc::default().into(),
        AutoDesc::default().into(),
    ]
}

#[test]
fn copies_are_drawn_as_strands_of_their_own() {
    for technique in techniques() {
        let Some(wgpu) = gpu() else { return };
        let mut pictures = Vec::new();
        for backend in [wgpu as Box<dyn tressfx_core::backend::Run>, Box::new(VulkanBackend::headless().unwrap())] {
            let mut screen =
                Screen::new(backend, |setup: &mut Setup| (setup.technique, setup.copies) = (technique, true));
            even_light(&mut screen);
            for (share, step) in [(1.0, 1), (0.83, 1), (0.25, 2), (0.1, 1)] {
                let few = Groom { lod: Lod { share, step }, ..groom() };
                let found = screen.hair(&[&few]);
                let expected = screen.hair(&[&written_out(&few)]);
                assert!(expected.pixels().iter().filter(|pixel| pixel.w > 0.0).count() > 500, "there is hair");
                let difference = found.difference(&expected.pixels());
                assert!(found.bytes == expected.bytes, "{technique:?}, {share}: {difference:?}");
                pictures.push(found.bytes);
            }
        }
        let (one, other) = pictures.split_at(pictures.len() / 2);
        assert!(one == other, "{technique:?}: the backends differ");
    }
}

#[test]
fn pictures_are_as_in_f64() {
    let Some(mut screen) = screen(|setup| (setup.technique, setup.copies) = (TilesDesc::default().into(), true)) else {
        return;
    };
    let material = material().with(|m| (m.variation, m.secondary.strength) = (0.5, 1.0));
    let groom = Groom { lod: Lod { share: 0.8, step: 1 }, ..Groom::wavy(STRANDS, 11, 8, material) };
    let difference = screen.hair(&[&groom]).difference(&screen.exact(&[&groom]));
    eprintln!("{difference:?}");
    assert!(difference.psnr > 70.0, "{difference:?}");
}

#[test]
fn copies_throw_the_shadow_of_strands_and_take_no_memory() {
    let shadows = |setup: &mut Setup| (setup.shadows, setup.copies) = (Some(ShadowDesc::default()), true);
    let Some(mut screen) = screen(shadows) else { return };
    let with = |copies: u32| Groom { material: material().with(|m| m.copies = copies), ..groom() };
    let brightness = |screen: &mut Screen, groom: &Groom| {
        let pixels = screen.hair(&[groom]).pixels();
        let light: f64 = pixels.iter().map(|pixel| pixel.truncate().element_sum()).sum();
        light / pixels.iter().map(|pixel| pixel.w).sum::<f64>()
    };
    let written_out = brightness(&mut screen, &written_out(&groom()));
    // Copies have the light that arrives at their strand.
    let (alone, copied) = (brightness(&mut screen, &with(1)), brightness(&mut screen, &with(COPIES)));
    println!("brightness {alone:.4} alone, {copied:.4} with copies, {written_out:.4} with strands of their own");
    assert!((copied / written_out - 1.0).abs() < 0.01 && copied < 0.95 * alone);
    let bytes = [1, 32].map(|copies| {
        let before = screen.backend_memory();
        let section = screen.section(&mut PassList::new(), &with(copies));
        let bytes = screen.backend_memory() - before;
        drop(section);
        bytes
    });
    assert_eq!(bytes[0], bytes[1], "copies take no memory beside the strands");
}

#[test]
fn more_vertices_than_can_be_counted_are_refused() {
    let mut caps = NullBackend::default().caps().clone();
    (caps.max_storage_binding_bytes, caps.max_buffer_bytes) = (1 << 40, 1 << 40);
    let mut backend = NullBackend::new(caps);
    let desc = RenderDesc::new([64, 64], Format::Rgba16F).copies(true);
    let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
    let mut texture = |format| backend.create_texture(&TextureDesc::new("test", [64, 64], format)).unwrap();
    let targets = Targets::new(texture(Format::Rgba16F), texture(Format::Depth32F));
    let (groom, lights) = (groom(), Lights::default());
    let view = Camera::around(&[Vec3::ZERO, Vec3::ONE], [64, 64]).view([64, 64]).unwrap();
    for (guides, copies, can_be_drawn) in [(1 << 20, 21, true), (1 << 20, 22, false), (1 << 24, 32, false)] {
        let shape = StrandShape { guides, follows: 0, vertices: 32 };
        let buffers = StrandBuffers::new(&mut backend, shape, Vec3::ZERO).unwrap();
        let section = ShadedStrands::new(&mut backend, buffers, groom.info.clone()).unwrap();
        let material = material().with(|m| m.copies = copies);
        let draw = SectionDraw::new(&section, &material, Pose::IDENTITY);
        let room = renderer.grow_to_predicted(&mut backend, &view, &[draw]).map_err(|error| error.to_string());
        let views = [ViewDraw::new(&view, &lights, targets)];
        let drawn = renderer.draw(&mut PassList::new(), &views, &[draw]).map_err(|error| error.to_string());
        let vertices = u64::from(guides) * 32 * u64::from(copies);
        for result in [room, drawn] {
            match result {
                Ok(()) => assert!(can_be_drawn, "{vertices}"),
                Err(error) => assert!(!can_be_drawn && error.contains(&vertices.to_string()), "{vertices}: {error}"),
            }
        }
    }
}

#[test]
fn a_renderer_that_knows_of_no_copies_says_so() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = groom();
    let mut list = PassList::new();
    let section = screen.section(&mut list, &groom);
    let (view, lights, targets) = (screen.view, screen.lights.clone(), screen.targets());
    let draw = SectionDraw::new(&section, &groom.material, groom.pose);
    let error = screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap_err();
    assert!(error.to_string().contains("RenderDesc::copies"), "{error}");
    for (copies, spread) in [(0, 0.0), (33, 0.0), (u32::MAX, 0.0), (2, -1.0), (2, f32::NAN)] {
        let material = groom.material.with(|m| (m.copies, m.copy_spread) = (copies, spread));
        let draw = SectionDraw::new(&section, &material, groom.pose);
        let error = screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap_err();
        assert!(error.to_string().contains("1 to 32"), "{error}");
    }
}

#[test]
fn a_copy_that_reaches_into_the_picture_is_drawn() {
    let Some(mut screen) = screen(|setup| setup.copies = true) else { return };
    let mut drawn = |copies: u32, to_the_right: f32| {
        let material = material().with(|m| (m.copies, m.copy_spread) = (copies, 0.1));
        let mut groom = Groom::new(&[vec![Vec3::ZERO, Vec3::Y * 0.1]], material);
        groom.info.reach = (Vec3::ZERO, 0.1);
        groom.pose.translation = Vec3::X * to_the_right;
        let mut list = PassList::new();
        let section = screen.section(&mut list, &groom);
        let (view, lights, targets) = (screen.view, screen.lights.clone(), screen.targets());
        let draw = SectionDraw::new(&section, &groom.material, groom.pose);
        screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap();
        screen.renderer.drawn().sections == 1
    };
    let edge = 0.5 * 96.0 / screen_focal();
    assert!(!drawn(1, edge + 0.25) && drawn(2, edge + 0.25) && !drawn(2, edge + 0.6));
}

/// Pixels of a unit at the distance of the origin, of the default screen.
fn screen_focal() -> f32 {
    32.0 / 0.3f32.tan() / 3.0
}
