//! Depth and coverage of the hair as outputs: against the f64 reference, and beside a picture that they do not change.

mod support;

use glam::camera::rh;
use glam::{DVec4, Vec3};
use tressfx_conformance::render::{Groom, NO_HAIR, Picture, Screen, Setup};
use tressfx_core::backend::{DepthOrder, Format, TextureDesc};
use tressfx_core::pass::PassList;
use tressfx_core::view::{Camera, View, Viewport};
use tressfx_render::{
    AutoDesc, DrawError, Fill, HAIR_FORMAT, PpllDesc, SectionDraw, ShadedStrands, ShortCutDesc, Tail, Targets,
    Technique, TilesDesc, ViewDraw, reference,
};

use support::hair::{faint, varied, wall};
use support::{backends, screen};

/// The alpha below which a fragment is faint.
const FAINT: f64 = 0.02;

const ORDERS: [DepthOrder; 2] = [DepthOrder::Standard, DepthOrder::Reverse];

/// Every technique, each way to fill it, and lists that keep all, some or none of the fragments.
fn techniques() -> Vec<Technique> {
    let (lists, layers) = (PpllDesc::default(), ShortCutDesc::default());
    vec![
        lists.into(),
        lists.k(0).into(),
        lists.fill(Fill::Raster).into(),
        lists.cap(3).into(),
        lists.cap(0).fill(Fill::Raster).into(),
        lists.k(0).cap(0).into(),
        lists.places(4).into(),
        lists.cap(3).tail(Tail::Weighted).into(),
        layers.into(),
        layers.k(1).ordered(true).fill(Fill::Raster).into(),
        layers.k(8).ordered(true).into(),
        TilesDesc::default().into(),
        TilesDesc::default().places(16).into(),
        TilesDesc::default().places(64).into(),
        AutoDesc::default().into(),
    ]
}

fn with(technique: impl Into<Technique>, hair_output: bool) -> impl FnOnce(&mut Setup) {
    let technique = technique.into();
    move |setup| (setup.technique, setup.hair_output) = (technique, hair_output)
}

/// The view of a screen with depth in another order.
fn in_order(depth: DepthOrder) -> View {
    let setup = Setup::default();
    Camera { depth, ..setup.camera }.view(setup.size).unwrap()
}

/// Depth and alpha of the fragments of each pixel of a view, the nearest first.
fn fragments(screen: &Screen, groom: &Groom, scene: &dyn Fn([u32; 2]) -> f32) -> Vec<Vec<[f64; 2]>> {
    let (view, strands) = (&screen.view, groom.reference());
    let vertices = (0..strands.uniform.vertices).flat_map(|v| (0..strands.uniform.strands).map(move |s| (s, v)));
    let colors: Vec<DVec4> =
        vertices.map(|(strand, v)| reference::shade(view, &screen.lights, &strands, strand, v)).collect();
    let [width, height] = view.size();
    let mut pixels = vec![Vec::new(); (width * height) as usize];
    reference::fill(view, &strands, &colors, scene, &mut |fragment| {
        let depth = match view.depth() {
            DepthOrder::Standard => 1.0 - fragment.nearness,
            DepthOrder::Reverse => fragment.nearness,
        };
        pixels[(fragment.pixel[1] * width + fragment.pixel[0]) as usize].push([depth, fragment.alpha]);
    });
    for pixel in &mut pixels {
        pixel.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if view.depth() == DepthOrder::Reverse {
            pixel.reverse();
        }
    }
    pixels
}

/// Whether a pixel has the depth that its fragments give it. An alpha within rounding of the bound may count either way.
fn has_depth(fragments: &[[f64; 2]], depth: f64) -> bool {
    const ROUNDING: f64 = 1e-4;
    let is = |fragment: &[f64; 2]| (fragment[0] - depth).abs() < 2e-6;
    let end = fragments.iter().position(|fragment| fragment[1] >= FAINT + ROUNDING);
    let mut may_count = fragments[..end.unwrap_or(fragments.len())].iter().filter(|f| f[1] >= FAINT - ROUNDING);
    match end {
        Some(end) => is(&fragments[end]) || may_count.any(is),
        None => is(&fragments[0]) || may_count.any(is),
    }
}

/// A pixel is closed when less than 1/1024 passes, and alpha is a half float.
const CLOSED: f64 = 0.0016;

