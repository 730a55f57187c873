//! What hair hides from frame to frame is left out of tiles, and the picture is the same, to the bit.

mod support;

use glam::Vec3;
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_core::view::Pose;
use tressfx_render::{Counters, TilesDesc};

use support::hair::varied;
use support::screen;

/// Tiles that leave out what was hidden, or do not.
fn tiles(skips: bool) -> impl Fn(&mut Setup) {
    move |setup| (setup.technique, setup.size) = (TilesDesc::default().skips_hidden(skips).into(), [125, 90])
}

/// Hair through which nothing is seen in its middle.
fn dense() -> Groom {
    Groom::wavy(6000, 16, 3, varied().with(|m| m.fibre_radius = Some(0.01)))
}

/// The same somewhere else.
fn dense_at(x: f32, y: f32, z: f32) -> Groom {
    Groom { pose: Pose { translation: Vec3::new(x, y, z), ..Pose::IDENTITY }, ..dense() }
}

/// Both pictures of a frame, the one without what was hidden first.
fn both(screens: &mut [Screen; 2], grooms: &[&Groom]) -> [Picture; 2] {
    let [skipping, drawing] = screens;
    let pictures = [skipping.hair(grooms), drawing.hair(grooms)];
    assert!(pictures[0].bytes == pictures[1].bytes, "{:?}", pictures[0].difference(&pictures[1].pixels()));
    let seen = |of: &Picture| Counters { wanted: 0, ..of.counters };
    assert_eq!(seen(&pictures[0]), seen(&pictures[1]), "what is seen is counted once");
    pictures
}

fn screens() -> Option<[Screen; 2]> {
    Some([screen(tiles(true))?, screen(tiles(false))?])
}

#[test]
fn hair_behind_dense_hair_is_not_referred_to() {
    let Some(mut screens) = screens() else { return };
    let groom = dense();
    let [first, all] = both(&mut screens, &[&groom]);
    assert_eq!(first.counters.wanted, all.counters.wanted, "nothing is known of the first frame");
    for frame in 1..6 {
        let [picture, _] = both(&mut screens, &[&groom]);
        let (some, all) = (picture.counters.wanted, all.counters.wanted);
        eprintln!("{some} of {all}");
        // The first frame tells the next one where units end; what is hidden behind such units is left out in the second one, and less of it is at first.
        assert!(some < all * if frame == 2 { 97 } else { 93 } / 100, "{frame}: {some} of {all}");
    }
}

#[test]
fn hair_at_rest_hides_more_until_it_moves() {
    let Some(mut screens) = screens() else { return };
    let groom = dense();
    let [_, all] = both(&mut screens, &[&groom]);
    let wanted: Vec<u32> = (0..64)
        .map(|frame| {
            let picture = screens[0].hair(&[&groom]);
            assert!(picture.bytes == all.bytes, "frame {frame}");
            picture.counters.wanted
        })
        .collect();
    let (moving, at_rest) = (wanted[2], wanted[63]);
    eprintln!("{moving} of {} references, at rest {at_rest}", all.counters.wanted);
    assert!(at_rest < moving * 9 / 10, "{wanted:?}");
    // What it hid in a tile alone is seen now, and tiles are drawn again.
    let aside = dense_at(0.5, 0.2, 0.0);
    both(&mut screens, &[&aside]);
    both(&mut screens, &[&groom]);
    let [_, again] = [(); 2].map(|()| both(&mut screens, &[&groom])[0].counters.wanted);
    assert!(again > (moving + at_rest) / 2, "{again}");
}

#[test]
fn what_comes_into_sight_again_is_drawn() {
    let Some(mut screens) = screens() else { return };
    let groom = dense();
    let near = dense_at(0.0, 0.0, 0.9);
    let far = Groom::wavy(900, 16, 8, varied());
    let wanted = |pictures: [Picture; 2]| pictures.map(|picture| picture.counters.wanted);
    // It stands, moves, jumps aside, goes, comes back, and another one comes before it.
    both(&mut screens, &[&groom, &far]);
    let at = |x: f32, y: f32| dense_at(x, y, 0.0);
    for step in 1..6 {
        both(&mut screens, &[&at(0.01 * step as f32, 0.0), &far]);
    }
    let [some, all] = wanted(both(&mut screens, &[&at(0.05, 0.0), &far]));
    assert!(some < all);
    for groom in [&at(0.5, 0.2), &at(-0.7, 0.0), &at(3.0, 0.0), &groom, &groom, &near, &groom] {
        both(&mut screens, &[groom, &far]);
    }
    both(&mut screens, &[&far]);
    both(&mut screens, &[&far]);
    both(&mut screens, &[&groom, &far]);
}

