//! Shadows that are solved by hand. What is looked at is a fibre from left to right that covers the middle of the picture; the
//! rest of the strands is above and below it, out of sight.

mod support;

use glam::{DVec3, DVec4, Quat, Vec3};
use support::light::{Lamps, LitHair, lit, render_lit};
use support::{Hair, assert_near, orthographic, perspective, pixel, premultiplied, render, samples};
use tressfx_core::view::Pose;
use tressfx_truth::Light;

/// The colours that are given: what light makes of the fibre is another.
const GIVEN: [f32; 4] = [0.9, 0.9, 0.9, 0.75];
const RED: [f32; 3] = [0.8, 0.25, 0.125];
const BLUE: [f32; 3] = [0.125, 0.25, 1.5];
const ALPHA: f32 = 0.3;
const UP: Light = Light::Directional { towards: Vec3::new(0.0, 2.0, 0.0) };

/// From left to right at a height.
fn across(y: f32) -> [Vec3; 3] {
    [Vec3::new(-3.0, y, 0.0), Vec3::new(0.5, y, 0.0), Vec3::new(3.0, y, 0.0)]
}

/// The fibre at the height 0, and others.
fn hair(heights: &[f32]) -> LitHair {
    let points: Vec<_> = [0.0].iter().chain(heights).map(|&y| across(y)).collect();
    let strands: Vec<_> = points.iter().map(|points| (&points[..], GIVEN)).collect();
    LitHair::new(Hair::new(0.3, &strands), &[RED], BLUE, ALPHA)
}

fn shaded(color: [f32; 3], light: f64) -> DVec4 {
    let alpha = f64::from(GIVEN[3]);
    (alpha * light * DVec3::from_array(color.map(f64::from))).extend(alpha)
}

/// Which share of red light gets to the fibre, everywhere.
#[track_caller]
fn assert_light(hair: &[&LitHair], lamps: &Lamps, light: f64) {
    for view in [orthographic([8, 8]), perspective([8, 8])] {
        let picture = render_lit(&view, hair, lamps, 4);
        for (x, y) in (0..8).flat_map(|x| [(x, 3), (x, 4)]) {
            assert_near(pixel(&picture, x, y), shaded(RED, light));
        }
    }
}

fn left(count: i32) -> f64 {
    (1.0 - f64::from(ALPHA)).powi(count)
}

#[test]
fn each_strand_in_the_way_takes_its_share() {
    assert_light(&[&hair(&[])], &Lamps::from(UP), 1.0);
    assert_light(&[&hair(&[2.0])], &Lamps::from(UP), left(1));
    for count in [2, 5, 20] {
        let heights: Vec<f32> = (0..count).map(|i| 2.0 + 0.7 * i as f32).collect();
        assert_light(&[&hair(&heights)], &Lamps::from(UP), left(count));
    }
    // Strands that run through each other are two.
    assert_light(&[&hair(&[2.0, 2.1])], &Lamps::from(UP), left(2));
}

#[test]
fn what_is_darker_than_a_ten_thousandth_is_black() {
    let heights = |count: i32| (0..count).map(|i| 2.0 + 0.7 * i as f32).collect::<Vec<f32>>();
    assert!(left(25) > 1e-4 && left(26) < 1e-4);
    assert_light(&[&hair(&heights(25))], &Lamps::from(UP), left(25));
    let picture = render_lit(&orthographic([8, 8]), &[&hair(&heights(26))], &Lamps::from(UP), 4);
    assert_eq!(pixel(&picture, 4, 4), shaded(RED, 0.0));
}

#[test]
fn what_is_behind_the_fibre_or_behind_the_light_shades_nothing() {
    assert_light(&[&hair(&[-2.0, -4.0])], &Lamps::from(UP), 1.0);
    let lamp = |y| Lamps::from(Light::Point { position: Vec3::new(0.25, y, 0.0) });
    assert_light(&[&hair(&[2.0, 6.0])], &lamp(4.0), left(1));
    assert_light(&[&hair(&[2.0, 6.0])], &lamp(8.0), left(2));
    assert_light(&[&hair(&[6.0, -6.0])], &lamp(4.0), 1.0);
}

