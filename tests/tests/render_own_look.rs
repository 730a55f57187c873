//! Colours and widths that strands bring along.

mod support;

use glam::Vec3;
use tressfx_conformance::render::{Groom, Random, Screen, Setup};
use tressfx_conformance::run_and_read;
use tressfx_conformance::scene::lights;
use tressfx_conformance::sim::{random_asset, strands_of};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::{Backend, Format, TextureDesc};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{Command, Load, PassList, RasterPass};
use tressfx_core::shader::{Bindings, Shader};
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_render::{
    ColorTexture, DrawError, Fill, HairRenderer, Material, OwnLook, PpllDesc, RenderDesc, SectionDraw, ShadedStrands,
    ShortCutDesc, Targets, Technique, TilesDesc, VELOCITY_FORMAT, ViewDraw,
};

use support::hair::{is_sound, material};
use support::screen;

/// Wavy strands whose vertices are 0 to 2 times as wide as the mean.
fn uneven(material: Material) -> Groom {
    let wavy = Groom::wavy(60, 12, 1, material);
    let (guides, vertices) = (wavy.shape.guides as usize, wavy.shape.vertices as usize);
    let order = (0..guides).flat_map(|guide| (0..vertices).map(move |vertex| vertex * guides + guide));
    let points = order.map(|i| Vec3::from_slice(&wavy.positions[i]).to_array()).collect();
    let mut random = Random(3);
    let asset = HairAsset {
        vertex_thickness: Some((0..guides * vertices).map(|_| 0.03 * random.unit()).collect()),
        ..HairAsset::new("uneven", AssetFormat::Hair, points, vec![vertices as u32; guides])
    };
    let strands = Strands::new(&asset, &StrandOptions { shuffle: false, ..StrandOptions::default() }).unwrap();
    Groom { info: wavy.info, ..Groom::of(&strands, material) }
}

fn tapered(tip_width: f32) -> Material {
    material().with(|m| (m.tip_width, m.fibre_radius) = (tip_width, Some(0.01)))
}

#[test]
fn widths_are_drawn_as_in_f64_by_each_technique_and_with_any_taper() {
    let (lists, layers) = (PpllDesc::default().k(32), ShortCutDesc::default().k(8).ordered(true));
    let techniques: [Technique; 3] = [lists.into(), TilesDesc::default().into(), layers.into()];
    for technique in techniques {
        let Some(mut screen) = screen(|setup| setup.technique = technique) else { return };
        for tip_width in [0.2, 0.9] {
            let groom = uneven(tapered(tip_width));
            let picture = screen.hair(&[&groom]);
            let difference = picture.difference(&screen.exact(&[&groom]));
            let even = Groom { own: OwnLook::default(), thickness: vec![1.0; 720], ..groom.clone() };
            let other = picture.difference(&screen.exact(&[&even]));
            eprintln!("{technique:?}, {tip_width}: {difference:?}, with even widths {other:?}");
            assert!(difference.psnr > 45.0 && other.psnr < 30.0, "{technique:?}: {difference:?}, {other:?}");
        }
    }
}

/// A picture of strands that have been placed before.
fn drawn(
    screen: &mut Screen,
    mut list: PassList,
    strands: &ShadedStrands,
    material: &Material,
    groom: &Groom,
) -> Vec<u8> {
    let targets = screen.targets();
    let clear = RasterPass::new("test.clear").color(targets.color, Load::Clear([0.0; 4]));
    list.raster(clear.depth(targets.depth, Load::Clear(screen.view.depth().far())));
    let view = ViewDraw::new(&screen.view, &screen.lights, targets);
    let draw = SectionDraw::new(strands, material, groom.pose);
    screen.renderer.grow_to_predicted(&mut *screen.backend, &screen.view, &[draw]).unwrap();
    screen.renderer.draw(&mut list, &[view], &[draw]).unwrap();
    let ticket = list.read_texture(targets.color);
    run_and_read(&mut *screen.backend, &list, ticket)
}

