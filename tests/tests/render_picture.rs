//! Pictures of hair against the picture in f64 with every fragment kept and sorted.

mod support;

use glam::DVec4;
use tressfx_conformance::render::{Difference, Groom, Screen, Setup};
use tressfx_core::view::Pose;
use tressfx_render::{PpllDesc, reference};

use support::hair::material;
use support::screen;

fn nothing(screen: &Screen) -> impl Fn([u32; 2]) -> f32 + use<> {
    let far = screen.view.depth().far();
    move |_| far
}

#[test]
fn few_strands_are_as_in_f64() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 16) else { return };
    let groom = Groom::wavy(60, 12, 1, material());
    let picture = screen.hair(&[&groom]);
    let exact = reference::exact(&screen.view, &screen.lights, &[groom.reference()], &nothing(&screen));
    let difference = picture.difference(&exact);
    eprintln!("60 strands, k = 16: {difference:?}, {:?}", picture.counters);
    assert!(exact.iter().any(|pixel| pixel.w > 0.5), "the groom is in the picture");
    assert!(difference.max < 0.001 && difference.psnr > 88.0, "{difference:?}");
}

#[test]
fn fragments_and_pixels_are_counted_as_in_f64() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = Groom::wavy(300, 16, 2, material());
    let counters = screen.hair(&[&groom]).counters;
    let section = groom.reference();
    let colors = vec![DVec4::ONE * 0.7; groom.positions.len()];
    let mut pixels = std::collections::HashSet::new();
    let mut fragments = 0u32;
    let opaque = groom.material.with(|m| {
        m.opacity = 0.7;
        m.tip_opacity = 0.7;
    });
    let same = screen.hair(&[&Groom { material: opaque, ..groom.clone() }]).counters;
    reference::fill(&screen.view, &section, &colors, &nothing(&screen), &mut |fragment| {
        pixels.insert(fragment.pixel);
        fragments += 1;
    });
    eprintln!("{same:?}, in f64 {fragments} fragments on {} pixels", pixels.len());
    assert!(fragments > 10_000);
    // A pixel centre within rounding of the end of a segment or of the edge of the strip may fall either way.
    assert!(same.fragments.abs_diff(fragments) <= fragments / 2000);
    assert!(counters.fragments.abs_diff(fragments) <= fragments / 2000);
    assert!(same.pixels_with_hair.abs_diff(pixels.len() as u32) <= 2);
    assert_eq!(same.dropped, 0);
}

#[test]
fn what_lies_behind_the_sorted_ones_has_its_true_opacity() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = Groom::wavy(1500, 16, 3, material());
    let picture = screen.hair(&[&groom]);
    let exact = screen.exact(&[&groom]);
    let as_k = reference::resolved(&screen.view, &screen.lights, &[groom.reference()], &nothing(&screen), 8);
    let (to_exact, to_k) = (picture.difference(&exact), picture.difference(&as_k));
    let depth = f64::from(picture.counters.fragments) / f64::from(picture.counters.pixels_with_hair);
    eprintln!("{depth:.1} fragments a pixel, k = 8: to exact {to_exact:?}, to the same k in f64 {to_k:?}");
    assert!(to_k.max < 0.001 && to_k.psnr > 82.0, "{to_k:?}");
    assert!(to_exact.psnr > 45.0, "{to_exact:?}");
    let alpha = picture.pixels().iter().zip(&exact).map(|(a, b)| (a.w - b.w).abs()).fold(0.0, f64::max);
    assert!(alpha < 0.001, "alpha is exact whatever k is: {alpha}");
}

#[test]
fn more_sorted_fragments_come_closer_to_the_exact_picture() {
    let groom = Groom::wavy(1500, 16, 4, material().with(|m| m.variation = 1.0));
    let mut psnr = Vec::new();
    for k in [1, 4, 8, 16] {
        let Some(mut screen) = screen(|setup| setup.ppll().k = k) else { return };
        let exact = reference::exact(&screen.view, &screen.lights, &[groom.reference()], &nothing(&screen));
        psnr.push(screen.hair(&[&groom]).difference(&exact).psnr);
    }
    eprintln!("PSNR against exact order for k = 1, 4, 8, 16: {psnr:.1?}");
    assert!(psnr.is_sorted(), "{psnr:?}");
    assert!(psnr[3] > 53.0, "{psnr:?}");
}

#[test]
fn the_supersampled_truth_is_near() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 16) else { return };
    let groom = Groom::wavy(200, 16, 5, material().with(|m| m.fibre_radius = Some(0.003)));
    let truth = reference::supersampled(&screen.view, &screen.lights, &[groom.reference()], 8);
    let difference = screen.hair(&[&groom]).difference(&truth);
    eprintln!("against 64 samples a pixel: {difference:?}");
    assert!(difference.psnr > 39.0, "{difference:?}");
}

#[test]
fn twice_the_same_picture_to_the_bit() {
    let groom = Groom::wavy(6000, 16, 6, material());
    for (skips_hidden, least) in [(false, 1_000_000), (true, 500_000)] {
        let technique = PpllDesc::default().skips_hidden(skips_hidden).into();
        let sized = |setup: &mut Setup| (setup.technique, setup.size) = (technique, [320, 200]);
        let Some(mut screen) = screen(sized) else { return };
        let first = screen.hair(&[&groom]);
        assert!(first.counters.fragments > least, "many threads race: {:?}", first.counters);
        for _ in 0..4 {
            let again = screen.hair(&[&groom]);
            assert_eq!(first.counters, again.counters);
            assert!(first.bytes == again.bytes, "{:?}", Difference::between(&first.pixels(), &again.pixels()));
        }
    }
}

#[test]
fn sections_are_sorted_against_each_other() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 16) else { return };
    let blue = material().with(|m| {
        m.base_color = glam::Vec3::new(0.05, 0.1, 0.8);
        m.tip_color = glam::Vec3::new(0.05, 0.1, 0.8);
    });
    let (one, other) = (Groom::wavy(60, 12, 7, material()), Groom::wavy(40, 20, 8, blue));
    let picture = screen.hair(&[&one, &other]);
    let swapped = screen.hair(&[&other, &one]);
    assert!(picture.bytes == swapped.bytes, "the order of the sections is no order of depth");
    let exact =
        reference::exact(&screen.view, &screen.lights, &[one.reference(), other.reference()], &nothing(&screen));
    let difference = picture.difference(&exact);
    eprintln!("two sections: {difference:?}");
    assert!(difference.max < 0.002, "{difference:?}");
}

#[test]
fn a_pose_moves_the_hair_with_its_light() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 16) else { return };
    let rotation = glam::Quat::from_rotation_y(0.8) * glam::Quat::from_rotation_x(0.3);
    let pose = Pose { rotation, translation: glam::Vec3::new(0.1, -0.1, 0.2) };
    let groom = Groom { pose, ..Groom::wavy(60, 12, 9, material()) };
    let exact = reference::exact(&screen.view, &screen.lights, &[groom.reference()], &nothing(&screen));
    let difference = screen.hair(&[&groom]).difference(&exact);
    assert!(difference.max < 0.002, "{difference:?}");
    let still = reference::exact(
        &screen.view,
        &screen.lights,
        &[Groom { pose: Pose::IDENTITY, ..groom.clone() }.reference()],
        &nothing(&screen),
    );
    assert!(Difference::between(&exact, &still).psnr < 30.0, "the pose is seen");
}