#[test]
fn a_light_on_the_axis_of_the_fibre_shines_on_it() {
    let mut hair = hair(&[]);
    // A ball at the place of the light.
    hair.hair.positions = vec![[0.125, 0.125, 0.0, 1.0]; 3];
    let lamps = Lamps::from(Light::Point { position: Vec3::new(0.125, 0.125, 0.0) });
    assert_near(pixel(&render_lit(&orthographic([8, 8]), &[&hair], &lamps, 4), 4, 3), shaded(RED, 1.0));
}

#[test]
fn a_strand_shades_itself_where_light_enters_it_again() {
    // Along its own axis light stays in one piece.
    for towards in [Vec3::X, Vec3::NEG_X] {
        assert_light(&[&hair(&[])], &Lamps::from(Light::Directional { towards }), 1.0);
    }
    let hairpin = |y: f32| {
        let points = [[-3.0, 0.0], [4.0, 0.0], [4.0, y], [-3.0, y]].map(|[x, y]| Vec3::new(x, y, 0.0));
        LitHair::new(Hair::new(0.3, &[(&points, GIVEN)]), &[RED], BLUE, ALPHA)
    };
    assert_light(&[&hairpin(2.0)], &Lamps::from(UP), left(1));
    assert_light(&[&hairpin(-2.0)], &Lamps::from(UP), 1.0);
    // The arms touch: it is one piece.
    assert_light(&[&hairpin(0.5)], &Lamps::from(UP), 1.0);
}

#[test]
fn a_joint_in_the_way_counts_once() {
    for degrees in [0.0f32, 20.0, 60.0] {
        let turn = Vec3::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0) * 6.0;
        let roof = [
            Vec3::new(0.0, 4.0, 0.0) - turn * Vec3::new(1.0, -1.0, 1.0),
            Vec3::new(0.0, 4.0, 0.0),
            Vec3::new(0.0, 4.0, 0.0) + turn,
        ];
        let mut hair = LitHair::new(Hair::new(0.3, &[(&across(0.0), GIVEN), (&roof, GIVEN)]), &[RED], BLUE, ALPHA);
        assert_light(&[&hair], &Lamps::from(UP), left(1));
        // A vertex that repeats another is no new strand.
        let vertices = hair.hair.shape.vertices as usize;
        hair.hair.positions[2 * (vertices - 1) + 1] = hair.hair.positions[2 * (vertices - 2) + 1];
        let lamps = Lamps::from(Light::Directional { towards: Vec3::new(-0.2, 1.0, 0.0) });
        let picture = render_lit(&orthographic([8, 8]), &[&hair], &lamps, 4);
        assert_near(pixel(&picture, 1, 4), shaded(RED, left(1)));
    }
}

#[test]
fn every_section_takes_the_share_of_its_own() {
    let (subject, above, upper) =
        (hair(&[]), LitHair { shadow_alpha: 0.5, ..hair(&[]) }, LitHair { shadow_alpha: 1.0, ..hair(&[]) });
    let raised = |mut lit: LitHair, y: f32| {
        lit.hair.positions.iter_mut().for_each(|position| position[1] += y);
        lit
    };
    let (above, upper) = (raised(above, 2.0), raised(upper, 4.0));
    let empty = LitHair::new(Hair::new(0.3, &[]), &[RED], BLUE, 0.9);
    assert_light(&[&empty, &subject, &above], &Lamps::from(UP), 0.5);
    assert_light(&[&above, &empty, &subject, &empty], &Lamps::from(UP), 0.5);
    assert_light(&[&above, &subject, &upper], &Lamps::from(UP), 0.0);
}

#[test]
fn opaque_triangles_let_nothing_through() {
    let triangle = |y: f32| vec![Vec3::new(-40.0, y, -20.0), Vec3::new(40.0, y, -20.0), Vec3::new(0.0, y, 40.0)];
    let with = |light: Light, triangles: Vec<Vec3>| Lamps { triangles, ..Lamps::from(light) };
    let lamp = Light::Point { position: Vec3::Y * 4.0 };
    assert_light(&[&hair(&[])], &with(UP, triangle(2.0)), 0.0);
    assert_light(&[&hair(&[])], &with(UP, triangle(2.0).into_iter().rev().collect()), 0.0);
    assert_light(&[&hair(&[])], &with(UP, triangle(-2.0)), 1.0);
    assert_light(&[&hair(&[])], &with(lamp, triangle(2.0)), 0.0);
    assert_light(&[&hair(&[])], &with(lamp, triangle(5.0)), 1.0);
    // Inside of the fibre, and just outside.
    assert_light(&[&hair(&[])], &with(UP, triangle(0.29)), 1.0);
    assert_light(&[&hair(&[])], &with(UP, triangle(0.31)), 0.0);
    let beside = triangle(2.0).into_iter().map(|point| point + 100.0 * Vec3::X).collect();
    assert_light(&[&hair(&[])], &with(UP, beside), 1.0);
    // A mesh has a pose: this one turns a wall into a roof.
    let wall = triangle(2.0).into_iter().map(|point| Vec3::new(point.x, -point.z, point.y)).collect();
    let pose = Pose { rotation: Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2), translation: Vec3::Y };
    assert_light(&[&hair(&[])], &Lamps { pose, ..with(UP, wall) }, 0.0);
}