#[test]
fn a_taper_that_changes_is_drawn_in_that_frame_and_widths_are_uploaded_when_it_does() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = uneven(tapered(0.9));
    let mut first = PassList::new();
    let strands = screen.section(&mut first, &groom);
    let blunt = drawn(&mut screen, first, &strands, &tapered(0.9), &groom);
    assert!(blunt == screen.hair(&[&groom]).bytes);
    let thin = drawn(&mut screen, PassList::new(), &strands, &tapered(0.2), &groom);
    assert!(thin == screen.hair(&[&uneven(tapered(0.2))]).bytes && thin != blunt);
    let uploads = |screen: &mut Screen, material: &Material| {
        let mut list = PassList::new();
        let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
        let draw = SectionDraw::new(&strands, material, groom.pose);
        screen.renderer.draw(&mut list, &[view], &[draw]).unwrap();
        list.bytes().len()
    };
    let again = uploads(&mut screen, &tapered(0.2));
    assert_eq!(uploads(&mut screen, &tapered(0.3)), again + 4 * 720);
    assert_eq!(uploads(&mut screen, &tapered(0.3)), again);
}

#[test]
fn a_look_that_comes_later_is_drawn_from_then_on() {
    let Some(mut screen) = screen(|setup| setup.own_colors = true) else { return };
    let plain = Groom { own: OwnLook::default(), thickness: vec![1.0; 720], ..uneven(tapered(0.9)) };
    let own = uneven(tapered(0.9)).own.with_colors(vec![[0.1, 0.6, 0.2, 0.8]; 720]);
    let coloured = Groom { own: own.clone(), ..plain.clone() };
    let expected = [&plain, &coloured].map(|groom| screen.hair(&[groom]).bytes);
    let mut list = PassList::new();
    let strands = screen.section(&mut list, &plain);
    let before = drawn(&mut screen, list, &strands, &plain.material, &plain);
    let mut list = PassList::new();
    let strands = strands.with_own_look(&mut *screen.backend, &mut list, &own).unwrap();
    let after = drawn(&mut screen, list, &strands, &plain.material, &plain);
    assert!(before == expected[0] && after == expected[1] && before != after);
}

#[test]
fn what_nobody_brings_along_has_no_kernel_and_no_buffer() {
    let Some(mut plain) = screen(|_| ()) else { return };
    let Some(mut knowing) = screen(|setup| setup.own_colors = true) else { return };
    let groom = Groom::wavy(60, 12, 1, material());
    assert!(plain.hair(&[&groom]).bytes == knowing.hair(&[&groom]).bytes);
    let kernels = |own_colors: bool| {
        let mut backend = NullBackend::default();
        let desc = RenderDesc::new([64, 64], Format::Rgba16F).own_colors(own_colors);
        HairRenderer::new(&mut backend, &desc).unwrap();
        backend.shaders.iter().filter(|shader| shader.slots.iter().any(|slot| slot.name == "own_colors")).count()
    };
    assert_eq!([false, true].map(kernels), [0, 4]);
    let before = plain.backend.memory().bytes;
    let section = plain.section(&mut PassList::new(), &groom);
    let without = plain.backend.memory().bytes - before;
    section.destroy(&mut *plain.backend);
    let before = plain.backend.memory().bytes;
    let own = OwnLook::default().with_colors(vec![[0.5; 4]; groom.positions.len()]);
    plain.section(&mut PassList::new(), &Groom { own, ..groom.clone() });
    let with = plain.backend.memory().bytes - before;
    assert_eq!(with - without, 8 * groom.positions.len() as u64);
}

#[test]
fn colours_that_the_renderer_does_not_know_of_are_refused() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = Groom::wavy(20, 8, 1, material());
    let own = OwnLook::default().with_colors(vec![[0.5; 4]; 160]);
    let mut list = PassList::new();
    let section = screen.section(&mut list, &Groom { own, ..groom.clone() });
    let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
    let draw = SectionDraw::new(&section, &groom.material, groom.pose);
    let mut list = PassList::new();
    let error = screen.renderer.draw(&mut list, &[view], &[draw]).unwrap_err();
    assert_eq!((error, list.passes().count()), (DrawError::OwnColors, 0));
}

