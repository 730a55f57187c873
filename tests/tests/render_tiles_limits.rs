//! What tiles do where there is too little room, and with hair that no groom should hold.

mod support;

use glam::Vec3;
use glam::camera::rh;
use tressfx_conformance::render::{Groom, Random, Setup};
use tressfx_core::backend::{DepthOrder, Format};
use tressfx_core::pass::PassList;
use tressfx_core::view::{Pose, View};
use tressfx_render::{Counters, HairRenderer, RenderDesc, SectionDraw, TilesDesc};

use support::hair::{endless, is_sound, material, tiles, varied};
use support::screen;

#[test]
fn what_has_no_room_is_counted_and_its_room_is_exact() {
    let groom = Groom::wavy(400, 16, 1, material());
    let Some(mut roomy) = screen(tiles) else { return };
    let all = roomy.hair(&[&groom]);
    let wanted = all.counters.wanted;
    assert!(wanted > 6400 && all.counters.dropped == 0, "{:?}", all.counters);
    for room in [1, 4000, wanted / 2, wanted] {
        let few = TilesDesc::default().max_reference_bytes(4 * u64::from(room));
        let Some(mut screen) = screen(|setup| setup.technique = few.into()) else { return };
        let picture = screen.hair(&[&groom]);
        assert_eq!(picture.counters.wanted, wanted, "what is wanted is counted all the same");
        let beyond = wanted.saturating_sub(screen.renderer.capacity());
        assert!((beyond..=wanted).contains(&picture.counters.dropped), "{:?}", picture.counters);
        assert!(picture.pixels().iter().zip(all.pixels()).all(|(some, every)| some.w <= every.w + 0.001));
        assert!(is_sound(&picture));
        screen.renderer.grow_to_measured(&mut *screen.backend, &picture.counters).unwrap();
        let again = screen.hair(&[&groom]);
        // With room for a single one, 64 rounds do not reach.
        assert_eq!(again.counters.dropped > 0, room == 1, "{room} of {wanted}");
        assert!(room == 1 || again.bytes == all.bytes, "{room} of {wanted}");
    }
}

#[test]
fn tiles_without_room_show_nothing_of_the_frame_before() {
    let grooms = [Groom::wavy(100, 8, 1, material()), Groom::wavy(20, 16, 7, material())];
    let Some(mut roomy) = screen(tiles) else { return };
    let all = grooms.each_ref().map(|groom| roomy.hair(&[groom]));
    // The last pictures have 64 rounds of one reference, and tiles that are in none of them.
    let few = TilesDesc::default().max_reference_bytes(4);
    let Some(mut screen) = screen(|setup| setup.technique = few.into()) else { return };
    for which in [0, 0, 1] {
        let picture = screen.hair(&[&grooms[which]]);
        assert!(picture.counters.dropped > 64, "{:?}", picture.counters);
        assert!(picture.pixels().iter().zip(all[which].pixels()).all(|(some, every)| some.w <= every.w + 0.001));
        screen.renderer.grow_to_measured(&mut *screen.backend, &picture.counters).unwrap();
    }
}

/// Three frames of two grooms: rounds come with the second one, and what was hidden in the one before. None where there is no adapter.
fn three_frames(technique: TilesDesc, hair_output: bool) -> Option<Vec<(Vec<u8>, Counters)>> {
    let grooms = [Groom::wavy(300, 16, 3, varied()), Groom::wavy(60, 9, 5, material())];
    let mut screen = screen(|setup| {
        (setup.technique, setup.size, setup.hair_output) = (technique.into(), [93, 61], hair_output);
    })?;
    let mut frame = || {
        let picture = screen.hair(&grooms.each_ref());
        screen.renderer.grow_to_measured(&mut *screen.backend, &picture.counters).unwrap();
        (picture.bytes.clone(), Counters { wanted: 0, ..picture.counters })
    };
    Some((0..3).map(|_| frame()).collect())
}

/// Each kind, and the first one with depth and coverage of hair too.
fn with_and_without_output(kinds: &[TilesDesc]) -> impl Iterator<Item = (TilesDesc, bool)> {
    kinds.iter().map(|kind| (*kind, false)).chain(kinds.first().map(|kind| (*kind, true)))
}

#[test]
fn few_tiles_are_divided_among_more_groups_and_the_picture_is_the_same() {
    let plain = TilesDesc::default();
    let kinds = [plain, plain.places(4), plain.places(16), plain.skips_hidden(true), plain.max_reference_bytes(8_000)];
    for (kind, output) in with_and_without_output(&kinds) {
        let Some(undivided) = three_frames(kind.few_tiles(0), output) else { return };
        let is_bounded = kind.max_reference_bytes < plain.max_reference_bytes;
        assert_eq!(undivided[0].1.dropped > 0, is_bounded, "then it takes rounds: {:?}", undivided[0].1);
        for few in [20, u32::MAX] {
            let divided = three_frames(kind.few_tiles(few), output).unwrap();
            for (frame, (first, seen)) in undivided.iter().zip(&divided).enumerate() {
                // Which tiles have no room for their references is not said.
                assert!(first.1.dropped > 0 || first == seen, "{kind:?}, {few} few, frame {frame}");
            }
        }
    }
}

