//! Hair among opaque things, in front of the eye and behind it.

mod support;

use glam::{DVec4, Vec3};
use tressfx_asset::mesh::Mesh;
use tressfx_conformance::render::{Difference, Groom};
use tressfx_core::backend::DepthOrder;
use tressfx_render::{Material, Surface, reference};

use support::stage;

fn material() -> Material {
    Material { fibre_radius: Some(0.005), opacity: 0.7, tip_opacity: 0.5, ..Material::default() }
}

/// A square across the line of sight, with its left edge at `left`.
fn wall(left: f32, z: f32) -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, z);
    Mesh {
        positions: vec![corner(left, -5.0), corner(5.0, -5.0), corner(left, 5.0), corner(5.0, 5.0)],
        normals: vec![Vec3::Z; 4],
        indices: vec![0, 1, 2, 2, 1, 3],
    }
}

#[test]
fn what_is_in_front_hides_hair_and_what_is_behind_does_not() {
    let groom = Groom::wavy(300, 16, 1, material());
    let Some(mut stage) = stage(|_, _| ()) else { return };
    let free = stage.scene(&[], &[&groom]);
    let behind = stage.scene(&[(&wall(-5.0, 1.5), Surface::default())], &[&groom]);
    assert_eq!(behind.counters.fragments, 0, "all of it is behind the wall");
    let wall_alone = stage.scene(&[(&wall(-5.0, 1.5), Surface::default())], &[]);
    assert!(behind.bytes == wall_alone.bytes);
    let before = stage.scene(&[(&wall(-5.0, -1.5), Surface::default())], &[&groom]);
    assert_eq!(before.counters, free.counters, "all of it is in front of the wall");
    let half = stage.scene(&[(&wall(0.0, 0.0), Surface::default())], &[&groom]);
    let hidden = free.counters.fragments - half.counters.fragments;
    let share = f64::from(hidden) / f64::from(free.counters.fragments);
    assert!((0.1..0.45).contains(&share), "a wall through the middle hides a quarter: {share}");
}

#[test]
fn depth_is_tested_as_in_f64() {
    let groom = Groom::wavy(300, 16, 2, material());
    for order in [DepthOrder::Standard, DepthOrder::Reverse] {
        let Some(mut stage) = stage(|desc, view| (desc.k, view.depth) = (16, order)) else { return };
        let mesh = wall(0.0, 0.1);
        let picture = stage.scene(&[(&mesh, Surface::default())], &[&groom]);
        let depth = stage.depth();
        let empty = stage.scene(&[(&mesh, Surface::default())], &[]).pixels();
        let scene = |[x, y]: [u32; 2]| depth[(y * 96 + x) as usize];
        let hair = reference::exact(&stage.frame(), &[groom.reference()], &scene);
        let expected: Vec<DVec4> =
            hair.iter().zip(&empty).map(|(hair, below)| *hair + *below * (1.0 - hair.w)).collect();
        let difference = picture.difference(&expected);
        eprintln!("{order:?}: {difference:?}");
        assert!(difference.psnr > 60.0, "{order:?}: {difference:?}");
    }
}

#[test]
fn both_orders_of_depth_give_the_same_picture() {
    let groom = Groom::wavy(300, 16, 3, material());
    let mut pictures = Vec::new();
    for order in [DepthOrder::Standard, DepthOrder::Reverse] {
        let Some(mut stage) = stage(|_, view| view.depth = order) else { return };
        pictures.push((stage.hair(&[&groom]), stage.scene(&[(&wall(0.0, 0.1), Surface::default())], &[&groom])));
    }
    let [(hair, scene), (hair_reverse, scene_reverse)] = &pictures[..] else { unreachable!() };
    assert!(hair.bytes == hair_reverse.bytes, "hair alone is sorted by distance, to the bit");
    let difference = scene.difference(&scene_reverse.pixels());
    eprintln!("with a wall: {difference:?}");
    // A strand that goes through the wall may leave it a pixel earlier.
    assert!(difference.psnr > 60.0, "{difference:?}");
}

#[test]
fn the_scene_is_lit_and_the_backdrop_is_behind_it() {
    let Some(mut stage) = stage(|_, _| ()) else { return };
    let backdrop = stage.scene(&[], &[]).pixels();
    assert!(backdrop.iter().all(|pixel| pixel.w == 1.0 && pixel.min_element() > 0.01), "every pixel is covered");
    let ball = tressfx_core::shape::Ellipsoid { center: Vec3::ZERO, radii: Vec3::splat(0.5) };
    let scene = stage.scene(&[(&Mesh::ellipsoid(&ball, 32), Surface::default())], &[]).pixels();
    let at = |x: f32, y: f32| scene[((32.0 - 34.0 * y) as usize) * 96 + (48.0 + 34.0 * x) as usize];
    assert!(at(0.25, 0.25).x > 1.5 * at(-0.3, -0.35).x, "the key light comes from the upper right");
    let untouched = |x: usize| (scene[x] - backdrop[x]).abs().max_element() == 0.0;
    assert!(untouched(0) && untouched(96 * 64 - 1) && !untouched(32 * 96 + 48));
}

#[test]
fn a_strand_that_passes_behind_the_eye_is_cut_at_the_near_plane() {
    let Some(mut stage) = stage(|desc, _| desc.k = 16) else { return };
    let strand = |x: f32, y: f32| vec![Vec3::new(x, y, -2.0), Vec3::new(0.4 * x, 0.5 * y, 2.0), Vec3::new(-x, y, 6.0)];
    let strands: Vec<_> = (0..40).map(|i| strand(0.5 - 0.025 * i as f32, 0.3 - 0.013 * i as f32)).collect();
    let groom = Groom::new(&strands, Material { fibre_radius: Some(0.002), ..material() });
    let far = stage.view.depth.far();
    let exact = reference::exact(&stage.frame(), &[groom.reference()], &|_| far);
    let picture = stage.hair(&[&groom]);
    let difference = Difference::between(&picture.pixels(), &exact);
    eprintln!("through the near plane: {difference:?}, {:?}", picture.counters);
    assert!(picture.counters.fragments > 1000);
    // The projected lines are tens of thousands of pixels long: f32 ends are off by a hundredth of a pixel there.
    assert!(difference.psnr > 50.0, "{difference:?}");
    let behind: Vec<_> = strands.iter().map(|s| s.iter().map(|&p| p + 10.0 * Vec3::Z).collect()).collect();
    assert_eq!(stage.hair(&[&Groom::new(&behind, material())]).counters.fragments, 0, "nothing is seen behind the eye");
}
