//! Layers that are solved by hand: pixels that fibres cover wholly, and single rays.

mod support;

use glam::{DVec2, DVec3, DVec4, Vec3};
use support::{Hair, assert_near, mean_alpha, orthographic, over, perspective, pixel, premultiplied, render, samples};
use tressfx_truth::Truth;

const RED: [f32; 4] = [0.8, 0.25, 0.125, 0.5];
const BLUE: [f32; 4] = [0.125, 0.25, 1.5, 0.75];
const WHITE: [f32; 4] = [1.0, 1.0, 1.0, 1.0];

/// From left to right at a height and a depth.
fn across(y: f32, z: f32) -> [Vec3; 2] {
    [Vec3::new(-3.0, y, z), Vec3::new(3.0, y, z)]
}

/// From below to above.
fn upright(x: f32, z: f32) -> [Vec3; 2] {
    [Vec3::new(x, -3.0, z), Vec3::new(x, 3.0, z)]
}

#[test]
fn a_fibre_wider_than_a_pixel_hides_the_background_by_its_opacity() {
    let scene = DVec3::new(0.5, 0.25, 2.0);
    for color in [WHITE, RED] {
        let picture = render(&perspective([16, 16]), &[&Hair::new(0.4, &[(&across(0.0, 0.0), color)])], 16);
        for x in 0..16 {
            assert_near(pixel(&picture, x, 7), premultiplied(color));
            assert_near(pixel(&picture, x, 8), premultiplied(color));
            assert_near(pixel(&picture, x, 0), DVec4::ZERO);
        }
        let alpha = f64::from(color[3]);
        let picture = picture.over(&[scene; 256]);
        let expected = premultiplied(color).truncate() + (1.0 - alpha) * scene;
        assert!(picture[8 * 16 + 8].distance(expected) < 1e-6);
        assert_eq!(picture[0], scene);
    }
}

#[test]
fn of_two_strands_that_cross_the_nearer_is_in_front() {
    for (red, blue) in [(0.5, -0.5), (-0.5, 0.5)] {
        let (a, b) = (across(0.0, red), upright(0.0, blue));
        let together = Hair::new(0.3, &[(&a, RED), (&b, BLUE)]);
        let [one, other] = [Hair::new(0.3, &[(&a, RED)]), Hair::new(0.3, &[(&b, BLUE)])];
        let (front, back) = if red > blue { (RED, BLUE) } else { (BLUE, RED) };
        for hair in [&[&together][..], &[&one, &other], &[&other, &one]] {
            let picture = render(&perspective([16, 16]), hair, 16);
            assert_near(pixel(&picture, 8, 8), over(premultiplied(front), premultiplied(back)));
            assert_near(pixel(&picture, 1, 8), premultiplied(RED));
            assert_near(pixel(&picture, 8, 1), premultiplied(BLUE));
        }
    }
}

#[test]
fn a_stack_of_layers_lets_through_what_each_lets_through() {
    for (count, alpha) in [(1u16, 0.25f32), (7, 0.3), (40, 0.1), (300, 0.02)] {
        // The farthest first, each a little redder than the one before it.
        let share = |i: u16| f32::from(i) / f32::from(count);
        let points: Vec<_> = (0..count).map(|i| across(0.0, -1.0 + 2.0 * share(i))).collect();
        let strands: Vec<_> =
            points.iter().zip(0..).map(|(points, i)| (&points[..], [share(i), 0.5, 0.0, alpha])).collect();
        let picture = render(&perspective([8, 8]), &[&Hair::new(0.3, &strands)], 4);
        let (a, behind) = (f64::from(alpha), |n: u16| (1.0 - f64::from(alpha)).powi(n.into()));
        let red: f64 = (0..count).map(|i| f64::from(share(count - 1 - i)) * a * behind(i)).sum();
        let hidden = 1.0 - behind(count);
        assert_near(pixel(&picture, 4, 4), DVec4::new(red, 0.5 * hidden, 0.0, hidden));
    }
}

#[test]
fn nothing_of_the_nearest_layers_is_lost_behind_opaque_ones() {
    let points: Vec<_> = (0..5000u16).map(|i| across(0.0, 1.0 - 2.0 * f32::from(i) / 5000.0)).collect();
    let strands: Vec<_> = points.iter().map(|points| (&points[..], [0.5, 0.25, 1.0, 0.9])).collect();
    let picture = render(&perspective([8, 8]), &[&Hair::new(0.3, &strands)], 4);
    assert_near(pixel(&picture, 4, 4), DVec4::new(0.5, 0.25, 1.0, 1.0));
}