#[test]
fn groups_of_any_number_of_lanes_give_the_same_picture() {
    let plain = TilesDesc::default();
    let kinds = [plain, plain.places(4), plain.places(16), plain.skips_hidden(true).few_tiles(20)];
    for (kind, output) in with_and_without_output(&kinds) {
        let Some(usual) = three_frames(kind.lanes(160), output) else { return };
        for lanes in [96, 224].into_iter().filter(|lanes| kind.places == 1 || *lanes == 96) {
            let others = three_frames(kind.lanes(lanes), output).unwrap();
            assert!(usual == others, "{kind:?}, {lanes} lanes");
        }
    }
}

#[test]
fn a_group_has_no_other_number_of_lanes() {
    let Some(mut screen) = screen(tiles) else { return };
    for (lanes, places, can_be) in [(0, 1, "96 or 160 or 224"), (224, 4, "96 or 160"), (96, 64, "160")] {
        let desc = RenderDesc::new([8, 8], Format::Rgba16F).technique(TilesDesc::default().lanes(lanes).places(places));
        let error = HairRenderer::new(&mut *screen.backend, &desc).err().map(|error| error.to_string());
        let expected = format!("{lanes} lanes of a group with {places} places in a pixel, there can be {can_be}");
        assert!(error.as_ref().is_some_and(|error| error.ends_with(&expected)), "{error:?}");
    }
}

#[test]
fn what_is_measured_is_enough_for_the_next_frame() {
    let large = |setup: &mut Setup| {
        tiles(setup);
        setup.size = [320, 200];
    };
    let groom = Groom::wavy(2500, 16, 4, material());
    let Some(mut roomy) = screen(large) else { return };
    let expected = roomy.hair(&[&groom]);
    let (wanted, capacity) = (expected.counters.wanted, roomy.renderer.capacity());
    assert_eq!(expected.counters.dropped, 0);
    assert!(capacity < 4 * wanted, "the prediction is near: {capacity} for {wanted}");

    let Some(mut screen) = screen(large) else { return };
    // Room for the vertices, and for what a view needs that sees none of them.
    let strands = screen.section(&mut PassList::new(), &groom);
    let draw = SectionDraw::new(&strands, &groom.material, Pose::IDENTITY);
    let away = rh::view::look_at_mat4(Vec3::Z * 9.0, Vec3::Z * 10.0, Vec3::Y);
    let away = View::new(away, screen.view.projection_matrix(), DepthOrder::Reverse, [320, 200]).unwrap();
    screen.renderer.grow_to_predicted(&mut *screen.backend, &away, &[draw]).unwrap();
    screen.may_grow = false;
    let dropping = screen.hair(&[&groom]).counters;
    assert!(dropping.dropped > 0 && dropping.wanted == wanted, "{dropping:?}");
    screen.renderer.grow_to_measured(&mut *screen.backend, &dropping).unwrap();
    let complete = screen.hair(&[&groom]);
    assert_eq!(complete.counters.dropped, 0, "one frame is enough to know");
    assert!(complete.bytes == expected.bytes);
    let grown = screen.renderer.capacity();
    screen.renderer.grow_to_measured(&mut *screen.backend, &complete.counters).unwrap();
    assert_eq!(screen.renderer.capacity(), grown, "enough is enough");
}

#[test]
fn vertices_without_room_are_counted_and_have_it_in_the_next_frame() {
    let groom = Groom::wavy(300, 16, 4, material());
    let Some(mut roomy) = screen(tiles) else { return };
    let expected = roomy.hair(&[&groom]);
    assert!(expected.counters.vertices > 4000 && expected.counters.dropped == 0, "{:?}", expected.counters);
    let Some(mut screen) = screen(tiles) else { return };
    screen.may_grow = false;
    let dropping = screen.hair(&[&groom]);
    assert!(dropping.counters.dropped > 0, "{:?}", dropping.counters);
    assert!(dropping.counters.vertices == expected.counters.vertices && is_sound(&dropping));
    // Where vertices are missing, less is referred to than there is.
    for _ in 0..2 {
        let measured = screen.hair(&[&groom]).counters;
        screen.renderer.grow_to_measured(&mut *screen.backend, &measured).unwrap();
    }
    let complete = screen.hair(&[&groom]);
    assert!(complete.counters == expected.counters && complete.bytes == expected.bytes, "{:?}", complete.counters);
}

#[test]
fn many_sections_are_drawn_as_one() {
    let parts: Vec<Groom> = (0..100).map(|seed| Groom::wavy(6, 9, seed, varied())).collect();
    let Some(mut screen) = screen(endless) else { return };
    let parts: Vec<&Groom> = parts.iter().collect();
    let (picture, exact) = (screen.hair(&parts), screen.exact(&parts));
    let difference = picture.difference(&exact);
    assert!(picture.counters.dropped == 0 && difference.psnr > 80.0, "{difference:?}, {:?}", picture.counters);
}