#[test]
fn lights_add_up_and_each_has_its_own_shadow() {
    let mut hair = hair(&[2.0]);
    let green = [0.0, 1.0, 0.0];
    hair.lights = [RED, BLUE, green].map(|color| vec![color; hair.hair.positions.len()]).to_vec();
    let down = Light::Directional { towards: Vec3::NEG_Y };
    let lamps = Lamps { lights: vec![UP, down, Light::Shadowless], ..Lamps::default() };
    let expected = shaded(RED, left(1)) + shaded(BLUE, 1.0) + shaded(green, 1.0);
    let picture = render_lit(&orthographic([8, 8]), &[&hair], &lamps, 4);
    assert_near(pixel(&picture, 4, 4), expected.truncate().extend(GIVEN[3].into()));
}

#[test]
fn colors_in_a_light_go_linearly_along_a_segment() {
    let mut hair = hair(&[]);
    hair.lights = vec![hair.hair.positions.iter().map(|[x, ..]| [x + 3.0, 0.0, 0.0]).collect()];
    let picture = render_lit(&orthographic([64, 8]), &[&hair], &Lamps::from(UP), 64);
    for x in 0..64 {
        let middle = (f64::from(x) + 0.5) / 32.0 - 1.0;
        let found = pixel(&picture, x, 4).x / f64::from(GIVEN[3]);
        assert!((found - (middle + 3.0)).abs() < 1e-3, "{x}: {found}");
    }
}

#[test]
fn a_point_above_a_plane_sees_half_of_the_sky() {
    let far = 1e4;
    let [a, b, c, d] = [[-far, -far], [far, -far], [far, far], [-far, far]].map(|[x, z]| Vec3::new(x, -0.5, z));
    let floor = Lamps { triangles: vec![a, b, c, a, c, d], ..Lamps::default() };
    let bare = LitHair::new(Hair::new(0.3, &[(&across(0.0), GIVEN)]), &[], BLUE, ALPHA);
    // The mean over the upper half of the directions of 0.5 + 0.5 y is 3/4, over the lower half 1/4.
    for (sky, ground, whole, half) in [(1.0, 1.0, 1.0, 0.5), (1.0, 0.0, 0.5, 0.375), (0.0, 1.0, 0.5, 0.125)] {
        let (sky, ground) = (Vec3::splat(sky), Vec3::splat(ground));
        for (lamps, expected) in [(Lamps::default(), whole), (floor.clone(), half)] {
            let picture = render_lit(&orthographic([8, 8]), &[&bare], &Lamps { sky, ground, ..lamps }, 1024);
            let pixels: Vec<DVec4> = (0..8).flat_map(|x| [pixel(&picture, x, 3), pixel(&picture, x, 4)]).collect();
            let error = picture.error().unwrap();
            let worst =
                pixels.iter().map(|found| (*found - shaded(BLUE, expected)).abs().max_element()).fold(0.0, f64::max);
            assert!(worst < 4.0 * error.max.max(1e-7), "{sky} {ground}: {worst}, estimated {error:?}");
            let mean = pixels.iter().sum::<DVec4>() / 16.0;
            assert!(mean.distance(shaded(BLUE, expected)) < 1e-3, "{mean} is not {}", shaded(BLUE, expected));
        }
    }
}

