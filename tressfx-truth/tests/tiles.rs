//! The tiles, the bounds and the early end of rays against the plain way: every ray through every segment.

mod support;

use glam::{DVec3, DVec4, Quat, Vec3};
use support::{Hair, orthographic, perspective, samples};
use tressfx_core::view::{Camera, Pose, View};
use tressfx_truth::{Layer, Section, Truth, sample_points};

/// Numbers in [0, 1) that are the same everywhere.
struct Random(u32);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = (self.0 >> ((self.0 >> 28) + 4) ^ self.0).wrapping_mul(277_803_737);
        (word >> 8) as f32 / (1 << 24) as f32
    }
}

/// Wavy strands all over the picture, tapered, of changing colours; some reach beyond the eye.
fn wavy(strands: u32, radius: f32, seed: u32) -> Hair {
    let mut random = Random(seed);
    let mut points = Vec::new();
    let mut colors = Vec::new();
    for _ in 0..strands {
        let root = Vec3::new(random.unit() - 0.5, 1.2, random.unit() - 0.5) * 1.6;
        let (phase, swing, depth) = (random.unit() * 6.3, 0.1 + 0.2 * random.unit(), 5.0 * random.unit());
        let point = |i: u8| {
            let s = f32::from(i) / 11.0;
            root + Vec3::new((phase + 9.0 * s).sin() * swing, -2.6 * s, s * depth + (phase + 5.0 * s).cos() * swing)
        };
        points.push((0..12).map(point).collect::<Vec<_>>());
        colors.push([random.unit(), random.unit(), random.unit(), 0.3 + 0.7 * random.unit()]);
    }
    let strands: Vec<_> = points.iter().zip(&colors).map(|(points, color)| (&points[..], *color)).collect();
    let mut hair = Hair::new(radius, &strands);
    hair.thickness = (0..hair.positions.len()).map(|i| 1.0 - (i / strands.len()) as f32 / 11.0).collect();
    hair
}

fn blended(layers: &[Layer]) -> DVec4 {
    let (color, through) = layers.iter().fold((DVec3::ZERO, 1.0), |(color, through), layer| {
        (color + through * layer.alpha * layer.color, through * (1.0 - layer.alpha))
    });
    color.extend(1.0 - through)
}

/// Holds the picture to the mean over all rays, each through every segment.
fn hold(view: &View, sections: &[Section], depth: Option<&[f32]>, count: u32) -> usize {
    let truth = Truth::new(view, sections, depth).unwrap();
    let picture = truth.render(samples(count), &|_| ());
    let (mut deepest, width) = (0, view.size()[0]);
    for (i, found) in (0..).zip(picture.pixels()) {
        let pixel = [i % width, i / width];
        let rays = sample_points(pixel, count).map(|at| {
            let layers = truth.layers(at);
            deepest = deepest.max(layers.len());
            assert!(layers.is_sorted_by_key(|layer| layer.distance));
            blended(&layers)
        });
        let expected = rays.sum::<DVec4>() / f64::from(count);
        assert!((*found - expected).abs().max_element() < 3e-9, "{pixel:?}: {found} is not {expected}");
    }
    deepest
}

#[test]
fn pictures_are_the_mean_of_rays_that_were_held_against_every_segment() {
    let [thick, thin] = [wavy(150, 0.08, 1), wavy(100, 0.005, 2)];
    let rolled = Pose { rotation: Quat::from_rotation_z(0.4), translation: Vec3::new(0.1, 0.0, 0.2) };
    let sections = [thick.section(), Section { pose: rolled, tip_width: 0.2, ..thin.section() }];
    let deepest = hold(&perspective([34, 27]), &sections, None, 7);
    assert!(deepest > 15, "{deepest} layers");
    hold(&orthographic([25, 25]), &sections, None, 5);
}

#[test]
fn also_behind_a_scene_and_from_amid_the_hair() {
    let hair = wavy(150, 0.04, 3);
    let depth: Vec<f32> = (0..34 * 27).map(|i| 0.5 / (1.0 + (i % 11) as f32)).collect();
    hold(&perspective([34, 27]), &[hair.section()], Some(&depth), 4);
    let camera = Camera { near: 0.05, far: f32::INFINITY, ..Camera::around(&[Vec3::ONE], [30, 20]) };
    for eye in [Vec3::new(0.0, 0.0, 0.5), Vec3::new(0.1, -0.4, 1.5)] {
        let view = Camera { eye, target: Vec3::new(0.3, -0.2, 0.1), fov: 1.6, ..camera }.view([30, 20]).unwrap();
        hold(&view, &[hair.section()], None, 4);
    }
}

#[test]
fn many_samples_are_followed_in_parts() {
    let hair = wavy(30, 0.02, 4);
    hold(&perspective([6, 5]), &[hair.section()], None, 200);
}

#[test]
fn the_picture_is_the_same_in_every_run() {
    let hair = wavy(500, 0.01, 5);
    let render = || Truth::new(&perspective([64, 48]), &[hair.section()], None).unwrap().render(samples(8), &|_| ());
    let first = render();
    assert!((0..4).all(|_| render() == first));
}
