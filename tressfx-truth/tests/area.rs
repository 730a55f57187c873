//! Areas that fibres cover, which samples can only come near to: how near goes with their number.

mod support;

use std::f64::consts::PI;

use glam::Vec3;
use support::{Hair, mean_alpha, orthographic, perspective, render};

/// Pixels a unit length in an orthographic view of 64 x 64.
const SCALE: f64 = 32.0;

/// The area that is covered, in pixels.
fn area(hair: &Hair, count: u32) -> f64 {
    64.0 * 64.0 * mean_alpha(&render(&orthographic([64, 64]), &[hair], count))
}

/// A capsule on the picture.
fn capsule(length: f64, radius: f64) -> f64 {
    SCALE * SCALE * (2.0 * radius * length + PI * radius * radius)
}

/// A fibre of a tenth of a pixel, aslant.
fn thin() -> (Hair, f64) {
    let points = [Vec3::new(-0.71, -0.37, 0.3), Vec3::new(0.66, 0.52, 0.3)];
    let radius = 0.05 / SCALE as f32;
    let length = f64::from(points[0].distance(points[1]));
    (Hair::new(radius, &[(&points, [1.0; 4])]), capsule(length, radius.into()))
}

#[test]
fn a_fibre_thinner_than_a_pixel_covers_its_width_times_its_length() {
    let (hair, exact) = thin();
    let errors: Vec<f64> = [16, 64, 256, 1024, 4096].iter().map(|&n| (area(&hair, n) / exact - 1.0).abs()).collect();
    eprintln!("thin fibre: relative errors of its area with 16 to 4096 samples: {errors:.5?}");
    assert!(errors[1] < 0.06, "{errors:?}");
    assert!(errors[4] < 0.003, "{errors:?}");
    assert!(errors[3] + errors[4] < 0.3 * (errors[0] + errors[1]), "the error falls: {errors:?}");
}

#[test]
fn the_error_of_single_pixels_falls_with_the_samples_and_is_estimated() {
    let (hair, _) = thin();
    let picture = |count| render(&orthographic([64, 64]), &[&hair], count);
    let exact = picture(16_384);
    let rms = |count| {
        let found = picture(count);
        let squares = found.pixels().iter().zip(exact.pixels()).map(|(a, b)| (*a - *b).length_squared());
        ((squares.sum::<f64>() / (4.0 * 4096.0)).sqrt(), found.error().unwrap().rms)
    };
    let found = [16, 64, 256, 1024].map(rms);
    eprintln!("RMS errors of pixels, found and estimated, with 16 to 1024 samples: {found:.6?}");
    for pair in found.windows(2) {
        assert!(pair[1].0 < 0.5 * pair[0].0, "faster than random samples would: {found:?}");
    }
    for (error, estimate) in found {
        assert!(estimate > 0.9 * error && estimate < 4.0 * error, "{found:?}");
    }
}

#[test]
fn a_fibre_that_narrows_to_a_point_is_a_triangle_and_a_half_disc() {
    let points = [Vec3::new(-0.5, 0.01, 0.0), Vec3::new(0.5, 0.01, 0.0)];
    let hair = Hair { thickness: vec![1.0, 0.0], ..Hair::new(0.2, &[(&points, [1.0; 4])]) };
    // The flanks touch the ball where their angle to the axis has the sine r / l.
    let (l, r) = (1.0f64, 0.2f64);
    let angle = (r / l).asin();
    let kite = r * (l * l - r * r).sqrt();
    let sector = r * r * (PI / 2.0 + angle);
    let exact = SCALE * SCALE * (kite + sector);
    let found = area(&hair, 256);
    assert!((found / exact - 1.0).abs() < 2e-4, "{found} pixels, exactly {exact}");
    // With a third of the width left at the tip.
    let wide = Hair { thickness: vec![1.0, 1.0 / 3.0], ..hair };
    let (a, b) = (0.2, 0.2 / 3.0);
    let angle = ((a - b) / l).asin();
    let middle = (a + b) * (l * l - (a - b) * (a - b)).sqrt();
    let ends = a * a * (PI / 2.0 + angle) + b * b * (PI / 2.0 - angle);
    let exact = SCALE * SCALE * (middle + ends);
    let found = area(&wide, 256);
    assert!((found / exact - 1.0).abs() < 2e-4, "{found} pixels, exactly {exact}");
}

#[test]
fn an_elbow_covers_the_union_of_its_arms() {
    let points = [Vec3::new(-0.6, 0.0, 0.0), Vec3::ZERO, Vec3::new(0.0, 0.6, 0.0)];
    let radius = 0.125;
    let found = area(&Hair::new(radius as f32, &[(&points, [1.0; 4])]), 256);
    // Two capsules that share the square in the inner corner, and the quarter discs around the joint on the sides of each arm.
    let shared = radius * radius + 3.0 * PI / 4.0 * radius * radius;
    let exact = 2.0 * capsule(0.6, radius) - SCALE * SCALE * shared;
    assert!((found / exact - 1.0).abs() < 2e-4, "{found} pixels, exactly {exact}");
}

#[test]
fn in_a_perspective_a_fibre_is_as_wide_as_its_tangents_are_apart() {
    // Across the whole picture at the distance 4: 64 pixels are 2 units at that distance.
    let points = [Vec3::new(-9.0, 0.0, 0.0), Vec3::new(9.0, 0.0, 0.0)];
    let hair = Hair::new(0.5, &[(&points, [1.0; 4])]);
    let found = mean_alpha(&render(&perspective([64, 64]), &[&hair], 256));
    // The half-width is where a line from the eye touches the circle: r / sqrt(d^2 - r^2), and 1 / 4 is the whole height.
    let exact = 4.0 * 0.5 / (16.0f64 - 0.25).sqrt();
    assert!((found / exact - 1.0).abs() < 1e-4, "{found} of the picture, exactly {exact}");
}