#[test]
fn a_joint_counts_once() {
    // Bends of 10 to 170 degrees; beyond them the ray meets the two arms apart.
    for degrees in [0.0f32, 10.0, 60.0, 90.0, 130.0, 170.0] {
        let turn = degrees.to_radians();
        let points = [Vec3::NEG_X * 2.0, Vec3::ZERO, Vec3::new(turn.cos(), turn.sin(), 0.0) * 2.0];
        let hair = Hair::new(0.1, &[(&points, RED)]);
        let view = perspective([64, 64]);
        let truth = Truth::new(&view, &[hair.section()], None).unwrap();
        let picture = truth.render(samples(8), &|_| ());
        let alphas = picture.pixels().iter().map(|pixel| pixel.w);
        assert_eq!(alphas.clone().fold(0.0, f64::max), 0.5, "{degrees}");
        let covered = alphas.filter(|&alpha| alpha == 0.5).count();
        assert!(covered > 200, "{degrees}: {covered} pixels");
        assert_eq!(truth.layers(DVec2::splat(32.01)).len(), 1);
        assert_near(pixel(&picture, 32, 32), premultiplied(RED));
        assert_near(pixel(&picture, 31, 31), premultiplied(RED));
    }
}

#[test]
fn a_strand_that_passes_over_itself_counts_twice() {
    // A hairpin towards the back: the two arms are one behind the other.
    let points =
        [Vec3::new(-2.0, 0.0, 0.5), Vec3::new(0.5, 0.0, 0.5), Vec3::new(0.5, 0.0, -0.5), Vec3::new(-2.0, 0.0, -0.5)];
    let hair = Hair::new(0.125, &[(&points, RED)]);
    let truth = Truth::new(&orthographic([16, 16]), &[hair.section()], None).unwrap();
    let layers = truth.layers(DVec2::new(4.0, 8.0));
    let distances: Vec<f64> = layers.iter().map(|layer| layer.distance).collect();
    assert_eq!(distances, [3.375, 4.375]);
    // Along the bend the ray stays inside.
    assert_eq!(truth.layers(DVec2::new(12.0, 8.0)).len(), 1);
    let picture = truth.render(samples(4), &|_| ());
    assert_near(pixel(&picture, 4, 8), DVec4::new(0.6, 0.1875, 0.09375, 0.75));
    assert_near(pixel(&picture, 12, 8), premultiplied(RED));
}

#[test]
fn a_fibre_that_is_seen_end_on_is_one_disc() {
    let points: Vec<Vec3> = (0..20).map(|i| Vec3::new(0.0, 0.0, 1.0 - 0.1 * i as f32)).collect();
    let hair = Hair::new(0.5, &[(&points, RED)]);
    let truth = Truth::new(&orthographic([64, 64]), &[hair.section()], None).unwrap();
    let picture = truth.render(samples(256), &|_| ());
    let disc = std::f64::consts::PI * 0.25 / 4.0;
    let found = mean_alpha(&picture) / 0.5;
    assert!((found / disc - 1.0).abs() < 2e-4, "{found} of the picture, a disc has {disc}");
    assert!(picture.pixels().iter().all(|pixel| pixel.w <= 0.5), "one layer");
    for (at, x) in [(DVec2::splat(32.0), 0.0), (DVec2::new(44.0, 32.0), 0.375)] {
        let layers = truth.layers(at);
        assert_eq!(layers.len(), 1);
        let cap: f64 = 3.0 - f64::sqrt(0.25 - x * x);
        assert!((layers[0].distance - cap).abs() < 1e-6, "{layers:?}");
    }
}

#[test]
fn a_strand_through_the_near_plane_begins_there() {
    // The near plane is at z = 3.5; the axis meets it at x = 0.
    let points = [Vec3::new(-0.5, 0.0, 4.5), Vec3::new(1.0, 0.0, 1.5)];
    let mut hair = Hair::new(0.01, &[(&points, RED)]);
    hair.colors = vec![[0.0, 0.0, 0.0, 0.5], [1.0, 1.0, 1.0, 0.5]];
    let truth = Truth::new(&perspective([16, 16]), &[hair.section()], None).unwrap();
    let layers = truth.layers(DVec2::splat(8.0));
    assert_eq!(layers.len(), 1, "{layers:?}");
    assert!((layers[0].distance - 0.5).abs() < 1e-6, "the ray begins inside: {layers:?}");
    assert!((layers[0].color.x - 1.0 / 3.0).abs() < 1e-6, "a third of the way: {layers:?}");
    // On the left there is only what was cut off.
    let picture = truth.render(samples(16), &|_| ());
    assert!((0..7).all(|x| pixel(&picture, x, 8) == DVec4::ZERO));
    assert!((9..16).all(|x| pixel(&picture, x, 8).w > 0.0));
}

