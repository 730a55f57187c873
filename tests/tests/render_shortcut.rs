//! ShortCut against its f64 references, and what its sums of integers promise.

mod support;

use glam::{DVec4, Vec3};
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_core::backend::DepthOrder;
use tressfx_core::view::{View, Viewport};
use tressfx_render::{Counters, Material, ShortCutDesc, reference};

use support::hair::{is_sound, varied, wall};
use support::screen;

const VARIANTS: [(u32, bool); 6] = [(1, false), (3, false), (8, false), (1, true), (3, true), (8, true)];

fn shortcut(k: u32, ordered: bool) -> impl FnOnce(&mut Setup) {
    move |setup| setup.technique = ShortCutDesc::default().k(k).ordered(ordered).into()
}

/// The same picture in f64.
fn in_f64(screen: &Screen, grooms: &[&Groom], k: u32, ordered: bool) -> Vec<DVec4> {
    let far = screen.view.depth().far();
    let strands: Vec<_> = grooms.iter().map(|groom| groom.reference()).collect();
    reference::shortcut(&screen.view, &screen.lights, &strands, &|_| far, k as usize, ordered)
}

#[test]
fn each_variant_is_as_in_f64() {
    let groom = Groom::wavy(1500, 16, 3, varied());
    for (k, ordered) in VARIANTS {
        let Some(mut screen) = screen(shortcut(k, ordered)) else { return };
        let picture = screen.hair(&[&groom]);
        let expected = in_f64(&screen, &[&groom], k, ordered);
        let exact = screen.exact(&[&groom]);
        let (difference, to_exact) = (picture.difference(&expected), picture.difference(&exact));
        // A fragment within rounding of being faint, or two within rounding of one depth, may fall either way.
        let far = |(a, b): &(DVec4, &DVec4)| (*a - **b).abs().max_element() > 0.002;
        let far = picture.pixels().into_iter().zip(&expected).filter(far).count();
        eprintln!("k = {k}, ordered {ordered}: {far} pixels beside {difference:?}; to exact {to_exact:?}");
        assert!(expected.iter().any(|pixel| pixel.w > 0.9), "the groom is in the picture");
        assert!(far <= 4 && (far > 0 || difference.psnr > 80.0), "k = {k}, ordered {ordered}: {far}, {difference:?}");
        let alpha = picture.pixels().iter().zip(&exact).map(|(a, b)| (a.w - b.w).abs()).fold(0.0, f64::max);
        assert!(alpha < 0.001, "alpha is that of all fragments: {alpha}");
    }
}

#[test]
fn order_and_more_layers_come_closer_to_the_exact_picture() {
    let groom = Groom::wavy(1500, 16, 4, varied());
    let mut psnr = Vec::new();
    for (k, ordered) in [(1, true), (3, true), (8, true), (8, false)] {
        let Some(mut screen) = screen(shortcut(k, ordered)) else { return };
        let exact = screen.exact(&[&groom]);
        psnr.push(screen.hair(&[&groom]).difference(&exact).psnr);
    }
    eprintln!("PSNR against exact order for k = 1, 3, 8 in order, and the mean of 8: {psnr:.1?}");
    assert!(psnr[..3].is_sorted() && psnr[2] > psnr[3], "{psnr:?}");
}

#[test]
fn fragments_are_counted_as_in_the_lists() {
    let groom = Groom::wavy(300, 16, 2, varied());
    let Some(mut lists) = screen(|_| ()) else { return };
    let expected = Counters { wanted: 0, ..lists.hair(&[&groom]).counters };
    for (k, ordered) in VARIANTS {
        let Some(mut screen) = screen(shortcut(k, ordered)) else { return };
        assert_eq!(screen.hair(&[&groom]).counters, expected);
    }
}

#[test]
fn twice_the_same_picture_to_the_bit_whatever_the_order_of_sections() {
    let groom = Groom::wavy(6000, 16, 6, varied());
    let (one, other) = (Groom::wavy(60, 12, 7, varied()), Groom::wavy(40, 20, 8, varied()));
    for (k, ordered) in VARIANTS {
        let variant = shortcut(k, ordered);
        let Some(mut screen) = screen(|setup| {
            variant(setup);
            setup.size = [320, 200];
        }) else {
            return;
        };
        let first = screen.hair(&[&groom]);
        assert!(first.counters.fragments > 1_000_000, "many threads race: {:?}", first.counters);
        for _ in 0..2 {
            assert!(first.bytes == screen.hair(&[&groom]).bytes, "k = {k}, ordered {ordered}");
        }
        assert!(screen.hair(&[&one, &other]).bytes == screen.hair(&[&other, &one]).bytes);
    }
}