/// How far the coverage of a pixel may be from that of fragments which know nothing of each other. With several places strands that run behind each
/// other cover less: that the picture is then as in f64 is held elsewhere, and coverage is that of the picture.
fn within(technique: Technique) -> f64 {
    let places = match technique {
        Technique::Ppll(lists) => lists.places,
        Technique::Tiles(tiles) => tiles.places,
        _ => 1,
    };
    if places > 1 { 0.3 } else { CLOSED }
}

/// Holds every pixel of a view against its fragments, and its coverage to be `within` so much. Says how many have hair, and how many of those have their depth from a
/// fragment that is not the nearest.
fn hold(name: &str, hair: &[[f32; 2]], alphas: &[f64], pixels: &[Vec<[f64; 2]>], within: f64) -> [usize; 2] {
    assert_eq!((hair.len(), alphas.len()), (pixels.len(), pixels.len()), "{name}");
    let mut seen = [0; 2];
    for (i, ((&found, &alpha), fragments)) in hair.iter().zip(alphas).zip(pixels).enumerate() {
        let coverage = 1.0 - fragments.iter().map(|fragment| 1.0 - fragment[1]).product::<f64>();
        if found == NO_HAIR {
            assert!(coverage < 1e-4 && alpha == 0.0, "{name}: pixel {i} has hair of {coverage}");
            continue;
        }
        let [depth, covered] = found.map(f64::from);
        assert_eq!(covered, alpha, "{name}: pixel {i} of the picture has that alpha");
        assert!((covered - coverage).abs() < within, "{name}: pixel {i} covers {covered}, not {coverage}");
        let first = fragments.first().map(|fragment| fragment[0]);
        assert!(coverage < 1e-4 || has_depth(fragments, depth), "{name}: pixel {i} is at {depth}, of {fragments:?}");
        seen[0] += 1;
        seen[1] += usize::from(first.is_some_and(|first| (first - depth).abs() > 1e-5));
    }
    seen
}

fn alphas(picture: &Picture) -> Vec<f64> {
    picture.pixels().iter().map(|pixel| pixel.w).collect()
}

#[test]
fn depth_and_coverage_are_as_in_f64_and_the_picture_is_the_same() {
    let grooms = [("dense", Groom::wavy(300, 16, 3, varied())), ("faint", Groom::wavy(120, 16, 5, faint()))];
    for technique in techniques() {
        // Two drivers may round in two ways: the picture without the output comes from the same one.
        for (backend, same) in backends().into_iter().zip(backends()) {
            let [mut screen, mut plain] = [(backend, true), (same, false)]
                .map(|(backend, hair_output)| Screen::new(backend, with(technique, hair_output)));
            for (order, (groom_name, groom)) in
                ORDERS.iter().flat_map(|order| grooms.iter().map(|groom| (*order, groom)))
            {
                let name = format!("{technique:?}, {order:?}, {groom_name}");
                [&mut screen, &mut plain].into_iter().for_each(|screen| screen.view = in_order(order));
                let picture = screen.hair(&[groom]);
                assert!(picture.bytes == plain.hair(&[groom]).bytes, "{name}: the picture is the same");
                let far = order.far();
                let of = fragments(&screen, groom, &|_| far);
                let seen = hold(&name, &picture.hair, &alphas(&picture), &of, within(technique));
                assert!(seen[0] > 900 && seen[0] < 96 * 64 - 900, "{name}: {seen:?}");
                assert!(seen[1] > 40, "{name}: faint fragments lie before others, {seen:?}");
            }
        }
    }
}

#[test]
fn depth_is_that_of_the_scene_before_which_hair_is_seen() {
    let groom = Groom::wavy(300, 16, 2, varied());
    for technique in techniques() {
        let Some(mut screen) = screen(with(technique, true)) else { return };
        for order in ORDERS {
            screen.view = in_order(order);
            let hair = screen.scene(&[&wall(0.0, 0.1)], &[&groom]).hair;
            let depth = screen.depth();
            let pixels = fragments(&screen, &groom, &|[x, y]| depth[(y * 96 + x) as usize]);
            let nearer = |a: f32, b: f32| if order == DepthOrder::Standard { a <= b } else { a >= b };
            let mut before_wall = 0;
            for (i, [found, _]) in hair.iter().enumerate().filter(|(_, found)| **found != NO_HAIR) {
                assert!(nearer(*found, depth[i]), "{technique:?}: pixel {i}, {found} is behind {}", depth[i]);
                before_wall += usize::from(depth[i] != order.far());
                // A strand that goes through the wall may leave it a pixel earlier.
                let near_wall = pixels[i].iter().any(|f| (f[0] - f64::from(depth[i])).abs() < 1e-5);
                assert!(
                    pixels[i].is_empty() || near_wall || has_depth(&pixels[i], f64::from(*found)),
                    "{technique:?}: {i}"
                );
            }
            assert!(before_wall > 100, "{technique:?}: {before_wall}");
        }
    }
}