#[test]
fn what_is_in_front_of_the_near_plane_is_not_seen() {
    let hair = Hair::new(0.1, &[(&across(0.0, 3.7), WHITE), (&across(0.0, 5.0), WHITE)]);
    let picture = render(&perspective([8, 8]), &[&hair], 4);
    assert!(picture.pixels().iter().all(|pixel| *pixel == DVec4::ZERO));
    let hair = Hair::new(0.25, &[(&across(0.0, 3.7), WHITE)]);
    let picture = render(&perspective([8, 8]), &[&hair], 4);
    assert_near(pixel(&picture, 4, 4), DVec4::ONE);
}

#[test]
fn an_orthographic_view_shows_the_same_width_at_any_distance() {
    // 2 units on 64 pixels: 32 pixels a unit. Radius 0.25: 16 rows.
    for (z, rolled) in [(0.0f32, false), (-3.0, false), (0.0, true)] {
        let points = if rolled { upright(0.0, z) } else { across(0.0, z) };
        let picture = render(&orthographic([64, 64]), &[&Hair::new(0.25, &[(&points, RED)])], 4);
        for i in 0..64 {
            let expected = if (24..40).contains(&i) { premultiplied(RED) } else { DVec4::ZERO };
            let (x, y) = if rolled { (i, 20) } else { (20, i) };
            assert_near(pixel(&picture, x, y), expected);
        }
    }
}

#[test]
fn what_begins_behind_the_scene_is_hidden() {
    // In the middle, fibres begin at 4 - 0.2 and 5 - 0.2. Reverse depth without an end is near / distance.
    let hair = Hair::new(0.2, &[(&across(0.0, 0.0), RED), (&across(0.0, -1.0), BLUE)]);
    let both = over(premultiplied(RED), premultiplied(BLUE));
    let size = [64, 64];
    for (distance, expected) in
        [(3.79f32, DVec4::ZERO), (3.81, premultiplied(RED)), (4.79, premultiplied(RED)), (4.81, both)]
    {
        let depth = vec![0.5 / distance; 64 * 64];
        let truth = Truth::new(&perspective(size), &[hair.section()], Some(&depth)).unwrap();
        assert_near(pixel(&truth.render(samples(8), &|_| ()), 32, 32), expected);
    }
    // Pixel by pixel: a wall in front of the left half.
    let depth: Vec<f32> = (0..64 * 64).map(|i| if i % 64 < 32 { 0.5 } else { 0.0 }).collect();
    let truth = Truth::new(&perspective(size), &[hair.section()], Some(&depth)).unwrap();
    let picture = truth.render(samples(8), &|_| ());
    assert_near(pixel(&picture, 31, 32), DVec4::ZERO);
    assert_near(pixel(&picture, 32, 32), both);
}

#[test]
fn depth_of_the_scene_in_an_orthographic_view() {
    // Depth goes from 0 to 1 over 8 units; the fibre begins at 4 - 0.2.
    let hair = Hair::new(0.2, &[(&across(0.0, 0.0), RED)]);
    for (distance, expected) in [(3.79f32, DVec4::ZERO), (3.81, premultiplied(RED)), (8.0, premultiplied(RED))] {
        let depth = vec![distance / 8.0; 64 * 64];
        let truth = Truth::new(&orthographic([64, 64]), &[hair.section()], Some(&depth)).unwrap();
        assert_near(pixel(&truth.render(samples(8), &|_| ()), 32, 32), expected);
    }
}

#[test]
fn color_and_opacity_change_evenly_along_a_segment() {
    let mut hair = Hair::new(0.3, &[(&across(0.0, 0.0), RED)]);
    hair.colors = vec![[0.0, 1.0, 0.0, 0.25], [1.5, 1.0, 0.0, 1.0]];
    let truth = Truth::new(&orthographic([64, 64]), &[hair.section()], None).unwrap();
    for column in [0.25, 20.0, 32.0, 63.5] {
        let layers = truth.layers(DVec2::new(column, 30.0));
        let t = (column / 32.0 + 2.0) / 6.0;
        assert!((layers[0].color - DVec3::new(1.5 * t, 1.0, 0.0)).length() < 1e-6, "{layers:?}");
        assert!((layers[0].alpha - (0.25 + 0.75 * t)).abs() < 1e-6, "{layers:?}");
    }
}