#[test]
fn views_of_one_frame_and_lists_that_run_twice_draw_tiles_again() {
    let Some(mut screens) = screens() else { return };
    let (groom, far) = (dense(), Groom::wavy(900, 16, 8, varied()));
    let aside = dense_at(0.5, 0.2, 0.0);
    for runs in [1, 2] {
        for groom in [&groom, &groom, &groom, &aside, &groom] {
            let [skipping, drawing] = screens.each_mut().map(|screen| {
                let view = screen.view;
                screen.runs = runs;
                screen.views(&[view, view], &[groom, &far])
            });
            assert!(skipping.bytes == drawing.bytes, "{:?}", skipping.difference(&drawing.pixels()));
        }
    }
}

#[test]
fn what_is_left_out_makes_room_and_rounds_do_not_matter() {
    let (groom, far) = (dense(), Groom::wavy(900, 16, 8, varied()));
    let Some(mut roomy) = screen(tiles(false)) else { return };
    let all = roomy.hair(&[&groom, &far]);
    let few = TilesDesc::default().max_reference_bytes(u64::from(all.counters.wanted)).skips_hidden(true);
    let Some(mut screen) = screen(|setup| (setup.technique, setup.size) = (few.into(), [125, 90])) else { return };
    let first = screen.hair(&[&groom, &far]);
    screen.renderer.grow_to_measured(&mut *screen.backend, &first.counters).unwrap();
    for frame in 0..4 {
        let picture = screen.hair(&[&groom, &far]);
        assert!(picture.bytes == all.bytes && picture.counters.dropped == 0, "{frame}: {:?}", picture.counters);
    }
    let expected = roomy.hair(&[&far]);
    assert!(screen.hair(&[&far]).bytes == expected.bytes);
}

#[test]
fn where_references_are_many_for_their_room_more_is_left_out() {
    let Some([mut roomy, mut drawing]) = screens() else { return };
    let groom = dense();
    let all = drawing.hair(&[&groom]);
    let narrow = TilesDesc::default().max_reference_bytes(4 * u64::from(all.counters.wanted)).skips_hidden(true);
    let Some(mut narrow) = screen(|setup| (setup.technique, setup.size) = (narrow.into(), [125, 90])) else { return };
    let first = narrow.hair(&[&groom]);
    narrow.renderer.grow_to_measured(&mut *narrow.backend, &first.counters).unwrap();
    roomy.hair(&[&groom]);
    for frame in 1..10 {
        let pictures = [&mut roomy, &mut narrow].map(|screen| screen.hair(&[&groom]));
        assert!(pictures.iter().all(|picture| picture.bytes == all.bytes && picture.counters.dropped == 0));
        let wanted = pictures.map(|picture| picture.counters.wanted);
        eprintln!("{wanted:?} of {}", all.counters.wanted);
        assert!(frame < 3 || wanted[1] < wanted[0] * 9 / 10, "{frame}: {wanted:?}");
    }
}

#[test]
fn it_is_done_where_hair_is_dense_in_more_than_few_tiles() {
    let groom = Groom::wavy(12_000, 16, 3, varied().with(|m| m.fibre_radius = Some(0.01)));
    // The hair fills the picture, 48 tiles.
    for (few_tiles, is_done) in [(0, true), (47, true), (48, false)] {
        let close = |setup: &mut Setup| {
            (setup.technique, setup.size) = (TilesDesc::default().few_tiles(few_tiles).into(), [61, 45]);
            setup.camera.fov *= 0.3;
        };
        let Some(mut screen) = screen(close) else { return };
        let mut wanted = Vec::new();
        let first = screen.hair(&[&groom]);
        for _ in 0..3 {
            let picture = screen.hair(&[&groom]);
            screen.renderer.grow_to_measured(&mut *screen.backend, &picture.counters).unwrap();
            assert!(picture.bytes == first.bytes);
            wanted.push(picture.counters.wanted);
        }
        let has_less = wanted[2] < wanted[0] / 2;
        assert!(wanted[0] == first.counters.wanted && has_less == is_done, "{few_tiles} few: {wanted:?}");
    }
}