#[test]
fn many_fragments_of_one_depth_have_it() {
    let across: Vec<Vec3> = (0..4).map(|v| Vec3::new(0.3 * v as f32 - 0.45, 0.0, 0.0)).collect();
    for opacity in [0.004, 1.0] {
        let material = varied().with(|m| {
            m.fibre_radius = Some(0.02);
            (m.opacity, m.tip_opacity) = (opacity, opacity);
        });
        // More than a group of tiles has room for, in each pixel.
        let groom = Groom::new(&vec![across.clone(); 1000], material);
        for technique in [TilesDesc::default().closed_below(0.0).into(), Technique::default()] {
            let Some(mut screen) = screen(with(technique, true)) else { return };
            let picture = screen.hair(&[&groom]);
            let far = screen.view.depth().far();
            let pixels = fragments(&screen, &groom, &|_| far);
            // A thousand faint fragments are summed up in steps of 1 / 16384 each.
            let seen = hold("one depth", &picture.hair, &alphas(&picture), &pixels, 0.02);
            assert!(seen[0] > 40, "{seen:?}");
        }
    }
}

#[test]
fn lists_that_are_bounded_have_the_depth_of_those_that_are_not_to_the_bit() {
    let groom = Groom::wavy(600, 16, 3, faint());
    for (k, fill) in [(8, Fill::Compute), (8, Fill::Raster), (0, Fill::Compute)] {
        let lists = PpllDesc::default().k(k).fill(fill);
        for cap in [0, 1, 8] {
            let Some(mut all) = screen(with(lists.k(k.min(cap)), true)) else { return };
            let expected = all.hair(&[&groom]);
            let Some(mut bounded) = screen(with(lists.cap(cap), true)) else { return };
            let found = bounded.hair(&[&groom]);
            let depths = |picture: &Picture| picture.hair.iter().map(|hair| hair[0].to_bits()).collect::<Vec<_>>();
            assert!(depths(&found) == depths(&expected), "{k} {fill:?}, a cap of {cap}");
        }
    }
}

#[test]
fn tiles_that_are_drawn_again_and_tiles_that_take_over_write_it() {
    let (sparse, dense) = (Groom::wavy(60, 12, 1, varied()), Groom::wavy(1500, 16, 3, varied()));
    let Some(mut plain) = screen(with(TilesDesc::default().skips_hidden(false), true)) else { return };
    let Some(mut skipping) = screen(with(TilesDesc::default().skips_hidden(true), true)) else { return };
    for groom in [&dense, &dense, &sparse, &dense] {
        assert!(skipping.hair(&[groom]).hair == plain.hair(&[groom]).hair);
    }
    let auto = AutoDesc::default().dense(8.0).tiles_on_cpu(true);
    let Some(mut auto) = screen(with(auto, true)) else { return };
    let expected = plain.hair(&[&dense]);
    for _ in 0..40 {
        let counters = auto.hair(&[&dense]).counters;
        auto.renderer.grow_to_measured(&mut *auto.backend, &counters).unwrap();
    }
    assert!(auto.renderer.uses_tiles());
    assert!(auto.hair(&[&dense]).hair == expected.hair);
}