#[test]
fn strands_of_one_depth_are_the_same_in_every_order() {
    // In a plane that faces an orthographic eye every fragment of a pixel has the same depth.
    let strand = |i: u32| -> Vec<Vec3> {
        let x = (i % 40) as f32 / 40.0 - 0.5;
        (0..4).map(|v| Vec3::new(x + 0.01 * (i / 40) as f32, 0.5 - 0.3 * v as f32, 0.0)).collect()
    };
    let half = |from: u32| Groom::new(&(from..from + 60).map(strand).collect::<Vec<_>>(), varied());
    let (one, other) = (half(0), half(60));
    for (k, ordered) in VARIANTS {
        let Some(mut screen) = screen(shortcut(k, ordered)) else { return };
        let (first, second) = (screen.hair(&[&one, &other]), screen.hair(&[&other, &one]));
        assert!(first.bytes == second.bytes, "k = {k}, ordered {ordered}");
        assert!(is_sound(&first) && first.counters.pixels_with_hair > 500);
    }
}

#[test]
fn hair_behind_the_scene_is_left_out_and_the_depth_of_the_scene_is_untouched() {
    let groom = Groom::wavy(300, 16, 2, varied());
    for (order, ordered) in [(DepthOrder::Reverse, false), (DepthOrder::Standard, true)] {
        let (variant, wall) = (shortcut(3, ordered), wall(0.0, 0.0));
        let Some(mut lists) = screen(|setup| setup.camera.depth = order) else { return };
        let expected = lists.scene(&[&wall], &[&groom]).counters;
        let Some(mut screen) = screen(|setup| {
            variant(setup);
            setup.camera.depth = order;
        }) else {
            return;
        };
        screen.scene(&[&wall], &[]);
        let before = screen.depth();
        assert_eq!(screen.scene(&[&wall], &[&groom]).counters, Counters { wanted: 0, ..expected });
        assert!(screen.depth() == before, "hair writes no depth");
        assert!(screen.hair(&[&groom]).counters.fragments > expected.fragments, "the wall hides some");
    }
}

/// A strip of hair across the picture at a depth, seven pixels wide.
fn strip(z: f32, color: Vec3, opacity: f32) -> Groom {
    let material = Material::default().with(|m| {
        (m.fibre_radius, m.opacity, m.tip_opacity) = (Some(0.1), opacity, opacity);
        (m.base_color, m.tip_color) = (color, color);
    });
    Groom::new(&[vec![Vec3::new(-2.0, 0.0, z), Vec3::new(2.0, 0.0, z)]], material)
}

#[test]
fn opaque_hair_hides_what_is_behind_it_and_no_other_does() {
    let middle = |picture: &Picture| picture.pixels()[32 * 96 + 48];
    for (k, ordered) in VARIANTS {
        for opacity in [1.0, 0.5] {
            let Some(mut screen) = screen(shortcut(k, ordered)) else { return };
            let (front, back) = (strip(0.1, Vec3::X, opacity), strip(-0.1, Vec3::Y, 1.0));
            let (alone, both) = (screen.hair(&[&front]), screen.hair(&[&back, &front]));
            let (alone, both) = (middle(&alone), middle(&both));
            assert!(both.w > 0.999, "{both}");
            assert_eq!(alone == both, opacity == 1.0, "k = {k}, ordered {ordered}: {alone} and {both}");
        }
    }
}

#[test]
fn hair_that_is_not_there_leaves_the_picture_as_it_was() {
    for (k, ordered) in VARIANTS {
        let Some(mut screen) = screen(shortcut(k, ordered)) else { return };
        let clear = strip(0.0, Vec3::X, 0.0);
        let none = [screen.hair(&[&clear]), screen.hair(&[&Groom::new(&[], varied())]), screen.hair(&[])];
        for picture in none {
            assert!(picture.bytes.iter().all(|&byte| byte == 0) && picture.counters.fragments == 0);
        }
        // So faint that its optical depth rounds to nothing.
        let faint = screen.hair(&[&strip(0.0, Vec3::X, 2e-5)]);
        assert!(is_sound(&faint) && faint.counters.fragments > 0);
    }
}