#[test]
fn strands_shade_the_sky() {
    // A row of strands in the plane above: it takes its share of the upper half.
    let points: Vec<_> = (-60..=60).map(|i| [-100.0, 0.0, 100.0].map(|x| Vec3::new(x, 3.0, 0.5 * i as f32))).collect();
    let line = across(0.0);
    let mut strands = vec![(&line[..], GIVEN)];
    strands.extend(points.iter().map(|points| (&points[..], GIVEN)));
    let roofed = LitHair::new(Hair::new(0.2, &strands), &[], BLUE, 1.0);
    let lamps = Lamps { sky: Vec3::ONE, ground: Vec3::ONE, ..Lamps::default() };
    let picture = render_lit(&orthographic([8, 8]), &[&roofed], &lamps, 1024);
    let sum: DVec4 = (0..8).map(|x| pixel(&picture, x, 4)).sum();
    let share = sum.z / sum.w / f64::from(BLUE[2]);
    // Straight up 4/5 of the plane is covered, more at an angle, and strands end: between half and 3/5.
    assert!((0.5..0.6).contains(&share), "{share}");
}

#[test]
fn without_self_shadow_there_is_the_light_that_nothing_shades() {
    let mut hair = hair(&[2.0, 2.7]);
    let lamps = Lamps { sky: Vec3::new(0.5, 0.25, 1.0), ground: Vec3::new(0.1, 0.75, 0.0), ..Lamps::from(UP) };
    let around = DVec3::new(0.3, 0.5, 0.5).extend(1.0);
    for (self_shadow, light) in [(0.0, 1.0), (0.5, 0.5 + 0.5 * left(2)), (1.0, left(2))] {
        hair.self_shadow = self_shadow;
        let direct = render_lit(&orthographic([8, 8]), &[&hair], &Lamps::from(UP), 4);
        assert_near(pixel(&direct, 4, 4), shaded(RED, light));
        let picture = render_lit(&orthographic([8, 8]), &[&hair], &lamps, 4);
        let found = pixel(&picture, 4, 4).truncate();
        let open = (shaded(RED, 1.0) + shaded(BLUE, 1.0) * around).truncate();
        match self_shadow {
            0.0 => assert_near(found.extend(0.0), open.extend(0.0)),
            _ => assert!((open - found).min_element() > 0.01, "{found}"),
        }
    }
}

/// Many strands in front of each other.
fn stack() -> Hair {
    let points: Vec<_> = (0..40)
        .map(|i| [0.0, 0.5, 1.0].map(|t| Vec3::new(4.0 * t - 2.0, 0.01 * i as f32 * (t - 0.5), 0.05 * i as f32)))
        .collect();
    let strands: Vec<_> = points
        .iter()
        .zip(0..)
        .map(|(points, i)| (&points[..], [0.02 * i as f32, 0.5, 0.0, 0.1 + 0.01 * (i % 7) as f32]))
        .collect();
    Hair::new(0.3, &strands)
}

#[test]
fn one_layer_stands_for_all_of_a_ray() {
    let given = render(&orthographic([8, 8]), &[&stack()], 4096);
    let mut hair = LitHair::new(stack(), &[RED], [0.0; 3], ALPHA);
    hair.lights = vec![hair.hair.colors.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect()];
    let picture = render_lit(&orthographic([8, 8]), &[&hair], &Lamps::from(Light::Shadowless), 4096);
    for (found, expected) in picture.pixels().iter().zip(given.pixels()) {
        assert_eq!(found.w, expected.w, "the opacity is that of the given colours");
        let difference = (*found - *expected).abs().max_element();
        assert!(difference < 4.0 * picture.error().unwrap().max, "{found} is not {expected}");
    }
    assert!(picture.error().unwrap().max < 2e-3);
    assert_eq!((given.shadow_rays(), picture.shadow_rays()), (0, 0));
}

#[test]
fn a_picture_does_not_depend_on_threads_nor_on_whether_others_are_drawn() {
    let hair = LitHair::new(stack(), &[RED], BLUE, 0.05);
    let lamps = Lamps { sky: Vec3::ONE, ..Lamps::from(Light::Directional { towards: Vec3::new(0.3, 0.2, 1.0) }) };
    let truth = lit(&perspective([40, 24]), &[&hair], &lamps).unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| truth.render(samples(8), &|_| ()))
    };
    let (one, five) = (on(1), on(5));
    assert!(one == five && one.shadow_rays() > 1000, "{} rays", one.shadow_rays());
    assert_ne!(one.pixels(), render(&perspective([40, 24]), &[&stack()], 8).pixels());
    // Given colours are drawn as they are.
    let view = orthographic([8, 8]);
    assert_near(pixel(&render(&view, &[&self::hair(&[]).hair], 4), 4, 4), premultiplied(GIVEN));
}