#[test]
fn views_of_one_frame_write_their_parts() {
    const SIZE: [u32; 2] = [96, 64];
    let groom = Groom::wavy(60, 12, 1, varied());
    // Neither begins nor ends on a tile of 8 x 8.
    let parts = [([0, 0], [45, 64]), ([47, 3], [49, 37])];
    let projection = rh::proj::directx::perspective(0.6, 0.8, 50.0, 0.05);
    let eyes = [Vec3::new(0.6, 0.4, 2.9), Vec3::new(2.5, 0.4, 1.0)];
    let view = |i: usize| {
        let viewport = Viewport::part(parts[i].0, parts[i].1, SIZE).unwrap();
        let eye = rh::view::look_at_mat4(eyes[i], Vec3::ZERO, Vec3::Y);
        View::new(eye, projection, DepthOrder::Reverse, viewport).unwrap()
    };
    let views = [view(0), view(1)];
    let mut drawn = vec![false; 96 * 64];
    for (technique, backend) in techniques().into_iter().flat_map(|t| backends().into_iter().map(move |b| (t, b))) {
        let mut screen = Screen::new(backend, with(technique, true));
        let picture = screen.views(&views, &[&groom]);
        let all = alphas(&picture);
        for (view, (offset, size)) in views.iter().zip(parts) {
            let rows = (offset[1]..offset[1] + size[1]).map(|y| (y * 96 + offset[0]) as usize);
            let inside: Vec<usize> = rows.flat_map(|first| first..first + size[0] as usize).collect();
            inside.iter().for_each(|&i| drawn[i] = true);
            screen.view = *view;
            let far = view.depth().far();
            let hair: Vec<_> = inside.iter().map(|&i| picture.hair[i]).collect();
            let alphas: Vec<_> = inside.iter().map(|&i| all[i]).collect();
            let of = fragments(&screen, &groom, &|_| far);
            let seen = hold(&format!("{technique:?}"), &hair, &alphas, &of, within(technique));
            assert!(seen[0] > 200, "{seen:?}");
        }
        let outside = picture.hair.iter().zip(&drawn).filter(|(_, drawn)| !**drawn);
        assert!(outside.into_iter().all(|(hair, _)| *hair == NO_HAIR));
    }
}

#[test]
fn memory_is_taken_where_it_is_asked_for_alone() {
    let pixels = 96 * 64;
    for technique in techniques() {
        let Some(with) = screen(with(technique, true)) else { return };
        let Some(without) = screen(self::with(technique, false)) else { return };
        let is_bounded = matches!(technique, Technique::Ppll(PpllDesc { cap: Some(_), .. }));
        let more = with.renderer.technique_bytes() - without.renderer.technique_bytes();
        assert_eq!(more, if is_bounded { 8 * pixels } else { 4 * pixels }, "{technique:?}");
    }
}

/// What drawing to these targets ends with.
fn refused(screen: &mut Screen, section: &ShadedStrands, groom: &Groom, targets: Targets) -> String {
    let (mut list, view) = (PassList::new(), screen.view);
    let drawn = [ViewDraw::new(&view, &screen.lights, targets)];
    let draws = [SectionDraw::new(section, &groom.material, groom.pose)];
    match screen.renderer.draw(&mut list, &drawn, &draws) {
        Ok(()) => screen.backend.run(&list).unwrap_err().to_string(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_target_that_is_missing_or_does_not_fit_is_a_clear_error() {
    let groom = Groom::wavy(10, 4, 1, varied());
    for (backend, hair_output) in backends().into_iter().chain(backends()).zip([true, true, false, false]) {
        let mut screen = Screen::new(backend, with(PpllDesc::default(), hair_output));
        let mut uploads = PassList::new();
        let section = screen.section(&mut uploads, &groom);
        screen.backend.run(&uploads).unwrap();
        let targets = screen.targets();
        let mut texture =
            |size, format| screen.backend.create_texture(&TextureDesc::new("engine.hair", size, format)).unwrap();
        let [right, halves, small] =
            [texture([96, 64], HAIR_FORMAT), texture([96, 64], Format::Rg16F), texture([96, 63], HAIR_FORMAT)];
        let cases = match hair_output {
            true => vec![
                (Targets::new(targets.color, targets.depth), DrawError::NoHairTarget.to_string()),
                (targets.hair(halves), "these are [Rgba16F, Rg16F]".to_owned()),
                (targets.hair(small), "`engine.hair` has the size [96, 63]".to_owned()),
            ],
            false => vec![(targets.hair(right), DrawError::UnusedHairTarget.to_string())],
        };
        for (targets, said) in cases {
            let error = refused(&mut screen, &section, &groom, targets);
            assert!(error.contains(&said) && error.contains("hair.render"), "{error}: {said}");
        }
    }
}
