//! Tiles and lists in which light passes several places of a pixel for themselves.

mod support;

use glam::{DVec4, Vec3};
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_core::backend::Format;
use tressfx_core::null::NullBackend;
use tressfx_render::{
    Fill, HairRenderer, Material, PLACES, PpllDesc, RenderDesc, Tail, Technique, TilesDesc, reference,
};

use support::hair::{faint, varied};
use support::screen;

/// A technique with so many places, and how many of the nearest fragments of a pixel it puts in order.
type AtPlaces = fn(u32) -> (Technique, usize);

const TILES: AtPlaces = |places| (TilesDesc::default().closed_below(0.0).places(places).into(), usize::MAX);
const LISTS: AtPlaces = |places| (lists(places).into(), 8);
const RASTER_LISTS: AtPlaces = |places| (lists(places).fill(Fill::Raster).into(), 8);
const BOUNDED_LISTS: AtPlaces = |places| (lists(places).cap(8).into(), 8);
const TECHNIQUES: [(&str, AtPlaces); 4] =
    [("tiles", TILES), ("lists", LISTS), ("lists, raster", RASTER_LISTS), ("lists, bounded", BOUNDED_LISTS)];

fn lists(places: u32) -> PpllDesc {
    PpllDesc::default().places(places)
}

fn at(technique: AtPlaces, places: u32) -> impl Fn(&mut Setup) {
    move |setup| setup.technique = technique(places).0
}

fn area(pixels: &[DVec4]) -> f64 {
    pixels.iter().map(|pixel| pixel.w).sum()
}

/// A groom with its name and the size of its picture.
type Case<'a> = (&'a str, Groom, [u32; 2]);

#[test]
fn loose_dense_and_faint_hair_is_as_in_f64() {
    let grooms = [
        ("loose", Groom::wavy(60, 12, 1, varied()), [96, 64]),
        ("dense", Groom::wavy(1500, 16, 3, varied()), [96, 64]),
        ("faint", Groom::wavy(6000, 16, 4, faint()), [48, 32]),
    ];
    for (name, technique) in TECHNIQUES {
        grooms.iter().for_each(|groom| is_as_in_f64(name, technique, groom));
    }
}

fn is_as_in_f64(technique: &str, of: AtPlaces, (groom_name, groom, size): &Case) {
    // In lists edges of stripes have 11 bits, and of faint hair it shows which of two fragments with nearly one depth is the eighth.
    let least = match (of(1).1, *groom_name) {
        (usize::MAX, _) => 85.0,
        (_, "faint") => 75.0,
        _ => 82.0,
    };
    for places in [4, 16, 64] {
        let Some(mut screen) = screen(|setup| {
            at(of, places)(setup);
            setup.size = *size;
        }) else {
            return;
        };
        let (picture, far) = (screen.hair(&[groom]), screen.view.depth().far());
        let strands = [groom.reference()];
        let in_f64 =
            |k, places| reference::resolved_at_places(&screen.view, &screen.lights, &strands, &|_| far, k, places);
        let k = of(places).1;
        let (difference, to_one) = (picture.difference(&in_f64(k, places)), picture.difference(&in_f64(k, 1)));
        eprintln!("{technique}, {groom_name}, {places}: {difference:?}; to one place in f64: {to_one:?}");
        assert!(
            difference.max < 0.002 && difference.psnr > least,
            "{technique}, {groom_name}, {places}: {difference:?}"
        );
        assert!(*groom_name == "faint" || to_one.psnr < 50.0, "{groom_name}: it is another picture, {to_one:?}");
        assert!(screen.hair(&[groom]).bytes == picture.bytes, "{technique}, {groom_name}: the same bits again");
    }
}

#[test]
fn both_fills_and_bounded_lists_have_the_same_bits() {
    let groom = Groom::wavy(1500, 16, 3, varied());
    for (places, tail) in PLACES.into_iter().flat_map(|places| [(places, Tail::Shaded), (places, Tail::Weighted)]) {
        let all = lists(places).tail(tail);
        let pictures = [all, all.fill(Fill::Raster), all.cap(8), all.cap(8).fill(Fill::Raster)].map(|desc| {
            let mut screen = screen(|setup| setup.technique = desc.into())?;
            Some(screen.hair(&[&groom]).bytes)
        });
        let [Some(lists), others @ ..] = pictures else { return };
        assert!(others.iter().all(|other| other.as_ref() == Some(&lists)), "{places} places, {tail:?}");
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
    for (technique, (places, share)) in
        [TILES, LISTS].into_iter().flat_map(|of| [(4, 0.75), (16, 0.4), (64, 0.2)].map(|places| (of, places)))
    {
        let Some(mut screen) = screen(at(technique, places)) else { return };
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
    let cases = [0.05, 0.7, 3.0].into_iter().flat_map(|width| [4, 16, 64].map(|places| (width, places, 0.001)));
    for ((width, places, most), technique) in cases.flat_map(|case| [TILES, LISTS].map(|technique| (case, technique))) {
        let [Some(mut one), Some(mut several)] = [1, places].map(|places| screen(at(technique, places))) else {
            return;
        };
        let pixels_per_unit = one.view.lens().focal.x / 3.0;
        let strand = (0..7).map(|i| Vec3::new(0.1 * i as f32 - 0.3, 0.043 * i as f32 - 0.1, 0.0)).collect();
        let groom = Groom::new(&[strand], opaque(pixels_per_unit, width));
        let pictures: [Picture; 2] = [&mut one, &mut several].map(|screen| screen.hair(&[&groom]));
        let difference = pictures[0].difference(&pictures[1].pixels());
        eprintln!("{width} pixels wide, {places} places: {difference:?}");
        assert!(area(&pictures[0].pixels()) > 20.0 * f64::from(width) && difference.max < most, "{difference:?}");
    }
}

#[test]
fn other_numbers_of_places_are_refused() {
    let mut backend = NullBackend::default();
    let size = RenderDesc::new([64, 64], Format::Rgba16F);
    for (technique, places) in
        [TILES, LISTS].into_iter().flat_map(|of| [0, 2, 3, 5, 8, 17, 32, 256].map(|places| (of, places)))
    {
        let error = HairRenderer::new(&mut backend, &size.technique(technique(places).0)).unwrap_err().to_string();
        assert!(error.contains("1, 4, 16 or 64"), "{error}");
    }
    for technique in [TILES, LISTS] {
        let mut renderer = HairRenderer::new(&mut backend, &size.technique(technique(1).0)).unwrap();
        let error = renderer.retune(&mut backend, technique(4).0).unwrap_err().to_string();
        assert!(error.contains("needs a new renderer"), "{error}");
    }
}
