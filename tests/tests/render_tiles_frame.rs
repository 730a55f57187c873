//! A frame of tiles: sections, lenses, the scene, views and their sizes.

mod support;

use glam::Vec3;
use glam::camera::rh;
use tressfx_conformance::render::{Difference, Groom};
use tressfx_core::backend::DepthOrder;
use tressfx_core::view::{View, Viewport};
use tressfx_render::{Counters, reference};

use support::hair::{endless, faint, tiles, varied, wall};
use support::screen;

#[test]
fn sections_are_sorted_against_each_other() {
    let blue = varied().with(|m| (m.base_color, m.tip_color) = (Vec3::Z, Vec3::Z));
    let grooms: Vec<_> =
        (0..5).map(|i| Groom::wavy(40 + i, 9 + 2 * i, i, if i % 2 == 0 { blue } else { faint() })).collect();
    let grooms: Vec<_> = grooms.iter().collect();
    let Some(mut screen) = screen(endless) else { return };
    let (picture, exact) = (screen.hair(&grooms), screen.exact(&grooms));
    let difference = picture.difference(&exact);
    // Colours above 2 are kept as half floats, 0.002 apart.
    assert!(difference.max < 0.0025 && difference.psnr > 82.0, "{difference:?}");
    let apart: Vec<_> = grooms.iter().map(|groom| screen.hair(&[groom]).pixels()).collect();
    let one_by_one = apart.into_iter().reduce(|below, above| {
        below.iter().zip(above).map(|(below, above)| above + *below * (1.0 - above.w)).collect()
    });
    assert!(Difference::between(&one_by_one.unwrap(), &exact).psnr < 45.0, "they lie in each other");
}

#[test]
fn any_lens_and_both_orders_of_depth() {
    let groom = Groom::wavy(300, 12, 1, varied());
    let eye = rh::view::look_at_mat4(Vec3::new(0.6, 0.4, 2.9), Vec3::ZERO, Vec3::Y);
    use rh::proj::directx::{frustum, orthographic, perspective, perspective_infinite_reverse};
    let lenses = [
        (perspective(0.6, 1.5, 0.05, 50.0), DepthOrder::Standard),
        (perspective(0.6, 1.5, 50.0, 0.05), DepthOrder::Reverse),
        (perspective_infinite_reverse(0.6, 1.5, 0.05), DepthOrder::Reverse),
        (frustum(-0.02, 0.04, -0.03, 0.015, 0.05, 50.0), DepthOrder::Standard),
        (orthographic(-1.4, 1.1, -0.9, 0.8, 0.1, 10.0), DepthOrder::Standard),
        (orthographic(-1.2, 1.2, -0.8, 0.8, 10.0, -3.0), DepthOrder::Reverse),
        // Through the hair.
        (perspective(0.6, 1.5, 50.0, 2.9), DepthOrder::Reverse),
        (orthographic(-1.2, 1.2, -0.8, 0.8, 2.9, 20.0), DepthOrder::Standard),
    ];
    let Some(mut screen) = screen(endless) else { return };
    for (projection, order) in lenses {
        screen.view = View::new(eye, projection, order, [96, 64]).unwrap();
        let (picture, exact) = (screen.hair(&[&groom]), screen.exact(&[&groom]));
        let difference = picture.difference(&exact);
        eprintln!("{order:?}, {projection}: {difference:?}");
        assert!(picture.counters.pixels_with_hair > 900, "{:?}", picture.counters);
        assert!(difference.max < 0.0008 && difference.psnr > 86.0, "{projection}: {difference:?}");
    }
}

#[test]
fn a_scene_hides_what_is_behind_it() {
    let groom = Groom::wavy(300, 16, 2, varied());
    for order in [DepthOrder::Standard, DepthOrder::Reverse] {
        let Some(mut screen) = screen(|setup| {
            endless(setup);
            setup.camera.depth = order;
        }) else {
            return;
        };
        let free = screen.scene(&[], &[&groom]).counters;
        assert_eq!(screen.scene(&[&wall(-5.0, -1.5)], &[&groom]).counters, free, "all of it is before the wall");
        let (hidden, wall_alone) =
            (screen.scene(&[&wall(-5.0, 1.5)], &[&groom]), screen.scene(&[&wall(-5.0, 1.5)], &[]));
        assert_eq!(hidden.counters, Counters::default(), "nothing is referred to from a tile that it is hidden in");
        assert!(hidden.bytes == wall_alone.bytes);
        let mesh = wall(0.0, 0.1);
        let (empty, picture) = (screen.scene(&[&mesh], &[]).pixels(), screen.scene(&[&mesh], &[&groom]));
        let depth = screen.depth();
        let scene = |[x, y]: [u32; 2]| depth[(y * 96 + x) as usize];
        let hair = reference::exact(&screen.view, &screen.lights, &[groom.reference()], &scene);
        let expected: Vec<_> = hair.iter().zip(&empty).map(|(hair, below)| *hair + *below * (1.0 - hair.w)).collect();
        let difference = picture.difference(&expected);
        eprintln!("{order:?}: {difference:?}");
        assert!(difference.psnr > 80.0, "{order:?}: {difference:?}");
    }
}

#[test]
fn views_of_one_frame_are_as_each_alone() {
    let groom = Groom::wavy(200, 16, 5, varied());
    let Some(mut screen) = screen(tiles) else { return };
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
    assert!(sum.iter().any(|pixel| pixel.w > 0.5) && together.pixels() == sum);
}

#[test]
fn a_new_size_draws_as_a_new_renderer() {
    let groom = Groom::wavy(200, 16, 5, varied());
    let Some(mut fresh) = screen(tiles) else { return };
    let expected = fresh.hair(&[&groom]);
    let Some(mut screen) = screen(tiles) else { return };
    let before = (screen.backend_memory(), screen.renderer.technique_bytes());
    screen.renderer.resize(&mut *screen.backend, [300, 17]).unwrap();
    assert!(screen.renderer.technique_bytes() != before.1);
    screen.renderer.resize(&mut *screen.backend, [96, 64]).unwrap();
    assert_eq!((screen.backend_memory(), screen.renderer.technique_bytes()), before, "nothing is left behind");
    assert!(screen.hair(&[&groom]).bytes == expected.bytes);
}
