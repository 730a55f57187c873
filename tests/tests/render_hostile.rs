//! Strands that no groom should hold harm nothing but themselves.

mod support;

use std::f64::consts::PI;

use glam::Vec3;
use tressfx_conformance::render::Groom;

use support::hair::material;
use support::screen;

fn strands(count: u32) -> Vec<Vec<Vec3>> {
    let groom = Groom::wavy(count, 8, 1, material());
    let at = |strand: u32, vertex: u32| Vec3::from_slice(&groom.positions[(vertex * count + strand) as usize][..3]);
    (0..count).map(|strand| (0..8).map(|vertex| at(strand, vertex)).collect()).collect()
}

#[test]
fn positions_that_are_not_finite_leave_out_their_segments_alone() {
    positions_that_are_not_finite(16);
    positions_that_are_not_finite(0);
}

fn positions_that_are_not_finite(k: u32) {
    let Some(mut screen) = screen(|setup| setup.ppll().k = k) else { return };
    let whole = Groom::new(&strands(30), material());
    let expected = screen.hair(&[&whole]);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38, -1e13] {
        for axis in 0..3 {
            let mut groom = whole.clone();
            // One vertex in the middle of strand 4, one at the tip of strand 9, one at the root of strand 11.
            for (strand, vertex) in [(4, 3), (9, 7), (11, 0)] {
                groom.positions[vertex * 30 + strand][axis] = bad;
            }
            let picture = screen.hair(&[&groom]);
            assert!(picture.pixels().iter().all(|pixel| pixel.is_finite()), "{bad}");
            let lost = expected.counters.fragments - picture.counters.fragments;
            let segments = expected.counters.fragments as f64 / (30.0 * 7.0);
            let lost = f64::from(lost) / segments;
            assert!((2.0..7.0).contains(&lost), "{bad}: about four segments are gone, {lost}");
        }
    }
}

#[test]
fn strands_without_length_are_discs() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 16) else { return };
    let point = |i: i32| vec![Vec3::new(0.05 * i as f32 - 0.3, 0.033 * i as f32 - 0.2, 0.0); 8];
    let mut points = Groom::new(&(0..12).map(point).collect::<Vec<_>>(), material());
    points.tangents.fill([0.0; 4]);
    let picture = screen.hair(&[&points]);
    let pixels_per_unit = f64::from(screen.view.lens().focal.x) / 3.0;
    let radius = f64::from(points.reference().uniform.fibre_radius) * pixels_per_unit;
    // One half is the root's, the other half the tip's.
    let opacity = 0.5 * f64::from(material().opacity + material().tip_opacity);
    let (found, disc) = (picture.pixels().iter().map(|pixel| pixel.w).sum::<f64>() / 12.0, PI * radius * radius);
    eprintln!("{found:.4} pixels each, discs of {disc:.4} with opacity {opacity}");
    assert!((found / (disc * opacity) - 1.0).abs() < 0.25);
    assert!(picture.difference(&screen.exact(&[&points])).max < 0.001);
}

#[test]
fn segments_without_length_hide_nothing() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 16) else { return };
    let strands = strands(30);
    let doubled = |strand: &Vec<Vec3>| strand.iter().flat_map(|&point| [point, point]).collect();
    let doubled: Vec<Vec<Vec3>> = strands.iter().map(doubled).collect();
    let even = material().with(|m| {
        (m.tip_color, m.tip_opacity, m.root_shade) = (m.base_color, m.opacity, 0.0);
    });
    let pictures = [&strands, &doubled].map(|strands| {
        let mut groom = Groom::new(strands, even);
        groom.tangents.fill([0.0, 1.0, 0.0, 0.0]);
        screen.hair(&[&groom])
    });
    let difference = pictures[0].difference(&pictures[1].pixels());
    eprintln!("{difference:?}");
    // A turn is not seen across an edge that has no direction: there the segments are cut straight.
    assert!(pictures[0].counters.fragments > 500 && difference.psnr > 42.0, "{difference:?}");
}

#[test]
fn tangents_that_are_not_finite_do_not_spoil_their_neighbours() {
    for k in [0, 1] {
        let Some(mut screen) = screen(|setup| setup.ppll().k = k) else { return };
        let mut groom = Groom::new(&strands(30), material());
        groom.tangents[3 * 30 + 4] = [f32::NAN; 4];
        let picture = screen.hair(&[&groom]);
        assert!(picture.counters.fragments > 0);
        assert!(picture.pixels().iter().all(|pixel| pixel.is_finite()), "a colour that is not a number is black");
    }
}

#[test]
fn no_strand_and_one_strand() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let none = screen.hair(&[&Groom::new(&[], material())]);
    assert_eq!(none.counters, tressfx_render::Counters::default());
    assert!(none.bytes.iter().all(|&byte| byte == 0));
    let one = screen.hair(&[&Groom::new(&strands(1), material())]);
    assert!(one.counters.fragments > 20 && one.counters.dropped == 0);
    let smallest = Groom::new(&[vec![Vec3::ZERO, Vec3::X * 0.5]], material());
    assert!(screen.hair(&[&smallest]).counters.fragments > 10, "two vertices are a strand");
}

#[test]
fn strands_far_outside_the_picture_cost_nothing_and_long_ones_are_cut() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let away: Vec<_> = strands(30).iter().map(|s| s.iter().map(|&p| p + 100.0 * Vec3::X).collect()).collect();
    assert_eq!(screen.hair(&[&Groom::new(&away, material())]).counters.fragments, 0);
    let long = Groom::new(&[vec![Vec3::new(-1e6, 0.01, 0.0), Vec3::new(1e6, 0.01, 0.0)]], material());
    let short = Groom::new(&[vec![Vec3::new(-3.0, 0.01, 0.0), Vec3::new(3.0, 0.01, 0.0)]], material());
    let (long, short) = (screen.hair(&[&long]), screen.hair(&[&short]));
    assert_eq!(long.counters.pixels_with_hair, short.counters.pixels_with_hair);
    let alpha = |picture: &tressfx_conformance::render::Picture| picture.pixels().iter().map(|p| p.w).sum::<f64>();
    // The tip's opacity is far away on one of them and near on the other: the sum is that of the middle.
    assert!((alpha(&long) / alpha(&short) - 1.0).abs() < 0.01, "{} {}", alpha(&long), alpha(&short));
}
