//! Lists that do not hold all fragments: no pixel loses hair, and the order of the nearest is exact as long as they find room.

mod support;

use glam::{DVec3, DVec4, Vec3};
use tressfx_conformance::faulty::Faulty;
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_core::backend::Backend;
use tressfx_render::{Counters, Fill, PpllDesc, Tail, reference};

use support::hair::material;
use support::{gpu, screen};

fn lists(desc: PpllDesc) -> impl FnOnce(&mut Setup) {
    move |setup| setup.technique = desc.into()
}

fn in_f64(screen: &Screen, groom: &Groom, k: u32) -> Vec<DVec4> {
    let far = screen.view.depth().far();
    reference::resolved(&screen.view, &screen.lights, &[groom.reference()], &|_| far, k as usize)
}

/// The largest difference of opacity from that of all fragments.
fn alpha_error(screen: &Screen, groom: &Groom, picture: &Picture) -> f64 {
    let exact = screen.exact(&[groom]);
    picture.pixels().iter().zip(&exact).map(|(a, b)| (a.w - b.w).abs()).fold(0.0, f64::max)
}

#[test]
fn a_cap_changes_memory_and_the_picture_only_below_k() {
    let groom = Groom::wavy(1500, 16, 3, material());
    let Some(mut screen) = screen(|_| ()) else { return };
    let mut shown = |desc: PpllDesc| {
        screen.turn_to(&Setup { technique: desc.into(), ..Setup::default() });
        screen.hair(&[&groom])
    };
    let tails =
        [(Tail::Shaded, &[0, 8, 32][..]), (Tail::Weighted, &[0, 3, 5, 8]), (Tail::Unshaded, &[8]), (Tail::None, &[3])];
    for (fill, (tail, ks)) in [Fill::Compute, Fill::Raster].into_iter().flat_map(|fill| tails.map(|tail| (fill, tail)))
    {
        let desc = PpllDesc::default().tail(tail).fill(fill);
        let settings: Vec<_> = ks.iter().flat_map(|k| [0, 1, 3, 8, 40].map(|cap| (*k, cap))).collect();
        for least in [0, 1, 3, 5, 8, 32] {
            let expected = shown(desc.k(least));
            for &(k, cap) in settings.iter().filter(|(k, cap)| (*k).min(*cap) == least) {
                let picture = shown(desc.k(k).cap(cap));
                assert!(picture.bytes == expected.bytes, "{fill:?}, k = {k}, {tail:?}, a cap of {cap}");
                let Counters { fragments, pixels_with_hair, .. } = expected.counters;
                let most = least * pixels_with_hair;
                assert!(picture.counters.wanted <= most + most / 100, "{:?}", picture.counters);
                assert_eq!(picture.counters, Counters { wanted: picture.counters.wanted, ..expected.counters });
                assert_eq!((picture.counters.fragments, picture.counters.merged), (fragments, 0));
            }
        }
    }
}

#[test]
fn a_pool_without_room_for_all_draws_what_a_large_one_draws() {
    let groom = Groom::wavy(1500, 16, 3, material());
    let Some(mut roomy) = screen(|_| ()) else { return };
    let expected = roomy.hair(&[&groom]);
    let needed = 8 * expected.counters.pixels_with_hair;
    assert!(expected.counters.fragments > 4 * needed, "{:?}", expected.counters);
    for fill in [Fill::Compute, Fill::Raster] {
        let small = PpllDesc::default().max_node_bytes(16 * u64::from(needed + needed / 50)).fill(fill);
        // It is known before the first frame, and again after one that nobody has predicted.
        let Some(mut predicted) = screen(lists(small)) else { return };
        let picture = predicted.hair(&[&groom]);
        assert!(picture.bytes == expected.bytes, "{fill:?}: {:?}", picture.counters);
        assert_eq!((picture.counters.dropped, picture.counters.merged), (0, 0));
        let Some(mut measured) = screen(lists(small)) else { return };
        measured.may_grow = false;
        let first = measured.hair(&[&groom]);
        assert!(first.counters.dropped > 0);
        assert!(measured.renderer.grow_to_measured(&mut *measured.backend, &first.counters).unwrap());
        let second = measured.hair(&[&groom]);
        let again = measured.renderer.grow_to_measured(&mut *measured.backend, &second.counters).unwrap();
        assert!(again || second.bytes == expected.bytes, "{:?}", second.counters);
        assert!(measured.hair(&[&groom]).bytes == expected.bytes, "{fill:?}");
    }
}