#[test]
fn odd_screens_and_an_eye_within_the_hair() {
    let groom = Groom::wavy(300, 16, 2, material());
    for (size, limit) in [([1, 1], 1), ([16384, 1], 100), ([1, 300], 100), ([7, 9], 60)] {
        let Some(mut screen) = screen(|setup| {
            setup.technique = TilesDesc::default().closed_below(0.0).into();
            setup.size = size;
            setup.camera.fov = 1.0;
        }) else {
            return;
        };
        let picture = screen.hair(&[&groom]);
        assert!(is_sound(&picture) && picture.counters.fragments > limit, "{size:?}: {:?}", picture.counters);
        let difference = picture.difference(&screen.exact(&[&groom]));
        eprintln!("{size:?}: {difference:?}");
        assert!(difference.psnr > 70.0, "{size:?}: {difference:?}");
    }
    let Some(mut screen) = screen(|setup| {
        tiles(setup);
        setup.camera.eye = Vec3::new(0.1, 0.0, 0.2);
        setup.camera.near = 0.001;
    }) else {
        return;
    };
    // From nothing to strands that are wider than the picture.
    for radius in [0.0, 1e-6, 0.01, 3.0] {
        let wide = Groom { material: material().with(|m| m.fibre_radius = Some(radius)), ..groom.clone() };
        let picture = screen.hair(&[&wide]);
        assert!(is_sound(&picture), "radius {radius}");
        assert_eq!(picture.counters.fragments > 0, radius > 0.0, "radius {radius}: {:?}", picture.counters);
        assert_eq!(picture.counters.dropped, 0, "radius {radius}");
    }
}

#[test]
fn hair_that_is_wide_clear_or_opaque_is_as_in_f64() {
    let Some(mut screen) = screen(tiles) else { return };
    for (radius, opacity) in [(0.005, 1.0), (0.005, 0.0), (0.5, 1.0), (1.5, 0.05)] {
        let look = material().with(|m| {
            m.fibre_radius = Some(radius);
            (m.opacity, m.tip_opacity) = (opacity, opacity);
        });
        let groom = Groom::wavy(40, 6, 5, look);
        let picture = screen.hair(&[&groom]);
        let difference = picture.difference(&screen.exact(&[&groom]));
        eprintln!("radius {radius}, opacity {opacity}: {difference:?}, {:?}", picture.counters);
        if opacity == 0.0 {
            assert!(picture.bytes.iter().all(|&byte| byte == 0) && picture.counters.fragments == 0);
        } else {
            assert!(picture.counters.pixels_with_hair > 500 && difference.psnr > 70.0, "{difference:?}");
        }
    }
}

#[test]
fn every_strand_in_one_pixel() {
    let mut random = Random(5);
    // A pixel is 0.03 wide where they are; its middle is half of that from the middle of the picture.
    let strand = |_| {
        let (z, y) = (0.6 * random.unit() - 0.3, 0.004 * random.unit() - 0.016);
        vec![Vec3::new(0.004, y, z), Vec3::new(0.025, y, z)]
    };
    let look = material().with(|m| (m.opacity, m.tip_opacity, m.variation) = (0.002, 0.002, 1.0));
    let groom = Groom::new(&(0..10_000).map(strand).collect::<Vec<_>>(), look);
    let Some(mut screen) = screen(tiles) else { return };
    let picture = screen.hair(&[&groom]);
    let difference = picture.difference(&screen.exact(&[&groom]));
    eprintln!("{:?}, {difference:?}", picture.counters);
    assert!(picture.counters.fragments > 9000 && picture.counters.pixels_with_hair <= 4);
    assert!(difference.max < 0.002, "{difference:?}");
}

#[test]
fn positions_that_are_not_finite_leave_out_their_segments_alone() {
    let Some(mut screen) = screen(tiles) else { return };
    let whole = Groom::wavy(30, 8, 1, material());
    let expected = screen.hair(&[&whole]).counters;
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38, -1e13] {
        let mut groom = whole.clone();
        // One vertex in the middle of strand 4, one at the tip of strand 9, one at the root of strand 11.
        for (strand, vertex) in [(4, 3), (9, 7), (11, 0)] {
            groom.positions[vertex * 30 + strand][1] = bad;
        }
        let picture = screen.hair(&[&groom]);
        assert!(is_sound(&picture), "{bad}");
        let lost = f64::from(expected.fragments - picture.counters.fragments);
        let lost = lost * 30.0 * 7.0 / f64::from(expected.fragments);
        assert!((2.0..7.0).contains(&lost), "{bad}: about four segments are gone, {lost}");
    }
    let mut lost = whole.clone();
    lost.positions.fill([f32::NAN; 4]);
    let picture = screen.hair(&[&lost, &Groom::new(&[], material())]);
    assert!(picture.counters == Counters::default() && picture.bytes.iter().all(|&byte| byte == 0));
    lost.positions.fill([0.1, 0.1, 0.1, 1.0]);
    let points = screen.hair(&[&lost]);
    assert!(
        is_sound(&points) && (1..10).contains(&points.counters.pixels_with_hair),
        "strands that are points are discs"
    );
}
