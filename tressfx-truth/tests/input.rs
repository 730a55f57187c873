//! Input that is empty, odd or wrong.

mod support;

use glam::{DVec4, Vec3};
use support::{Hair, assert_near, orthographic, perspective, pixel, premultiplied, render, samples};
use tressfx_core::strand_buffers::StrandShape;
use tressfx_core::view::{Pose, View};
use tressfx_truth::{Progress, Section, Truth, TruthError};

const RED: [f32; 4] = [0.8, 0.25, 0.125, 0.5];
const LINE: [Vec3; 3] = [Vec3::new(-3.0, 0.0, 0.0), Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)];

fn wide() -> Hair {
    Hair::new(0.4, &[(&LINE, RED)])
}

fn error(section: Section) -> TruthError {
    Truth::new(&perspective([8, 8]), &[section], None).unwrap_err()
}

#[test]
fn without_strands_there_is_nothing() {
    let picture = render(&perspective([8, 8]), &[], 4);
    assert_eq!(picture.pixels(), [DVec4::ZERO; 64]);
    let picture = render(&perspective([8, 8]), &[&Hair::new(0.1, &[])], 4);
    assert_eq!(picture.pixels(), [DVec4::ZERO; 64]);
    assert_eq!(picture.error().unwrap().max, 0.0);
    // Of any number of strands without a vertex.
    let mut hair = Hair::new(0.1, &[]);
    hair.shape = StrandShape { guides: u32::MAX, follows: u32::MAX, vertices: 0 };
    assert_eq!(render(&perspective([8, 8]), &[&hair, &wide()], 4), render(&perspective([8, 8]), &[&wide()], 4));
}

#[test]
fn a_view_without_a_pixel_and_one_of_a_single_pixel() {
    let whole = perspective([8, 8]);
    let minimized = View::new(whole.view_matrix(), whole.projection_matrix(), whole.depth(), [0, 8]).unwrap();
    assert!(render(&minimized, &[&wide()], 4).pixels().is_empty());
    let hair = Hair::new(1.5, &[(&LINE, RED)]);
    let picture = render(&perspective([1, 1]), &[&hair], 4);
    assert_near(pixel(&picture, 0, 0), premultiplied(RED));
}

#[test]
fn segments_at_a_bad_position_are_left_out_and_no_others() {
    for bad in [f32::NAN, f32::INFINITY, -1e12] {
        let mut hair = wide();
        hair.positions[2][1] = bad;
        let picture = render(&orthographic([16, 16]), &[&hair], 4);
        assert_near(pixel(&picture, 2, 8), premultiplied(RED));
        assert_near(pixel(&picture, 14, 8), DVec4::ZERO);
    }
    let mut hair = wide();
    hair.positions[1][0] = f32::NAN;
    assert!(render(&orthographic([16, 16]), &[&hair], 4).pixels().iter().all(|pixel| *pixel == DVec4::ZERO));
    // Large, but a place.
    let mut hair = wide();
    hair.positions[2][0] = 9e11;
    assert_near(pixel(&render(&orthographic([16, 16]), &[&hair], 4), 14, 8), premultiplied(RED));
}

#[test]
fn without_a_radius_nothing_is_seen() {
    let picture = render(&perspective([8, 8]), &[&Hair::new(0.0, &[(&LINE, RED)])], 16);
    assert_eq!(picture.pixels(), [DVec4::ZERO; 64]);
}

#[test]
fn opacities_of_0_and_1_and_beyond() {
    for (given, alpha) in [(0.0f32, 0.0f64), (1.0, 1.0), (-0.5, 0.0), (1.5, 1.0)] {
        let picture = render(&perspective([8, 8]), &[&Hair::new(0.4, &[(&LINE, [0.5, 0.25, 1.0, given])])], 4);
        assert_near(pixel(&picture, 4, 4), DVec4::new(0.5 * alpha, 0.25 * alpha, alpha, alpha));
    }
}

#[test]
fn vertices_in_one_place_are_a_ball() {
    let picture = render(&orthographic([64, 64]), &[&Hair::new(0.5, &[(&[Vec3::ZERO; 3], [1.0; 4])])], 64);
    let disc = std::f64::consts::PI * 256.0;
    let found = 4096.0 * support::mean_alpha(&picture);
    assert!((found / disc - 1.0).abs() < 1e-3, "{found} pixels, a disc has {disc}");
}

#[test]
fn a_depth_that_is_no_number_hides_nothing() {
    let hair = wide();
    let truth = Truth::new(&perspective([8, 8]), &[hair.section()], Some(&[f32::NAN; 64])).unwrap();
    assert_near(pixel(&truth.render(samples(4), &|_| ()), 4, 4), premultiplied(RED));
}

#[test]
fn arrays_of_another_length_are_refused() {
    let hair = wide();
    let section = hair.section();
    let short = error(Section { positions: &hair.positions[1..], ..section });
    assert_eq!(short.to_string(), "section 0: 2 positions, its counts ask for 3");
    assert!(matches!(error(Section { colors: &[], ..section }), TruthError::Length { what: "colours", .. }));
    assert!(matches!(error(Section { thickness: &[1.0; 4], ..section }), TruthError::Length { found: 4, .. }));
    let depth = Truth::new(&perspective([8, 8]), &[section], Some(&[0.0; 63])).unwrap_err();
    assert_eq!(depth, TruthError::Depth { found: 63, expected: 64 });
}

#[test]
fn numbers_that_cannot_be_drawn_are_refused() {
    let hair = wide();
    let section = hair.section();
    let mut colors = hair.colors.clone();
    colors[2][1] = f32::NAN;
    let refused = error(Section { colors: &colors, ..section });
    assert_eq!(refused, TruthError::Number { section: 0, what: "colour", index: 2 });
    assert!(matches!(error(Section { thickness: &[1.0, -0.1, 0.0], ..section }), TruthError::Number { index: 1, .. }));
    assert!(matches!(error(Section { fibre_radius: -1.0, ..section }), TruthError::Number { .. }));
    assert!(matches!(error(Section { tip_width: f32::NAN, ..section }), TruthError::Number { .. }));
    let pose = Pose { translation: Vec3::NAN, ..Pose::IDENTITY };
    assert!(matches!(error(Section { pose, ..section }), TruthError::Pose { section: 0, .. }));
}

#[test]
fn a_single_sample_has_no_estimate_and_odd_numbers_have_one() {
    let picture = render(&perspective([8, 8]), &[&wide()], 1);
    assert_eq!(picture.error(), None);
    assert!(render(&perspective([8, 8]), &[&wide()], 65).error().unwrap().rms > 0.0);
}

#[test]
fn progress_reaches_the_end() {
    let hair = wide();
    let last = std::sync::Mutex::new(0);
    let truth = Truth::new(&perspective([20, 9]), &[hair.section()], None).unwrap();
    truth.render(samples(1), &|Progress { done, tiles, .. }| {
        assert_eq!(tiles, 6);
        let mut last = last.lock().unwrap();
        *last = done.max(*last);
    });
    assert_eq!(*last.lock().unwrap(), 6);
}
