//! Hair laid over the picture by a compute pass: as fragment shaders lay it there, on both backends to the bit.

mod support;

use glam::camera::rh;
use glam::{DVec4, Vec3};
use tressfx_conformance::render::{Difference, Groom, Picture, Screen};
use tressfx_core::backend::{Caps, DepthOrder, Format, Run, TextureDesc};
use tressfx_core::error::{Error, Need};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::view::{Pose, View, Viewport};
use tressfx_render::{
    AutoDesc, HairRenderer, PpllDesc, RenderDesc, SectionDraw, ShortCutDesc, Targets, Technique, TilesDesc, ViewDraw,
    reference,
};

use support::backends;
use support::hair::{varied, wall};

/// Neither is a multiple of the edge of a tile.
const SIZE: [u32; 2] = [94, 61];

/// A place behind all hair.
const BEHIND: f32 = -2.0;

fn techniques() -> [Technique; 5] {
    let tiles = TilesDesc::default();
    [
        PpllDesc::default().into(),
        ShortCutDesc::default().into(),
        tiles.into(),
        tiles.places(4).into(),
        AutoDesc::default().into(),
    ]
}

fn screen(backend: Box<dyn Run>, technique: Technique, storage_target: bool) -> Screen {
    assert!(backend.caps().read_write_textures, "both backends can on every device of theirs");
    Screen::new(backend, |setup| {
        (setup.technique, setup.size, setup.storage_target) = (technique, SIZE, storage_target);
    })
}

/// Four half floats.
fn channels(bytes: &[u8]) -> DVec4 {
    let of = |channel: usize| half::f16::from_le_bytes([bytes[2 * channel], bytes[2 * channel + 1]]).to_f64();
    DVec4::new(of(0), of(1), of(2), of(3))
}

/// Two views side by side, of which neither begins or ends on a tile.
fn views() -> [View; 2] {
    let projection = rh::proj::directx::perspective(0.6, 0.8, 50.0, 0.05);
    [([0, 0], [45, 61], Vec3::Z), ([45, 3], [43, 37], Vec3::new(2.5, 0.4, 1.0))].map(|(offset, size, eye)| {
        let to_eye = rh::view::look_at_mat4(eye.normalize() * 3.0, Vec3::ZERO, Vec3::Y);
        let viewport = Viewport::part(offset, size, SIZE).unwrap();
        View::new(to_eye, projection, DepthOrder::Reverse, viewport).unwrap()
    })
}

/// Hair before a wall, and from two sides at once.
fn pictures(screen: &mut Screen, groom: &Groom) -> [Picture; 2] {
    [screen.scene(&[&wall(-0.6, -0.4)], &[groom]), screen.views(&views(), &[groom])]
}

#[test]
fn the_picture_is_that_which_fragment_shaders_leave() {
    let groom = Groom::wavy(300, 16, 3, varied());
    for technique in techniques() {
        let mut all = Vec::new();
        for (backend, other) in backends().into_iter().zip(backends()) {
            let drawn = pictures(&mut screen(backend, technique, false), &groom);
            let written = pictures(&mut screen(other, technique, true), &groom);
            for (drawn, written) in drawn.iter().zip(&written) {
                assert_eq!(drawn.counters, written.counters, "{technique:?}");
                let covered = drawn.pixels().iter().filter(|pixel| pixel.w > 0.1).count();
                assert!(covered > 400, "{technique:?}: {covered} pixels have hair");
                let difference = Difference::between(&written.pixels(), &drawn.pixels());
                // One may round the sum once, the other each of its parts: a step of half floats below 1 is 0.0005.
                assert!(difference.max <= 0.001 && difference.psnr > 75.0, "{technique:?}: {difference:?}");
            }
            all.push(written.map(|picture| picture.bytes));
        }
        assert!(all.windows(2).all(|pair| pair[0] == pair[1]), "{technique:?}: both backends are the same to the bit");
    }
}