/// A screen on a device whose bindings hold so many bytes.
fn narrow_screen(bytes: u64, change: impl FnOnce(&mut Setup)) -> Option<Screen> {
    let backend = gpu()?;
    let mut caps = backend.caps().clone();
    caps.max_storage_binding_bytes = bytes;
    Some(Screen::new(Box::new(Faulty::claiming(*backend, caps)), change))
}

#[test]
fn nodes_that_one_binding_cannot_hold_lie_in_two() {
    let groom = Groom::wavy(1500, 16, 3, material());
    let lists = PpllDesc::default();
    let of_tails = [lists, lists.tail(Tail::Weighted), lists.k(0), lists.places(4), lists.skips_hidden(true)];
    for desc in of_tails.into_iter().flat_map(|desc| [desc, desc.fill(Fill::Raster)]) {
        for has_output in [false, true] {
            let setup = |setup: &mut Setup| (setup.technique, setup.hair_output) = (desc.into(), has_output);
            let Some(mut roomy) = screen(setup) else { return };
            let expected = roomy.hair(&[&groom]);
            let fragments = u64::from(expected.counters.fragments);
            for (share, is_bounded) in [(0.6, false), (0.3, true)] {
                let of_one = (fragments as f64 * share) as u64;
                let node_bytes = if desc.places > 1 { 20 } else { 16 };
                let Some(mut narrow) = narrow_screen(node_bytes * of_one, setup) else { return };
                // It is not predicted how much is hidden: then lists may be bounded at first.
                narrow.may_grow = false;
                let mut picture = narrow.hair(&[&groom]);
                while narrow.renderer.grow_to_measured(&mut *narrow.backend, &picture.counters).unwrap() {
                    picture = narrow.hair(&[&groom]);
                }
                let capacity = u64::from(narrow.renderer.capacity());
                assert_eq!(capacity > of_one, !is_bounded, "{desc:?}: room for {capacity}, {of_one} a binding");
                assert!(picture.bytes == expected.bytes, "{desc:?}, depth {has_output}: {:?}", picture.counters);
                assert_eq!((picture.counters.dropped, picture.counters.merged), (0, 0));
            }
        }
    }
}

#[test]
fn pools_of_few_nodes_keep_the_opacity_of_every_pixel() {
    let groom = Groom::wavy(1500, 16, 3, material());
    let Some(mut roomy) = screen(|_| ()) else { return };
    let all = roomy.hair(&[&groom]).counters;
    for nodes in [1, 100, 2 * all.pixels_with_hair, 4 * all.pixels_with_hair] {
        let Some(mut screen) = screen(|setup| setup.ppll().max_node_bytes = 16 * u64::from(nodes)) else { return };
        let first = screen.hair(&[&groom]);
        let error = alpha_error(&screen, &groom, &first);
        assert_eq!(first.counters.pixels_with_hair, all.pixels_with_hair, "no pixel loses its hair");
        assert_eq!((first.counters.fragments, first.counters.dropped), (all.fragments, 0));
        assert!(first.counters.merged > 0 && error < 0.001, "room for {nodes}: {error}, {:?}", first.counters);
        // Once it is measured how many pixels there are, it is known how many of each find room: so many are in exact order.
        let mut measured = first.counters;
        while screen.renderer.grow_to_measured(&mut *screen.backend, &measured).unwrap() {
            measured = screen.hair(&[&groom]).counters;
        }
        let picture = screen.hair(&[&groom]);
        let kept = nodes / all.pixels_with_hair;
        let difference = picture.difference(&in_f64(&screen, &groom, kept));
        let before = first.difference(&in_f64(&screen, &groom, 8));
        eprintln!("room for {nodes}, k = {kept}: {difference:?}, alpha {error:.6}; before that, to k = 8 {before:?}");
        assert!(difference.psnr > 75.0 && difference.max < 0.006, "room for {nodes}: {difference:?}");
        assert!(before.psnr > 30.0, "room for {nodes}: {before:?}");
        assert!(picture.counters.merged > 0, "it is said that fewer than asked for are in order");
        for _ in 0..2 {
            assert!(screen.hair(&[&groom]).bytes == picture.bytes, "whatever the order in which fragments come");
        }
    }
}

