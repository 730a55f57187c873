//! Lists of fragments: how many are in order and what is seen behind them, against f64, and changed between frames.

mod support;

use glam::DVec4;
use tressfx_conformance::render::{Groom, Screen};
use tressfx_render::{Fill, K_RANGE, PpllDesc, ShortCutDesc, Tail, Technique, TilesDesc, reference};

use support::hair::material;
use support::screen;

const TAILS: [Tail; 4] = [Tail::Shaded, Tail::Weighted, Tail::Unshaded, Tail::None];

fn in_f64(screen: &Screen, grooms: &[&Groom], k: u32, tail: Tail) -> Vec<DVec4> {
    let far = screen.view.depth().far();
    let strands: Vec<_> = grooms.iter().map(|groom| groom.reference()).collect();
    reference::resolved_with_tail(&screen.view, &screen.lights, &strands, &|_| far, k as usize, tail)
}

fn retune(screen: &mut Screen, k: u32, tail: Tail) {
    let desc = PpllDesc::default().k(k).tail(tail);
    screen.renderer.retune(&mut *screen.backend, desc).unwrap();
}

#[test]
fn every_k_and_every_tail_is_as_in_f64() {
    // Two sections, so that hair without light has the mean of two colours.
    let blue = material().with(|m| m.base_color = glam::Vec3::new(0.05, 0.1, 0.8));
    let (one, other) = (Groom::wavy(900, 16, 3, material()), Groom::wavy(400, 12, 4, blue));
    let Some(mut screen) = screen(|_| ()) else { return };
    for k in [0, 1, 3, 8, 16, 32] {
        for tail in TAILS {
            retune(&mut screen, k, tail);
            let picture = screen.hair(&[&one, &other]);
            let difference = picture.difference(&in_f64(&screen, &[&one, &other], k, tail));
            eprintln!("k = {k}, {tail:?}: {difference:?}");
            assert!(difference.max < 0.006 && difference.psnr > 75.0, "k = {k}, {tail:?}: {difference:?}");
        }
    }
}

#[test]
fn weighted_tails_of_dense_hair_are_nearer_to_exact_order() {
    let groom = Groom::wavy(6000, 16, 3, material());
    let Some(mut screen) = screen(|_| ()) else { return };
    let exact = screen.exact(&[&groom]);
    for k in [3, 8] {
        let [shaded, weighted] = [Tail::Shaded, Tail::Weighted].map(|tail| {
            retune(&mut screen, k, tail);
            screen.hair(&[&groom]).difference(&exact).psnr
        });
        eprintln!("k = {k}: {shaded:.1} dB, weighted {weighted:.1} dB");
        assert!(weighted > shaded + 2.0, "k = {k}: {shaded:.1} dB, weighted {weighted:.1} dB");
    }
}

/// Dark hair, opaque and wide or faint, and far behind it dark hair that is all tail: its weights are the least.
#[test]
fn a_gap_before_a_dark_tail_leaves_it_its_colour() {
    let dark = |opacity: f32| {
        material().with(|m| {
            m.base_color = glam::Vec3::new(0.1, 0.05, 0.02);
            (m.opacity, m.tip_opacity) = (opacity, opacity);
        })
    };
    for opacity in [1.0, 0.3, 0.06] {
        let (front, mut back) = (Groom::wavy(1500, 12, 3, dark(opacity)), Groom::wavy(1500, 12, 4, dark(opacity)));
        back.positions.iter_mut().for_each(|position| position[2] -= 2.0);
        let Some(mut screen) = screen(|_| ()) else { return };
        for k in [3, 8] {
            retune(&mut screen, k, Tail::Weighted);
            let picture = screen.hair(&[&front, &back]);
            let difference = picture.difference(&in_f64(&screen, &[&front, &back], k, Tail::Weighted));
            eprintln!("opacity {opacity}, k = {k}: {difference:?}");
            assert!(difference.max < 0.01 && difference.psnr > 70.0, "opacity {opacity}, k = {k}: {difference:?}");
        }
    }
}

