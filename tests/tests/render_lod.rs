//! Level of detail: fewer and wider strands of fewer vertices look like all of them.

mod support;

use glam::{DVec3, Vec3};
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_conformance::run_and_read;
use tressfx_core::backend::DepthOrder;
use tressfx_core::pass::{Load, PassList, RasterPass};
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{
    Counters, DrawError, Lod, LodDesc, Material, PpllDesc, SectionDraw, ShadowDesc, ShortCutDesc, Technique, TilesDesc,
    ViewDraw,
};

use support::screen;

const STRANDS: u32 = 600;
const VERTICES: u32 = 17;

fn material() -> Material {
    Material::default().with(|material| material.fibre_radius = Some(0.002))
}

/// The first strands of a groom, every vertex `step` of them, as wide as all are together, and as different from each other as means of those.
fn thinned(groom: &Groom, strands: u32, step: u32) -> Groom {
    let all = groom.shape.strands();
    let vertices = (groom.shape.vertices - 1) / step + 1;
    let of = |values: &[[f32; 4]], vertex: u32, strand: u32| values[(vertex * step * all + strand) as usize];
    let point = |strand: u32, vertex: u32| Vec3::from_slice(&of(&groom.positions, vertex, strand));
    let lines: Vec<Vec<Vec3>> = (0..strands).map(|s| (0..vertices).map(|v| point(s, v)).collect()).collect();
    let stands_for = all as f32 / strands as f32;
    let material = groom.material.with(|material| {
        material.fibre_radius = material.fibre_radius.map(|radius| radius * stands_for);
        material.variation /= stands_for.sqrt();
        material.tilt_variation /= stands_for.sqrt();
    });
    let mut thinned = Groom::new(&lines, material);
    let places = (0..vertices).flat_map(|vertex| (0..strands).map(move |strand| (vertex, strand)));
    thinned.tangents = places.clone().map(|(vertex, strand)| of(&groom.tangents, vertex, strand)).collect();
    thinned.thickness =
        places.map(|(vertex, strand)| groom.thickness[(vertex * step * all + strand) as usize]).collect();
    thinned
}

fn techniques() -> [Technique; 3] {
    [PpllDesc::default().into(), TilesDesc::default().into(), ShortCutDesc::default().into()]
}

#[test]
fn what_is_left_out_might_as_well_not_be_there() {
    let groom = Groom::wavy(STRANDS, VERTICES, 3, material());
    for technique in techniques() {
        let Some(mut screen) = screen(|setup| setup.technique = technique) else { return };
        for (strands, step) in [(STRANDS, 2), (150, 1), (75, 4), (1, 16)] {
            let lod = Lod { share: strands as f32 / STRANDS as f32, step };
            let found = screen.hair(&[&Groom { lod, ..groom.clone() }]);
            let expected = screen.hair(&[&thinned(&groom, strands, step)]);
            assert!(expected.pixels().iter().any(|pixel| pixel.w > 0.0), "there is hair");
            assert!(found.bytes == expected.bytes, "{technique:?}, {strands} strands in steps of {step}");
        }
    }
}

#[test]
fn a_section_whose_detail_changes_between_frames_is_drawn_as_a_new_one() {
    let groom = Groom::wavy(STRANDS, VERTICES, 3, material());
    for technique in techniques() {
        let Some(mut screen) = screen(|setup| setup.technique = technique) else { return };
        let lods = [(0.1, 8), (1.0, 1), (0.3, 2), (1.0, 4)].map(|(share, step)| Lod { share, step });
        let expected = lods.map(|lod| screen.hair(&[&Groom { lod, ..groom.clone() }]).bytes);
        let mut list = PassList::new();
        let section = screen.section(&mut list, &groom);
        let (targets, view, lights) = (screen.targets(), screen.view, screen.lights.clone());
        for (lod, expected) in lods.into_iter().zip(expected) {
            let clear = RasterPass::new("test.clear").color(targets.color, Load::Clear([0.0; 4]));
            list.raster(clear.depth(targets.depth, Load::Clear(view.depth().far())));
            let draw = SectionDraw::new(&section, &groom.material, groom.pose).lod(lod);
            screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]).unwrap();
            let picture = list.read_texture(targets.color);
            let found = run_and_read(&mut *screen.backend, &list, picture);
            assert!(found == expected, "{technique:?}, {lod:?}");
            list = PassList::new();
        }
    }
}