#[test]
fn textures_colour_strands_by_their_roots_and_along_them() {
    let mut asset = random_asset(4, 5, 2);
    asset.strand_uvs = Some(vec![[0.25, 0.5], [0.75, 0.5], [f32::MAX, -3.5], [1.75, -0.5]]);
    let strands = strands_of(asset, 1);
    let halves = ColorTexture::new([2, 1], vec![[255, 0, 0, 255], [0, 0, 255, 128]]).unwrap();
    let look = OwnLook::of(&strands);
    assert!(look.is_empty());
    let by_root = look.clone().with_root_texture(&strands, &halves).unwrap();
    let colors = by_root.colors().unwrap();
    let guide_of = |strand: u32| strands.order.iter().position(|&of| of == strand).unwrap();
    for vertex in 0..5 {
        let at = |strand: u32| colors[4 * vertex + guide_of(strand)];
        assert_eq!([at(0), at(1), at(3)], [[1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 128.0 / 255.0], at(1)]);
    }
    let along = look.with_strand_texture(&strands, &halves);
    let colors = along.colors().unwrap();
    for guide in 0..4 {
        let at = |vertex: usize| colors[4 * vertex + guide];
        assert_eq!([at(0)[..3].to_vec(), at(4)[..3].to_vec()], [vec![1.0, 0.0, 0.0], vec![0.0, 0.0, 1.0]]);
        assert_eq!(at(2)[..3], [0.5, 0.0, 0.5]);
    }
    let both = by_root.with_strand_texture(&strands, &halves);
    assert_eq!(both.colors().unwrap()[guide_of(0)], [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(both.colors().unwrap()[guide_of(1)][..3], [0.0; 3], "blue times red");
    let bald = strands_of(random_asset(4, 5, 2), 0);
    let error = OwnLook::default().with_root_texture(&bald, &halves).unwrap_err();
    assert!(error.to_string().contains("random 2: its strands have no texture coordinates"), "{error}");
}

#[test]
fn what_files_leave_where_nobody_chose_is_nothing() {
    let with = |change: &dyn Fn(&mut HairAsset)| {
        let mut asset = random_asset(4, 5, 2);
        change(&mut asset);
        OwnLook::of(&strands_of(asset, 0))
    };
    assert!(with(&|asset| asset.vertex_colors = Some(vec![[1.0; 4]; 20])).is_empty());
    assert!(with(&|asset| asset.vertex_colors = Some(vec![[1.0, 1.0, 1.0, 0.0]; 20])).is_empty());
    assert!(with(&|asset| asset.strand_thickness = Some(vec![0.0; 4])).is_empty());
    assert!(with(&|asset| asset.strand_thickness = Some(vec![0.3; 4])).is_empty());
    let clear = with(&|asset| asset.vertex_transparency = Some(vec![0.75; 20]));
    assert!(!clear.has_color() && clear.colors().unwrap()[7] == [1.0, 1.0, 1.0, 0.25]);
    let red = with(&|asset| asset.vertex_colors = Some(vec![[0.5, 0.0, 0.0, 0.0]; 20]));
    let linear = red.colors().unwrap()[0];
    assert!(red.has_color() && (linear[0] - 0.214_041).abs() < 1e-5 && linear[3] == 1.0, "{linear:?}");
    // One strand that is a thousand times as wide as the others is not drawn across the whole picture.
    let wide = with(&|asset| asset.strand_thickness = Some(vec![1e-3, 1e-3, 1e-3, 1e30]));
    assert!(wide.thickness(1.0).unwrap().iter().all(|&share| (0.0..=16.0).contains(&share)));
}

#[test]
fn numbers_that_are_none_draw_no_such_pixels() {
    let Some(mut screen) = screen(|setup| setup.own_colors = true) else { return };
    let groom = Groom::wavy(60, 12, 1, material());
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 1e30, 0.5];
    let colors = (0..720).map(|i| [0, 1, 2, 3].map(|part| wild[(i + part * 5) % wild.len()])).collect();
    let own = OwnLook::default().with_colors(colors);
    let picture = screen.hair(&[&Groom { own: own.clone(), ..groom.clone() }]);
    assert!(is_sound(&picture) && picture.counters.pixels_with_hair > 100);
    for bad in wild {
        let spoilt = material().with(|m| (m.own_colors, m.tip_start, m.hue_variation) = (bad, bad, bad));
        assert_eq!(spoilt.validate().is_ok(), bad == 0.5);
        let groom = Groom { own: own.clone(), material: spoilt, ..groom.clone() };
        assert!(is_sound(&screen.hair(&[&groom])), "{bad}");
    }
}

#[test]
fn every_pass_takes_the_widths_that_strands_bring_along() {
    let layers = ShortCutDesc::default();
    let techniques: [Technique; 5] = [
        PpllDesc::default().cap(4).into(),
        PpllDesc::default().fill(Fill::Raster).into(),
        layers.into(),
        layers.ordered(true).into(),
        TilesDesc::default().into(),
    ];
    let groom = uneven(material());
    for technique in techniques {
        let mut backend = NullBackend::default();
        let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(technique).velocity_output(true);
        let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
        let mut texture = |format| backend.create_texture(&TextureDesc::new("target", [64, 64], format)).unwrap();
        let targets = Targets::new(texture(Format::Rgba16F), texture(Format::Depth32F));
        let targets = targets.velocity(texture(VELOCITY_FORMAT));
        let (buffers, mut list) = (StrandBuffers::new(&mut backend, groom.shape, Vec3::ZERO).unwrap(), PassList::new());
        let strands = ShadedStrands::new(&mut backend, buffers, groom.info.clone()).unwrap();
        let strands = strands.with_past(&mut backend).unwrap();
        let strands = strands.with_own_look(&mut backend, &mut list, &groom.own).unwrap();
        let (view, lights) = (Setup::default().camera.view([64, 64]).unwrap(), lights());
        let draw = SectionDraw::new(&strands, &groom.material, groom.pose);
        renderer.grow_to_predicted(&mut backend, &view, &[draw]).unwrap();
        renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap();
        let mut taking = 0;
        for (label, command) in list.passes() {
            let bound: Vec<(&Shader, &Bindings)> = match command {
                Command::Compute(pass) => vec![(&pass.kernel.shader, &pass.bindings)],
                Command::Raster(pass) => {
                    pass.draws.iter().map(|draw| (&*draw.pipeline.shader, &draw.bindings)).collect()
                }
                _ => Vec::new(),
            };
            for (shader, bindings) in bound {
                assert!(!bindings.names(buffers.thickness.into()), "{technique:?}: {label} takes the simulated ones");
                taking += usize::from(shader.slots.iter().any(|slot| slot.name == "thickness"));
            }
        }
        assert!(taking >= 5, "{technique:?}: shadows, fragments and motion, but {taking} passes");
    }
}

#[test]
fn a_look_of_other_strands_is_refused() {
    let mut backend = NullBackend::default();
    let groom = Groom::wavy(4, 5, 1, material());
    let buffers = StrandBuffers::new(&mut backend, groom.shape, Vec3::ZERO).unwrap();
    let before = backend.memory().bytes;
    let strands = ShadedStrands::new(&mut backend, buffers, groom.info).unwrap();
    let look = OwnLook::default().with_colors(vec![[0.5; 4]; 3]);
    let error = strands.with_own_look(&mut backend, &mut PassList::new(), &look).unwrap_err().to_string();
    assert!(error.contains("a look for 3 vertices, the guides have 20"), "{error}");
    assert_eq!(backend.memory().bytes, before, "the strands are freed");
}