#[test]
fn hair_lies_over_the_picture_as_in_f64_and_the_rest_keeps_every_bit() {
    for backend in backends() {
        let mut screen = screen(backend, TilesDesc::default().into(), true);
        let bare = screen.scene(&[&wall(-0.6, BEHIND)], &[]);
        let groom = Groom::wavy(60, 16, 3, varied());
        // All of it is before the wall.
        let hair = screen.hair(&[&groom]);
        let haired = screen.scene(&[&wall(-0.6, BEHIND)], &[&groom]);
        let mut counts = [0, 0];
        for (i, hair) in hair.bytes.chunks(8).enumerate() {
            let [before, after] = [&bare, &haired].map(|picture| &picture.bytes[8 * i..8 * i + 8]);
            let has_hair = hair.iter().any(|&byte| byte != 0);
            assert!(has_hair || before == after, "pixel {i}");
            counts[usize::from(has_hair)] += 1;
            let [picture, hair, found] = [before, hair, after].map(channels);
            let off = (found - reference::composite_compute(picture, hair)).abs();
            // Half floats have eleven bits, and a driver may cut them off.
            assert!(off.cmple(found.abs() / 1024.0 + 1e-6).all(), "pixel {i}: {found} is off by {off}");
        }
        assert!(counts[0] > 2000 && counts[1] > 300, "{counts:?} pixels without and with hair");
        assert!(bare.bytes.iter().any(|&byte| byte != 0));
    }
}

#[test]
fn bytes_are_written_as_half_floats_are() {
    let groom = Groom::wavy(300, 16, 3, varied());
    for backend in backends() {
        let mut screen = screen(backend, TilesDesc::default().into(), true);
        let halves = screen.hair(&[&groom]).pixels();
        let backend = &mut *screen.backend;
        let color = TextureDesc::new("test.bytes", SIZE, Format::Rgba8).storage();
        let color = backend.create_texture(&color).unwrap();
        let depth = backend.create_texture(&TextureDesc::new("test.depth", SIZE, Format::Depth32F)).unwrap();
        let desc = RenderDesc::new(SIZE, Format::Rgba8).technique(TilesDesc::default()).shadows(None);
        screen.renderer = HairRenderer::new(backend, &desc.storage_target(true)).unwrap();
        let mut list = PassList::new();
        let section = screen.section(&mut list, &groom);
        let draw = SectionDraw::new(&section, &groom.material, groom.pose);
        screen.renderer.grow_to_predicted(&mut *screen.backend, &screen.view, &[draw]).unwrap();
        let view = ViewDraw::new(&screen.view, &screen.lights, Targets::new(color, depth));
        screen.renderer.draw(&mut list, &[view], &[draw]).unwrap();
        let ticket = list.read_texture(color);
        let bytes = tressfx_conformance::run_and_read(&mut *screen.backend, &list, ticket);
        let worst = bytes.chunks(4).zip(&halves).flat_map(|(texel, half)| {
            texel.iter().zip(half.to_array()).map(|(&byte, half)| (f64::from(byte) / 255.0 - half.min(1.0)).abs())
        });
        let worst = worst.fold(0.0, f64::max);
        assert!(bytes.iter().any(|&byte| byte > 100) && worst < 0.6 / 255.0, "{worst}");
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let mut caps = Caps::webgpu_default();
    caps.read_write_textures = true;
    let mut backend = NullBackend::new(caps);
    let mut refused = |desc: RenderDesc| HairRenderer::new(&mut backend, &desc).unwrap_err().to_string();
    for technique in techniques() {
        let of = |format| RenderDesc::new(SIZE, format).technique(technique).storage_target(true);
        let said = refused(of(Format::Bgra8Srgb));
        assert_eq!(said, "hair.render.composite_compute: Bgra8Srgb is no picture that a compute pass can write");
        let said = refused(of(Format::Rgba16F).hair_output(true));
        assert!(said.contains("depth and coverage of the hair are drawn"), "{said}");
    }
    let desc = RenderDesc::new(SIZE, Format::Rgba16F).storage_target(true);
    let error = HairRenderer::new(&mut NullBackend::default(), &desc).unwrap_err();
    assert!(matches!(error, Error::Unsupported { need: Need::ReadWriteTextures, .. }), "{error}");
}

#[test]
fn a_picture_that_compute_passes_may_not_write_is_named() {
    for backend in backends() {
        let mut screen = screen(backend, TilesDesc::default().into(), true);
        let groom = Groom::wavy(60, 16, 3, varied());
        let mut list = PassList::new();
        let section = screen.section(&mut list, &groom);
        let plain = TextureDesc::new("test.plain", SIZE, Format::Rgba16F);
        let color = screen.backend.create_texture(&plain).unwrap();
        let targets = Targets::new(color, screen.targets().depth);
        let draw = SectionDraw::new(&section, &groom.material, Pose::IDENTITY);
        let view = ViewDraw::new(&screen.view, &screen.lights, targets);
        screen.renderer.draw(&mut list, &[view], &[draw]).unwrap();
        let error = screen.backend.run(&list).unwrap_err().to_string();
        assert!(error.contains("picture") && error.contains("test.plain"), "{error}");
    }
}
