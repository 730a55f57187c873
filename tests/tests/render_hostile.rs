//! Strands that no groom should hold harm nothing but themselves.

mod support;

use glam::Vec3;
use tressfx_conformance::render::Groom;
use tressfx_render::Material;

use support::screen;

fn material() -> Material {
    Material::default().with(|m| {
        m.fibre_radius = Some(0.005);
        m.opacity = 0.7;
        m.tip_opacity = 0.5;
    })
}

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
fn segments_without_length_draw_nothing_and_hide_nothing() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 16) else { return };
    let strands = strands(30);
    let expected = screen.hair(&[&Groom::new(&strands, material())]);
    let point = |strand: &Vec<Vec3>| vec![strand[3]; 8];
    let mut points = Groom::new(&strands.iter().map(point).collect::<Vec<_>>(), material());
    points.tangents.fill([0.0; 4]);
    let alone = screen.hair(&[&points]);
    assert_eq!((alone.counters.fragments, alone.counters.pixels_with_hair), (0, 0));
    let both = screen.hair(&[&Groom::new(&strands, material()), &points]);
    assert!(both.bytes == expected.bytes);
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