#[test]
fn pictures_are_as_in_f64() {
    let Some(mut screen) = screen(|setup| setup.technique = TilesDesc::default().into()) else { return };
    // The last vertex does not come in its turn, and the last strand fades.
    let lod = Lod { share: 0.2511, step: 5 };
    let groom = Groom { lod, ..Groom::wavy(STRANDS, VERTICES, 3, material()) };
    let difference = screen.hair(&[&groom]).difference(&screen.exact(&[&groom]));
    eprintln!("{difference:?}");
    assert!(difference.psnr > 70.0, "{difference:?}");
}

/// What differs between two pictures, summed over their texels.
fn difference(a: &Picture, b: &Picture) -> f64 {
    a.pixels().iter().zip(b.pixels()).map(|(a, b)| (*a - b).truncate().abs().element_sum()).sum()
}

#[test]
fn the_last_strand_fades() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = Groom::wavy(STRANDS, VERTICES, 3, material());
    let mut drawn = |strands: f32| {
        let lod = Lod { share: strands / STRANDS as f32, step: 1 };
        screen.hair(&[&Groom { lod, ..groom.clone() }])
    };
    let [whole, tenth, most, next] = [50.0, 50.1, 50.9, 51.0].map(&mut drawn);
    let step = difference(&whole, &next);
    let [first, last] = [difference(&whole, &tenth) / step, difference(&most, &next) / step];
    eprintln!("of the difference that a strand makes, its first tenth makes {first:.3}, its last {last:.3}");
    assert!(first < 0.2 && last < 0.2, "{first} {last}");
    assert!(step > 0.0);
}

const SIZE: [u32; 2] = [256, 256];

/// What looks at the groom from so far.
fn from(distance: f32) -> View {
    let eye = Vec3::new(0.0, 0.0, distance);
    let camera = Camera { eye, target: Vec3::ZERO, fov: 0.6, near: 0.01, far: 2e4, depth: DepthOrder::Reverse };
    camera.view(SIZE).unwrap()
}

/// What a frame shows, and what it took.
struct Seen {
    /// Sum of what pixels take from the picture behind them.
    covered: f64,
    color: DVec3,
    counters: Counters,
    vertices: u32,
}

fn seen(screen: &mut Screen, groom: &Groom, distance: f32, desc: Option<LodDesc>) -> Seen {
    screen.view = from(distance);
    let mut list = PassList::new();
    let section = screen.section(&mut list, groom);
    let draw = SectionDraw::new(&section, &groom.material, groom.pose);
    let lod = desc.map_or(Lod::FULL, |desc| desc.choose(&screen.view, &draw));
    let vertices = draw.lod(lod).vertices();
    let picture = screen.hair(&[&Groom { lod, ..groom.clone() }]);
    let color: DVec3 = picture.pixels().iter().map(|pixel| pixel.truncate()).sum();
    let covered = picture.pixels().iter().map(|pixel| pixel.w).sum::<f64>();
    Seen { covered, color: color / covered, counters: picture.counters, vertices }
}

/// Seen from such distances, with shadows or without.
fn covers_and_shines_as_all_of_it(shadows: Option<ShadowDesc>, distances: &[f32]) {
    let setup = |setup: &mut Setup| {
        (setup.technique, setup.size, setup.shadows) = (TilesDesc::default().into(), SIZE, shadows);
    };
    let Some(mut screen) = screen(setup) else { return };
    let groom = Groom::wavy(4000, 33, 5, Material::default().with(|material| material.fibre_radius = Some(0.0004)));
    let near = seen(&mut screen, &groom, 2.0, Some(LodDesc::default()));
    for &distance in distances {
        let full = seen(&mut screen, &groom, distance, None);
        let less = seen(&mut screen, &groom, distance, Some(LodDesc::default()));
        let area = full.covered / near.covered;
        let covered = less.covered / full.covered - 1.0;
        let color = (less.color / full.color - 1.0).abs().max_element();
        let [fragments, vertices] = [
            less.counters.fragments as f64 / near.counters.fragments as f64,
            f64::from(less.vertices) / f64::from(near.vertices),
        ];
        eprintln!(
            "{area:.4} of the area: covered {covered:+.4}, colour {color:.4}, fragments {fragments:.4}, vertices {vertices:.4}"
        );
        assert!(covered.abs() < 0.02, "{covered}");
        assert!(color < 0.02, "{color}");
        // The number of fragments falls with the area, and that of vertices at least with its root.
        assert!(fragments < 2.0 * area, "{fragments} of the fragments");
        assert!(vertices < 1.5 * area.sqrt(), "{vertices} of the vertices");
    }
}