#[test]
fn tails_differ_and_opacity_does_not() {
    let groom = Groom::wavy(1500, 16, 3, material());
    let Some(mut screen) = screen(|_| ()) else { return };
    let mut pictures = Vec::new();
    for tail in TAILS {
        retune(&mut screen, 2, tail);
        pictures.push(screen.hair(&[&groom]).pixels());
    }
    let [shaded, weighted, unshaded, none] = &pictures[..] else { unreachable!() };
    assert!(shaded != unshaded && shaded != weighted && unshaded != none);
    for other in [weighted, unshaded] {
        assert!(shaded.iter().zip(other).all(|(a, b)| a.w == b.w), "the opacity is that of all");
    }
    assert!(shaded.iter().zip(none).all(|(a, b)| a.w >= b.w) && shaded.iter().zip(none).any(|(a, b)| a.w > b.w + 0.1));
    retune(&mut screen, 0, Tail::None);
    let empty = screen.hair(&[&groom]);
    assert!(empty.bytes.iter().all(|&byte| byte == 0) && empty.counters.pixels_with_hair > 1000);
}

#[test]
fn what_is_changed_between_frames_draws_as_a_renderer_of_its_own() {
    let groom = Groom::wavy(400, 16, 5, material());
    let Some(mut changed) = screen(|_| ()) else { return };
    let changes = [(3, Tail::None), (8, Tail::Shaded), (8, Tail::Weighted), (0, Tail::Unshaded), (3, Tail::None)];
    for (k, tail) in changes.into_iter().chain([(3, Tail::Weighted), (32, Tail::Shaded)]) {
        retune(&mut changed, k, tail);
        let Some(mut fresh) = screen(|setup| setup.technique = PpllDesc::default().k(k).tail(tail).into()) else {
            return;
        };
        assert!(changed.hair(&[&groom]).bytes == fresh.hair(&[&groom]).bytes, "k = {k}, {tail:?}");
        assert_eq!(changed.renderer.desc().technique, fresh.renderer.desc().technique);
    }
}

#[test]
fn what_cannot_be_changed_is_refused_and_nothing_changes() {
    let groom = Groom::wavy(100, 16, 5, material());
    let Some(mut screen) = screen(|_| ()) else { return };
    let expected = screen.hair(&[&groom]);
    let lists = PpllDesc::default();
    let refused: [(Technique, &str); 6] = [
        (lists.k(K_RANGE.end() + 1).into(), "from 0 to 32"),
        (lists.fill(Fill::Raster).into(), "needs a new renderer"),
        (lists.max_node_bytes(160).into(), "needs a new renderer"),
        (lists.places(4).into(), "needs a new renderer"),
        (ShortCutDesc::default().into(), "another technique"),
        (TilesDesc::default().into(), "another technique"),
    ];
    for (technique, said) in refused {
        let error = screen.renderer.retune(&mut *screen.backend, technique).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
        assert_eq!(screen.renderer.desc().technique, lists.into());
    }
    assert!(screen.hair(&[&groom]).bytes == expected.bytes);
}

#[test]
fn tiles_close_their_pixels_where_they_are_told_to() {
    let groom = Groom::wavy(1500, 16, 3, material());
    let Some(mut screen) = screen(|setup| setup.technique = TilesDesc::default().into()) else { return };
    let whole = screen.hair(&[&groom]);
    screen.renderer.retune(&mut *screen.backend, TilesDesc::default().closed_below(0.5)).unwrap();
    let early = screen.hair(&[&groom]);
    assert!(early.counters.fragments < whole.counters.fragments && early.bytes != whole.bytes);
    let other = TilesDesc::default().max_reference_bytes(400);
    assert!(screen.renderer.retune(&mut *screen.backend, other).is_err());
}