#[test]
fn what_is_kept_is_what_f64_keeps() {
    let groom = Groom::wavy(600, 16, 2, material());
    for cap in [1, 3, 8] {
        let Some(mut screen) = screen(|setup| setup.ppll().cap = Some(cap)) else { return };
        let counters = screen.hair(&[&groom]).counters;
        let far = screen.view.depth().far();
        let mut pixels = std::collections::HashMap::<_, Vec<reference::Fragment>>::new();
        let colors = vec![DVec3::ONE.extend(0.6); groom.positions.len()];
        reference::fill(&screen.view, &groom.reference(), &colors, &|_| far, &mut |fragment| {
            pixels.entry(fragment.pixel).or_default().push(fragment);
        });
        let kept_of = |fragments: &Vec<reference::Fragment>| {
            let last = reference::nearest(fragments, cap as usize);
            fragments.iter().filter(|fragment| last.is_none_or(|last| fragment.nearness >= last)).count()
        };
        let kept = pixels.values().map(kept_of).sum::<usize>() as u32;
        eprintln!("a cap of {cap}: {} kept, {kept} in f64", counters.wanted);
        assert!(counters.wanted.abs_diff(kept) <= kept / 500, "{counters:?}, in f64 {kept}");
    }
}

#[test]
fn fragments_of_one_depth_are_kept_together() {
    // In a plane that faces the eye every fragment of a pixel has the same depth: all are as near as the last one that is kept.
    let strand = |i: u32| -> Vec<Vec3> {
        let x = (i % 40) as f32 / 40.0 - 0.5;
        (0..4).map(|v| Vec3::new(x + 0.01 * (i / 40) as f32, 0.5 - 0.3 * v as f32, 0.0)).collect()
    };
    let groom = Groom::new(&(0..120).map(strand).collect::<Vec<_>>(), material());
    let Some(mut all) = screen(|setup| setup.ppll().k = 2) else { return };
    let Some(mut capped) = screen(|setup| (setup.ppll().k, setup.ppll().cap) = (2, Some(2))) else { return };
    assert!(all.hair(&[&groom]).bytes == capped.hair(&[&groom]).bytes);
}

#[test]
fn a_cap_comes_and_goes_between_frames_with_its_memory() {
    let groom = Groom::wavy(400, 16, 5, material());
    let Some(mut screen) = screen(|_| ()) else { return };
    let expected = screen.hair(&[&groom]);
    let first = screen.renderer.technique_bytes();
    let (shaded, weighted) = (Tail::Shaded, Tail::Weighted);
    let changes = [(8, Some(8), shaded), (8, Some(8), weighted), (8, Some(2), shaded), (4, Some(8), weighted)];
    for (k, cap, tail) in changes.into_iter().chain([(8, None, weighted), (8, None, shaded)]) {
        let desc = PpllDesc::default().k(k).cap(cap).tail(tail);
        let before = (screen.backend_memory(), screen.renderer.technique_bytes());
        screen.renderer.retune(&mut *screen.backend, desc).unwrap();
        let after = (screen.backend_memory(), screen.renderer.technique_bytes());
        assert_eq!(after.0 as i64 - before.0 as i64, after.1 as i64 - before.1 as i64, "k = {k}, {cap:?}");
        let Some(mut fresh) = support::screen(lists(desc)) else { return };
        assert!(screen.hair(&[&groom]).bytes == fresh.hair(&[&groom]).bytes, "k = {k}, {cap:?}");
    }
    assert_eq!(screen.renderer.technique_bytes(), first);
    assert!(screen.hair(&[&groom]).bytes == expected.bytes);
}

#[test]
fn a_bounded_screen_takes_a_new_size_and_several_views() {
    let groom = Groom::wavy(200, 16, 5, material());
    let Some(mut fresh) = screen(|_| ()) else { return };
    let Some(mut screen) = screen(|setup| setup.ppll().cap = Some(8)) else { return };
    let before = (screen.backend_memory(), screen.renderer.technique_bytes());
    screen.renderer.resize(&mut *screen.backend, [300, 17]).unwrap();
    screen.renderer.resize(&mut *screen.backend, [96, 64]).unwrap();
    assert_eq!((screen.backend_memory(), screen.renderer.technique_bytes()), before, "nothing is left behind");
    let view = screen.view;
    assert!(screen.views(&[view, view], &[&groom]).bytes == fresh.views(&[view, view], &[&groom]).bytes);
}
