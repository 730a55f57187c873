//! Tiles in which light passes 4 or 16 places of a pixel for themselves.

mod support;

use glam::{DVec4, Vec3};
use tressfx_conformance::render::{Difference, Groom, Picture, Screen, Setup};
use tressfx_core::backend::Format;
use tressfx_core::null::NullBackend;
use tressfx_render::{HairRenderer, Material, RenderDesc, TilesDesc, reference};

use support::hair::{faint, varied};
use support::screen;

fn at_places(places: u32) -> impl Fn(&mut Setup) {
    move |setup| setup.technique = TilesDesc::default().closed_below(0.0).places(places).into()
}

fn area(pixels: &[DVec4]) -> f64 {
    pixels.iter().map(|pixel| pixel.w).sum()
}

#[test]
fn loose_dense_and_faint_hair_is_as_in_exact_order() {
    let grooms = [
        ("loose", Groom::wavy(60, 12, 1, varied()), [96, 64]),
        ("dense", Groom::wavy(1500, 16, 3, varied()), [96, 64]),
        ("faint", Groom::wavy(6000, 16, 4, faint()), [48, 32]),
    ];
    // Opacities of 16 places have 8 bits.
    let allowed = [(4, 85.0), (16, 82.0)];
    for ((name, groom, size), (places, least)) in grooms.iter().flat_map(|of| allowed.map(|to| (of, to))) {
        let Some(mut screen) = screen(|setup| {
            at_places(places)(setup);
            setup.size = *size;
        }) else {
            return;
        };
        let (picture, far) = (screen.hair(&[groom]), screen.view.depth().far());
        let exact = reference::exact_at_places(&screen.view, &screen.lights, &[groom.reference()], &|_| far, places);
        let difference = picture.difference(&exact);
        let to_one = Difference::between(&screen.exact(&[groom]), &exact);
        eprintln!("{name}, {places}: {difference:?}; one place in f64: {to_one:?}");
        assert!(difference.max < 0.002 && difference.psnr > least, "{name}, {places}: {difference:?}");
        assert!(*name == "faint" || to_one.psnr < 50.0, "{name}: it is another picture, {to_one:?}");
        assert!(screen.hair(&[groom]).bytes == picture.bytes, "{name}: the same bits again");
    }
}

/// Opaque fibres of a width in pixels, where the grooms are.
fn opaque(pixels_per_unit: f32, width: f32) -> Material {
    Material::default().with(|m| {
        m.fibre_radius = Some(0.5 * width / pixels_per_unit);
        (m.opacity, m.tip_opacity, m.tip_width) = (1.0, 1.0, 1.0);
    })
}

#[test]
fn what_lies_behind_a_strand_is_not_seen_through_its_edge() {
    // With more places it is less.
    for (places, share) in [(4, 0.75), (16, 0.4)] {
        let Some(mut screen) = screen(at_places(places)) else { return };
        behind_each_other(&mut screen, places, share);
    }
}

/// What three strands behind each other cover more than one is at most this share of what it would be with one opacity a pixel.
fn behind_each_other(screen: &mut Screen, places: u32, share: f64) {
    let pixels_per_unit = screen.view.lens().focal.x / 3.0;
    for degrees in [0.0, 17.0, 45.0f32] {
        let along = 0.5 * glam::Vec2::from_angle(degrees.to_radians()).extend(0.0);
        let strand = |z: f32| {
            let scale = (3.0 - z) / 3.0;
            [-1.0, 1.0].map(|end| (end * along) * scale + Vec3::new(0.003 * scale, 0.007 * scale, z)).to_vec()
        };
        let alone = Groom::new(&[strand(0.0)], opaque(pixels_per_unit, 0.8));
        let double = Groom::new(&[strand(0.0), strand(-0.01), strand(-0.02)], opaque(pixels_per_unit, 0.8));
        let one = screen.hair(&[&alone]).pixels();
        let excess = |pixels: &[DVec4]| area(pixels) / area(&one) - 1.0;
        let found = excess(&screen.hair(&[&double]).pixels());
        let as_if_apart: Vec<_> = one.iter().map(|pixel| 1.0 - (1.0 - *pixel).powf(3.0)).collect();
        let apart = excess(&as_if_apart);
        eprintln!(
            "{places} places, {degrees} degrees: three behind each other cover {found:.3} more than one; with one opacity a pixel {apart:.3}"
        );
        assert!(found < share * apart, "{found} {apart}");
    }
}

#[test]
fn a_strand_alone_is_as_with_one_place() {
    let Some(mut one) = screen(|setup| setup.technique = TilesDesc::default().closed_below(0.0).into()) else { return };
    let pixels_per_unit = one.view.lens().focal.x / 3.0;
    for (width, number, most) in [0.05, 0.7, 3.0].into_iter().flat_map(|width| [(width, 4, 0.001), (width, 16, 0.002)])
    {
        let Some(mut places) = screen(at_places(number)) else { return };
        let strand = (0..7).map(|i| Vec3::new(0.1 * i as f32 - 0.3, 0.043 * i as f32 - 0.1, 0.0)).collect();
        let groom = Groom::new(&[strand], opaque(pixels_per_unit, width));
        let pictures: [Picture; 2] = [&mut one, &mut places].map(|screen| screen.hair(&[&groom]));
        let difference = pictures[0].difference(&pictures[1].pixels());
        eprintln!("{width} pixels wide, {number} places: {difference:?}");
        assert!(area(&pictures[0].pixels()) > 20.0 * f64::from(width) && difference.max < most, "{difference:?}");
    }
}

#[test]
fn other_numbers_of_places_are_refused() {
    let mut backend = NullBackend::default();
    for places in [0, 2, 3, 5, 8, 17] {
        let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(TilesDesc::default().places(places));
        let error = HairRenderer::new(&mut backend, &desc).unwrap_err().to_string();
        assert!(error.contains("1, 4 or 16"), "{error}");
    }
    let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(TilesDesc::default());
    let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
    let error = renderer.retune(&mut backend, TilesDesc::default().places(4)).unwrap_err().to_string();
    assert!(error.contains("need a new renderer"), "{error}");
}