#[test]
fn odd_screens_and_wide_strands_and_an_eye_within_the_hair() {
    let groom = Groom::wavy(300, 16, 2, varied());
    for (k, ordered) in VARIANTS {
        for (size, limit) in [([1, 1], 1), ([16384, 1], 100), ([1, 300], 100), ([7, 9], 60)] {
            let variant = shortcut(k, ordered);
            let Some(mut screen) = screen(|setup| {
                variant(setup);
                setup.size = size;
                setup.camera.fov = 1.0;
            }) else {
                return;
            };
            let picture = screen.hair(&[&groom]);
            assert!(is_sound(&picture) && picture.counters.fragments > limit, "{size:?}: {:?}", picture.counters);
            let expected = in_f64(&screen, &[&groom], k, ordered);
            let difference = picture.difference(&expected);
            assert!(difference.psnr > 60.0, "{size:?}, k = {k}, ordered {ordered}: {difference:?}");
        }
        let variant = shortcut(k, ordered);
        let Some(mut screen) = screen(|setup| {
            variant(setup);
            setup.camera.eye = Vec3::new(0.1, 0.0, 0.2);
            setup.camera.near = 0.001;
        }) else {
            return;
        };
        for radius in [0.0, 1e-6, 0.01, 3.0] {
            let wide = Groom { material: varied().with(|m| m.fibre_radius = Some(radius)), ..groom.clone() };
            let picture = screen.hair(&[&wide]);
            assert!(is_sound(&picture), "radius {radius}");
            assert_eq!(picture.counters.fragments > 0, radius > 0.0, "radius {radius}: {:?}", picture.counters);
        }
    }
}

#[test]
fn sums_that_overflow_stay_full() {
    // So many opaque strands over each other that the sum of their optical depths does not fit into 32 bits.
    let strand = vec![Vec3::new(-0.5, 0.0, 0.0), Vec3::new(0.5, 0.0, 0.0)];
    let opaque = strip(0.0, Vec3::X, 1.0).material.with(|m| m.fibre_radius = Some(1.0));
    let groom = Groom::new(&vec![strand; 40_000], opaque);
    for (k, ordered) in [(3, false), (3, true)] {
        let Some(mut screen) = screen(|setup| {
            shortcut(k, ordered)(setup);
            setup.size = [8, 8];
        }) else {
            return;
        };
        let (one, all) = (screen.hair(&[&Groom::new(&[vec![Vec3::NEG_X, Vec3::X]], opaque)]), screen.hair(&[&groom]));
        assert!(all.counters.fragments > 40_000 * 4, "{:?}", all.counters);
        let covered = all.pixels().into_iter().filter(|pixel| pixel.w == 1.0).count();
        assert!(covered > 4 && one.counters.fragments > 0, "{covered}");
        assert!(is_sound(&all) && screen.hair(&[&groom]).bytes == all.bytes);
    }
}

#[test]
fn a_second_view_and_a_new_size_draw_as_a_renderer_of_their_own() {
    let groom = Groom::wavy(200, 16, 5, varied());
    for ordered in [false, true] {
        let Some(mut fresh) = screen(shortcut(3, ordered)) else { return };
        let expected = fresh.hair(&[&groom]);
        let Some(mut screen) = screen(shortcut(3, ordered)) else { return };
        let before = (screen.backend_memory(), screen.renderer.technique_bytes());
        screen.renderer.resize(&mut *screen.backend, [300, 17]).unwrap();
        screen.renderer.resize(&mut *screen.backend, [96, 64]).unwrap();
        assert_eq!((screen.backend_memory(), screen.renderer.technique_bytes()), before, "nothing is left behind");
        assert!(screen.hair(&[&groom]).bytes == expected.bytes);
        // The same view twice in one frame.
        let view = screen.view;
        let twice = screen.views(&[view, view], &[&groom]);
        let squared = expected.pixels().iter().map(|pixel| *pixel + *pixel * (1.0 - pixel.w)).collect::<Vec<_>>();
        assert!(twice.difference(&squared).max < 0.002, "the second view lies over the first");
        assert_eq!(twice.counters, expected.counters);
    }
}

#[test]
fn views_of_one_frame_are_as_each_alone() {
    let groom = Groom::wavy(200, 16, 5, varied());
    for (k, ordered) in [(3, false), (3, true)] {
        let Some(mut screen) = screen(shortcut(k, ordered)) else { return };
        let (camera, depth) = ((screen.view.view_matrix(), screen.view.projection_matrix()), screen.view.depth());
        let of = |offset, size| {
            let viewport = Viewport::part(offset, size, [96, 64]).unwrap();
            View::new(camera.0, camera.1, depth, viewport).unwrap()
        };
        // Neither begins nor ends on a tile of 8 x 8.
        let views = [of([0, 0], [45, 64]), of([45, 3], [51, 37])];
        let together = screen.views(&views, &[&groom]);
        let alone = views.map(|view| screen.views(&[view], &[&groom]).pixels());
        let sum: Vec<_> = alone[0].iter().zip(&alone[1]).map(|(a, b)| *a + *b).collect();
        assert!(sum.iter().any(|pixel| pixel.w > 0.5) && together.pixels() == sum, "k = {k}, ordered {ordered}");
    }
}