#[test]
fn a_groom_far_away_covers_and_shines_as_all_of_it_and_costs_what_it_covers() {
    covers_and_shines_as_all_of_it(None, &[4.0, 8.0, 16.0, 32.0]);
}

#[test]
fn a_groom_far_away_shines_as_all_of_it_in_its_own_shadow() {
    // From 32 the least number of strands is drawn, and their shadows are 2.7 % off.
    covers_and_shines_as_all_of_it(Some(ShadowDesc::default()), &[4.0, 8.0, 16.0]);
}

#[test]
fn what_is_chosen_falls_with_the_size_on_the_screen() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = Groom::wavy(4000, 33, 5, Material::default().with(|material| material.fibre_radius = Some(0.0004)));
    let mut list = PassList::new();
    let section = screen.section(&mut list, &groom);
    let draw = SectionDraw::new(&section, &groom.material, groom.pose);
    let chosen = |view: &View| LodDesc::default().choose(view, &draw);
    assert_eq!(chosen(&from(0.3)), Lod::FULL, "the eye is in the groom");
    let shares: Vec<f32> = [3.0, 6.0, 12.0, 24.0].map(|distance| chosen(&from(distance)).share).into();
    assert!(shares.windows(2).all(|pair| pair[1] < pair[0] && pair[1] > 0.3 * pair[0]), "{shares:?}");
    assert_eq!(chosen(&from(1e4)).share, 256.0 / 4000.0, "the least");
    let none = LodDesc::default().width(0.0).deviation(0.0);
    assert_eq!(none.choose(&from(100.0), &draw), Lod::FULL, "no detail is given up");
}

#[test]
fn shadows_are_as_dark() {
    let left = |lod: Lod| -> Option<DVec3> {
        let light = |shadows: Option<ShadowDesc>| {
            let mut screen = screen(|setup| (setup.shadows, setup.technique) = (shadows, TilesDesc::default().into()))?;
            let groom = Groom { lod, ..Groom::wavy(4000, 33, 5, Material::default()) };
            Some(screen.hair(&[&groom]).pixels().iter().map(|pixel| pixel.truncate()).sum::<DVec3>())
        };
        Some(light(Some(ShadowDesc::default()))? / light(None)?)
    };
    let (Some(all), Some(some)) = (left(Lod::FULL), left(Lod { share: 0.25, step: 2 })) else { return };
    let off = (some / all - 1.0).abs().max_element();
    eprintln!("all strands: shadows leave {all:.4}; a quarter: {some:.4}");
    assert!(all.max_element() < 0.95 && off < 0.02, "{off}");
}

#[test]
fn a_level_of_detail_that_is_none_is_refused() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = Groom::wavy(10, 5, 1, material());
    let mut list = PassList::new();
    let section = screen.section(&mut list, &groom);
    for lod in [
        Lod { share: 0.0, step: 1 },
        Lod { share: f32::NAN, step: 1 },
        Lod { share: 1.5, step: 1 },
        Lod { share: 1.0, step: 0 },
    ] {
        let draw = SectionDraw::new(&section, &groom.material, Pose::IDENTITY).lod(lod);
        let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
        let said = screen.renderer.draw(&mut PassList::new(), &[view], &[draw]).unwrap_err();
        assert!(matches!(said, DrawError::Lod { .. }), "{said}");
        assert!(said.to_string().contains("level of detail"), "{said}");
    }
}
