//! Hair among opaque things, in front of the eye and behind it.

mod support;

use glam::{DVec4, Vec3};
use tressfx_conformance::render::{Difference, Groom};
use tressfx_core::backend::DepthOrder;
use tressfx_render::reference;

use support::hair::{material, wall};
use support::screen;

#[test]
fn what_is_in_front_hides_hair_and_what_is_behind_does_not() {
    let groom = Groom::wavy(300, 16, 1, material());
    let Some(mut screen) = screen(|_| ()) else { return };
    let free = screen.scene(&[], &[&groom]);
    let behind = screen.scene(&[&wall(-5.0, 1.5)], &[&groom]);
    assert_eq!(behind.counters.fragments, 0, "all of it is behind the wall");
    let wall_alone = screen.scene(&[&wall(-5.0, 1.5)], &[]);
    assert!(behind.bytes == wall_alone.bytes);
    let before = screen.scene(&[&wall(-5.0, -1.5)], &[&groom]);
    assert_eq!(before.counters, free.counters, "all of it is in front of the wall");
    let half = screen.scene(&[&wall(0.0, 0.0)], &[&groom]);
    let hidden = free.counters.fragments - half.counters.fragments;
    let share = f64::from(hidden) / f64::from(free.counters.fragments);
    assert!((0.1..0.45).contains(&share), "a wall through the middle hides a quarter: {share}");
}

#[test]
fn depth_is_tested_as_in_f64() {
    let groom = Groom::wavy(300, 16, 2, material());
    for order in [DepthOrder::Standard, DepthOrder::Reverse] {
        let Some(mut screen) = screen(|setup| (setup.ppll().k, setup.camera.depth) = (16, order)) else { return };
        let mesh = wall(0.0, 0.1);
        let picture = screen.scene(&[&mesh], &[&groom]);
        let depth = screen.depth();
        let empty = screen.scene(&[&mesh], &[]).pixels();
        let scene = |[x, y]: [u32; 2]| depth[(y * 96 + x) as usize];
        let hair = reference::exact(&screen.view, &screen.lights, &[groom.reference()], &scene);
        let expected: Vec<DVec4> =
            hair.iter().zip(&empty).map(|(hair, below)| *hair + *below * (1.0 - hair.w)).collect();
        let difference = picture.difference(&expected);
        eprintln!("{order:?}: {difference:?}");
        assert!(difference.psnr > 80.0, "{order:?}: {difference:?}");
    }
}

#[test]
fn both_orders_of_depth_give_the_same_picture() {
    let groom = Groom::wavy(300, 16, 3, material());
    let mut pictures = Vec::new();
    for order in [DepthOrder::Standard, DepthOrder::Reverse] {
        let Some(mut screen) = screen(|setup| setup.camera.depth = order) else { return };
        pictures.push((screen.hair(&[&groom]), screen.scene(&[&wall(0.0, 0.1)], &[&groom])));
    }
    let [(hair, scene), (hair_reverse, scene_reverse)] = &pictures[..] else { unreachable!() };
    assert!(hair.bytes == hair_reverse.bytes, "hair alone is sorted by distance, to the bit");
    let difference = scene.difference(&scene_reverse.pixels());
    eprintln!("with a wall: {difference:?}");
    // A strand that goes through the wall may leave it a pixel earlier.
    assert!(difference.psnr > 60.0, "{difference:?}");
}

#[test]
fn a_strand_that_passes_behind_the_eye_is_cut_at_the_near_plane() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 16) else { return };
    let strand = |x: f32, y: f32| vec![Vec3::new(x, y, -2.0), Vec3::new(0.4 * x, 0.5 * y, 2.0), Vec3::new(-x, y, 6.0)];
    let strands: Vec<_> = (0..40).map(|i| strand(0.5 - 0.025 * i as f32, 0.3 - 0.013 * i as f32)).collect();
    let groom = Groom::new(&strands, material().with(|m| m.fibre_radius = Some(0.002)));
    let far = screen.view.depth().far();
    let exact = reference::exact(&screen.view, &screen.lights, &[groom.reference()], &|_| far);
    let picture = screen.hair(&[&groom]);
    let difference = Difference::between(&picture.pixels(), &exact);
    eprintln!("through the near plane: {difference:?}, {:?}", picture.counters);
    assert!(picture.counters.fragments > 1000);
    // The projected lines are tens of thousands of pixels long: f32 ends are off by a hundredth of a pixel there.
    assert!(difference.psnr > 85.0, "{difference:?}");
    let behind: Vec<_> = strands.iter().map(|s| s.iter().map(|&p| p + 10.0 * Vec3::Z).collect()).collect();
    assert_eq!(
        screen.hair(&[&Groom::new(&behind, material())]).counters.fragments,
        0,
        "nothing is seen behind the eye"
    );
}
