//! Hair that other hair hides, left out of lists and of ShortCut: what is seen of it is less than a thousandth, and what is nearest stays as it is.

mod support;

use std::collections::{HashMap, HashSet};

use glam::{DVec4, Vec3};
use tressfx_asset::mesh::Mesh;
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_core::pass::{Load, PassList, RasterPass};
use tressfx_core::shader::Binding;
use tressfx_core::view::{Pose, View, Viewport};
use tressfx_render::uniforms::{LensUniform, ViewUniform};
use tressfx_render::{Counters, Fill, Lod, PpllDesc, SectionDraw, ShortCutDesc, Tail, Technique, ViewDraw, reference};

use support::hair::{faint, varied, wall};
use support::passes::{bound, read};
use support::screen;

/// Neither side is a multiple of a tile's.
const ODD: [u32; 2] = [125, 90];

/// What may be seen of what is left out, and half of the last place of a half float.
const UNSEEN: f64 = 1.0 / 1024.0 + 0.000_25;

fn at(technique: impl Into<Technique>) -> impl FnOnce(&mut Setup) {
    move |setup| (setup.technique, setup.size, setup.copies) = (technique.into(), ODD, true)
}

/// Hair through which nothing is seen in its middle, and hair of which hundreds of fragments are.
fn dense() -> [Groom; 2] {
    let wide = varied().with(|m| m.fibre_radius = Some(0.01));
    [Groom::wavy(6000, 16, 3, wide), Groom::wavy(9000, 16, 4, faint().with(|m| m.opacity = 0.1))]
}

/// The same scene with and without what is hidden.
fn both(techniques: [Technique; 2], meshes: &[&Mesh], grooms: &[&Groom]) -> Option<[Picture; 2]> {
    let [some, all] = techniques.map(|technique| screen(at(technique)).map(|mut screen| screen.scene(meshes, grooms)));
    Some([some?, all?])
}

fn lists(desc: PpllDesc) -> [Technique; 2] {
    [true, false].map(|skips| desc.skips_hidden(skips).into())
}

fn layers(desc: ShortCutDesc) -> [Technique; 2] {
    [true, false].map(|skips| desc.skips_hidden(skips).into())
}

#[test]
fn the_nearest_fragments_are_the_same_to_the_bit() {
    // Four fragments never let less than a thousandth through.
    let nearest = PpllDesc::default().k(4).tail(Tail::None);
    let [groom, pale] = dense();
    let aside = Groom { pose: Pose { translation: Vec3::new(0.3, 0.1, 0.5), ..Pose::IDENTITY }, ..pale.clone() };
    let copied = Groom { material: groom.material.with(|m| m.copies = 2), ..groom.clone() };
    let few = Groom { lod: Lod { share: 0.5, ..Lod::FULL }, ..groom.clone() };
    let wall = wall(0.1, 0.2);
    let scenes: [(&[&Mesh], &[&Groom], f64); 5] = [
        (&[], &[&groom], 0.6),
        (&[&wall], &[&groom], 0.9),
        (&[], &[&aside, &groom], 0.8),
        (&[], &[&copied], 0.5),
        (&[], &[&few], 0.9),
    ];
    for fill in [Fill::Compute, Fill::Raster] {
        for (index, (meshes, grooms, share)) in scenes.iter().enumerate() {
            let Some([some, all]) = both(lists(nearest.fill(fill)), meshes, grooms) else { return };
            let part = f64::from(some.counters.fragments) / f64::from(all.counters.fragments);
            eprintln!("{fill:?}, scene {index}: {part:.3} of {} fragments", all.counters.fragments);
            assert!(some.bytes == all.bytes, "{fill:?}, scene {index}: {:?}", some.difference(&all.pixels()));
            assert_eq!(some.counters.pixels_with_hair, all.counters.pixels_with_hair);
            assert!(part < *share, "{fill:?}, scene {index}: {part}");
        }
    }
}

#[test]
fn no_pixel_becomes_clearer_by_a_thousandth() {
    let wall = wall(0.1, 0.2);
    let opacity = PpllDesc::default().k(0).tail(Tail::Unshaded);
    for groom in dense() {
        for techniques in [lists(opacity), lists(opacity.fill(Fill::Raster)), layers(ShortCutDesc::default())] {
            for meshes in [&[][..], &[&wall]] {
                let Some([some, all]) = both(techniques, meshes, &[&groom]) else { return };
                let pairs = || some.pixels().into_iter().zip(all.pixels());
                let clearer = pairs().map(|(some, all)| all.w - some.w).fold(0.0, f64::max);
                let denser = pairs().map(|(some, all)| some.w - all.w).fold(0.0, f64::max);
                eprintln!("{:?}: clearer by {clearer:.6}, denser by {denser:.6}", techniques[0]);
                assert!(clearer < UNSEEN && denser < 0.000_5, "{clearer}, {denser}");
                assert!(some.counters.fragments < all.counters.fragments);
            }
        }
    }
}

#[test]
fn the_picture_is_nearer_to_the_exact_order() {
    for (groom, desc) in
        dense().into_iter().flat_map(|groom| [(groom.clone(), PpllDesc::default()), (groom, PpllDesc::default().k(2))])
    {
        let Some(screen) = screen(at(desc.skips_hidden(true))) else { return };
        let exact = screen.exact(&[&groom]);
        let pictures = lists(desc).map(|technique| Some(support::screen(at(technique))?.hair(&[&groom])));
        let [Some(some), Some(all)] = pictures else { return };
        let [some, all] = [some, all].map(|picture| picture.difference(&exact));
        eprintln!("k = {}: {some:?}, with all {all:?}", desc.k);
        assert!(some.psnr > all.psnr, "what nobody sees does not colour the tail: {some:?}, {all:?}");
    }
}

/// The lens of a screen as kernels know it.
fn lens(screen: &Screen) -> LensUniform {
    ViewUniform::new(&screen.view, &screen.lights).lens
}

/// Fragments of a groom in f64: pixel, nearness as kernels have it, optical depth in bits, and segment.
fn fragments(screen: &Screen, groom: &Groom, depth: &[f32]) -> Vec<(usize, f64, f64, u32)> {
    let lens = lens(screen);
    let place = |[x, y]: [u32; 2]| (y * ODD[0] + x) as usize;
    let opacity = |vertex: usize| {
        let along = (vertex as u32 / groom.shape.strands()) as f32 / (groom.shape.vertices - 1) as f32;
        groom.material.opacity + along * (groom.material.tip_opacity - groom.material.opacity)
    };
    let colors: Vec<DVec4> =
        (0..groom.positions.len()).map(|vertex| DVec4::new(1.0, 1.0, 1.0, opacity(vertex).into())).collect();
    let mut found = Vec::new();
    reference::fill(&screen.view, &groom.reference(), &colors, &|pixel| depth[place(pixel)], &mut |fragment| {
        let nearness = (fragment.nearness - f64::from(lens.depth_offset)) * f64::from(lens.depth_scale);
        found.push((place(fragment.pixel), nearness, -(1.0 - fragment.alpha).max(1e-5).log2(), fragment.segment));
    });
    found
}

#[test]
fn occlusion_mass_is_about_that_of_all_fragments_in_each_tile() {
    let tiles = 16 * 12;
    for groom in dense() {
        let Some(mut screen) = screen(at(PpllDesc::default().skips_hidden(true))) else { return };
        screen.scene(&[], &[]);
        let depth = screen.depth();
        let [masses] = read(&mut screen, &[&groom], [("hair.render.occlusion_mass", "masses", 64 * tiles)]);
        let mut exact = vec![0.0; tiles as usize];
        for (pixel, _, bits, _) in fragments(&screen, &groom, &depth) {
            exact[pixel / ODD[0] as usize / 8 * 16 + pixel % ODD[0] as usize / 8] += bits;
        }
        let found: Vec<f64> =
            masses.chunks(64).map(|tile| tile.iter().map(|&mass| f64::from(mass) / 256.0).sum()).collect();
        let [all, expected] = [&found, &exact].map(|masses| masses.iter().sum::<f64>());
        let apart: f64 = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).sum();
        eprintln!("{all:.0} of {expected:.0}, tiles apart by {apart:.0}");
        // An eighth of the strands, and where they turn it is not known how much they cover.
        assert!((all / expected - 1.0).abs() < 0.15 && apart < 0.2 * expected, "{all}, {expected}, {apart}");
    }
}

#[test]
fn occlusion_sums_and_depths_are_those_of_f64() {
    let (tiles, pixels) = (16 * 12, u64::from(ODD[0] * ODD[1]));
    let wall = wall(0.1, 0.2);
    for groom in dense() {
        let Some(mut screen) = screen(at(PpllDesc::default().skips_hidden(true))) else { return };
        screen.scene(&[&wall], &[]);
        let depth = screen.depth();
        let sums = "hair.render.occlusion_sums";
        let names = [
            (sums, "opticals", 4 * pixels),
            ("hair.render.occlusion_guess", "tiles", 4 * tiles),
            ("hair.render.occlusion_list", "list", 1 + u64::from(groom.shape.segments())),
            ("hair.render.occlusion_depth", "tiles", 4 * tiles),
        ];
        let [opticals, guesses, list, known] = read(&mut screen, &[&groom], names);
        let seen = seen_depth(&mut screen, &groom);
        let tile_of = |pixel: usize| pixel / ODD[0] as usize / 8 * 16 + pixel % ODD[0] as usize / 8;
        let guess = |tile: usize| [0, 1].map(|at| f64::from(f32::from_bits(guesses[4 * tile + at])));
        let dense = (0..tiles as usize).filter(|&tile| guess(tile)[1] > 0.0).count();
        assert!(dense > 10, "tiles are dense: {dense}");
        let lens = lens(&screen);
        let scene = |pixel: usize| (depth[pixel] - lens.depth_offset) * lens.depth_scale;
        let all = fragments(&screen, &groom, &depth);
        // What is summed in each part: nothing that is behind the guess, or beyond what closes a pixel.
        let mut exact = vec![0.0; 4 * pixels as usize];
        let mut before = vec![0.0; pixels as usize];
        let mut total = vec![0.0; pixels as usize];
        for &(pixel, nearness, bits, _) in &all {
            let [near, far] = guess(tile_of(pixel));
            if far > 0.0 && nearness >= far {
                let share = (near - nearness) / (near - far);
                let part = if nearness >= near { 0 } else { 1 + ((share * 3.0) as usize).min(2) };
                exact[4 * pixel + part] += bits.min(10.0);
            }
            total[pixel] += bits;
            before[pixel] += if nearness >= f64::from(seen[pixel]) { bits } else { 0.0 };
        }
        let apart = opticals.iter().zip(&exact).filter(|&(&found, &bits)| {
            let found = f64::from(found) / 1024.0;
            // A part that is full is not summed on; each fragment is rounded down to a part of a bit.
            found < 9.9 && (found - bits).abs() > 0.05 + 0.02 * bits
        });
        let share = apart.count() as f64 / exact.iter().filter(|&&bits| bits > 0.0).count() as f64;
        eprintln!("{share:.5} of the parts are apart");
        assert!(share < 0.01, "{share}");
        // A fragment that a thousandth of light comes to is seen, and of dense pixels most are not.
        let closed = (0..pixels as usize).filter(|&pixel| seen[pixel] > scene(pixel).max(0.0)).collect::<HashSet<_>>();
        let opaque = total.iter().filter(|&&bits| bits > 20.0).count();
        eprintln!("{} pixels are closed of {opaque} that are opaque", closed.len());
        assert!(closed.len() > opaque / 2, "{} of {opaque}", closed.len());
        for pixel in 0..pixels as usize {
            assert!(seen[pixel] >= scene(pixel).max(0.0));
            assert!(!closed.contains(&pixel) || before[pixel] > 9.8, "{pixel}: {} bits", before[pixel]);
        }
        holds_the_farthest(&known, &seen);
        holds_what_is_seen(&list, &all, &seen);
    }
}

/// What `occlusion_depth` has left, row by row.
fn seen_depth(screen: &mut Screen, groom: &Groom) -> Vec<f32> {
    let mut list = PassList::new();
    let section = screen.section(&mut list, groom);
    let draws = [SectionDraw::new(&section, &groom.material, groom.pose)];
    let (view, lights, targets) = (screen.view, screen.lights.clone(), screen.targets());
    screen.renderer.grow_to_predicted(&mut *screen.backend, &view, &draws).unwrap();
    screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &draws).unwrap();
    let Binding::Texture(texture) = bound(&list, "hair.render.occlusion_depth", "occluded") else { panic!() };
    let ticket = list.read_texture(texture);
    screen.backend.run(&list).unwrap();
    bytemuck::pod_collect_to_vec(&screen.backend.read(ticket).ready().expect("it has run"))
}

/// The farthest of a tile is that of its pixels.
fn holds_the_farthest(tiles: &[u32], seen: &[f32]) {
    let mut farthest = HashMap::new();
    for (pixel, &seen) in seen.iter().enumerate() {
        let tile = pixel / ODD[0] as usize / 8 * 16 + pixel % ODD[0] as usize / 8;
        let of = farthest.entry(tile).or_insert(seen);
        *of = of.min(seen);
    }
    for (tile, farthest) in farthest {
        assert_eq!(f32::from_bits(tiles[4 * tile + 2]), farthest, "tile {tile}");
    }
}

/// Every segment is on the list that leaves a fragment which is not hidden; each once, and many are not.
fn holds_what_is_seen(list: &[u32], fragments: &[(usize, f64, f64, u32)], seen: &[f32]) {
    let count = list[0] as usize;
    let listed: HashSet<u32> = list[1..=count].iter().copied().collect();
    assert_eq!(listed.len(), count, "a segment is listed once");
    let is_seen =
        |&&(pixel, nearness, _, _): &&(usize, f64, f64, u32)| nearness > f64::from(seen[pixel]) * (1.0 + 1e-6);
    let needed: HashSet<u32> = fragments.iter().filter(is_seen).map(|&(.., segment)| segment).collect();
    let missing = needed.difference(&listed).count();
    eprintln!("{count} of {} segments are listed, {} are seen", list.len() - 1, needed.len());
    assert_eq!(missing, 0, "of {} that are seen", needed.len());
    assert!(count < (list.len() - 1) * 9 / 10);
}

#[test]
fn bounded_lists_are_those_with_room_for_all() {
    let [groom, pale] = dense();
    for desc in [PpllDesc::default(), PpllDesc::default().tail(Tail::Weighted), PpllDesc::default().fill(Fill::Raster)]
    {
        let desc = desc.skips_hidden(true);
        let pictures = [desc, desc.cap(8)].map(|desc| Some(screen(at(desc))?.hair(&[&groom, &pale])));
        let [Some(all), Some(bounded)] = pictures else { return };
        assert!(bounded.bytes == all.bytes, "{desc:?}: {:?}", bounded.difference(&all.pixels()));
        assert_eq!(Counters { wanted: 0, ..bounded.counters }, Counters { wanted: 0, ..all.counters });
        assert!(bounded.counters.wanted < all.counters.wanted);
    }
}

#[test]
fn sections_without_room_on_the_lists_are_drawn_whole_until_there_is() {
    let [groom, pale] = dense();
    let Some(mut screen) = screen(at(ShortCutDesc::default().skips_hidden(true))) else { return };
    let some = screen.hair(&[&groom]).counters.fragments;
    screen.may_grow = false;
    let whole = screen.hair(&[&groom, &pale]).counters;
    assert!(whole.fragments > some);
    screen.renderer.grow_to_measured(&mut *screen.backend, &whole).unwrap();
    let left = screen.hair(&[&groom, &pale]).counters;
    assert!(left.fragments < whole.fragments * 9 / 10, "{left:?}, {whole:?}");
    assert_eq!(left.pixels_with_hair, whole.pixels_with_hair);
    screen.renderer.resize(&mut *screen.backend, ODD).unwrap();
    assert_eq!(screen.hair(&[&groom, &pale]).counters, whole, "there is no memory of this size yet");
    screen.renderer.grow_to_measured(&mut *screen.backend, &whole).unwrap();
    assert_eq!(screen.hair(&[&groom, &pale]).counters, left);
}

#[test]
fn hidden_hair_is_left_out_of_dense_hair_by_default() {
    let groom = &Groom::wavy(12_000, 16, 3, varied().with(|m| m.fibre_radius = Some(0.01)));
    let fragments = [None, Some(true), Some(false)].map(|skips| {
        let technique = PpllDesc::default().skips_hidden(skips);
        let larger = |setup: &mut Setup| (setup.technique, setup.size) = (technique.into(), [250, 180]);
        Some(screen(larger)?.hair(&[groom]).counters.fragments)
    });
    let [Some(by_default), Some(some), Some(all)] = fragments else { return };
    assert!(all > 1_000_000 && some < all / 2, "{some} of {all}");
    assert_eq!(by_default, some, "it is predicted before the first frame");
}

#[test]
fn little_hair_is_drawn_whole_unless_it_is_asked_for() {
    let groom = &dense()[0];
    let counters = [None, Some(false)].map(|skips| {
        let technique = PpllDesc::default().skips_hidden(skips);
        Some(screen(at(technique))?.hair(&[groom]).counters)
    });
    assert_eq!(counters[0], counters[1]);
    let Some(mut screen) = screen(at(PpllDesc::default())) else { return };
    let refused = screen.renderer.retune(&mut *screen.backend, PpllDesc::default().skips_hidden(true)).unwrap_err();
    assert!(refused.to_string().contains("needs a new renderer"), "{refused}");
}

/// The picture of sections that are there already.
fn drawn(screen: &mut Screen, draws: &[SectionDraw]) -> Vec<u8> {
    let mut list = PassList::new();
    let (view, lights, targets) = (screen.view, screen.lights.clone(), screen.targets());
    screen.renderer.grow_to_predicted(&mut *screen.backend, &view, draws).unwrap();
    let clear = RasterPass::new("test.clear").color(targets.color, Load::Clear([0.0; 4]));
    list.raster(clear.depth(targets.depth, Load::Clear(view.depth().far())));
    screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], draws).unwrap();
    let ticket = list.read_texture(targets.color);
    screen.backend.run(&list).unwrap();
    screen.backend.read(ticket).ready().expect("it has run").to_vec()
}

#[test]
fn sections_come_and_go() {
    let nearest = PpllDesc::default().k(4).tail(Tail::None);
    let [a, b] = dense();
    let b = Groom { pose: Pose { translation: Vec3::new(0.2, 0.1, 0.4), ..Pose::IDENTITY }, ..b };
    let pictures = lists(nearest).map(|technique| {
        let mut screen = screen(at(technique))?;
        let mut list = PassList::new();
        let sections = [&a, &b].map(|groom| screen.section(&mut list, groom));
        screen.backend.run(&list).unwrap();
        let [one, other] = [(&sections[0], &a), (&sections[1], &b)]
            .map(|(section, groom)| SectionDraw::new(section, &groom.material, groom.pose));
        // Each has several places among the lists.
        let frames: [&[SectionDraw]; 6] = [&[one, other], &[other], &[other, one], &[one], &[one, other], &[other]];
        Some(frames.map(|draws| drawn(&mut screen, draws)))
    });
    let [Some(some), Some(all)] = pictures else { return };
    for (frame, (some, all)) in some.iter().zip(&all).enumerate() {
        assert!(some == all, "frame {frame}");
        assert!(some.iter().any(|&byte| byte != 0), "there is hair in frame {frame}");
    }
    assert!(some[0] != some[1] && some[0] != some[3]);
}

#[test]
fn views_of_one_frame_are_each_as_alone() {
    let nearest = PpllDesc::default().k(4).tail(Tail::None);
    let [groom, pale] = dense();
    let pictures = lists(nearest).map(|technique| {
        let mut screen = screen(at(technique))?;
        let view = screen.view;
        let views = [([0, 0], [61, 90]), ([64, 7], [61, 70])].map(|(offset, size)| {
            let viewport = Viewport::part(offset, size, ODD).unwrap();
            View::new(view.view_matrix(), view.projection_matrix(), view.depth(), viewport).unwrap()
        });
        Some(screen.views(&views, &[&groom, &pale]))
    });
    let [Some(some), Some(all)] = pictures else { return };
    assert!(some.bytes == all.bytes, "{:?}", some.difference(&all.pixels()));
    assert!(some.counters.fragments < all.counters.fragments);
}

#[test]
fn memory_that_nobody_uses_is_given_back() {
    let Some(mut screen) = screen(at(ShortCutDesc::default().skips_hidden(true))) else { return };
    let empty = screen.renderer.technique_bytes();
    let [groom, _] = dense();
    let before = screen.backend_memory();
    let counters = screen.hair(&[&groom]).counters;
    let used = screen.renderer.technique_bytes();
    assert!(used > empty + 24 * u64::from(ODD[0] * ODD[1]) + 4 * u64::from(groom.shape.segments()));
    assert!(screen.backend_memory() >= before + used - empty, "it is counted as it is made");
    let (view, lights, targets) = (screen.view, screen.lights.clone(), screen.targets());
    for _ in 0..130 {
        let mut list = PassList::new();
        screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[]).unwrap();
        screen.backend.run(&list).unwrap();
    }
    screen.renderer.grow_to_measured(&mut *screen.backend, &Counters::default()).unwrap();
    let released = screen.renderer.technique_bytes();
    assert!(released < empty + (used - empty) / 2, "{empty}, {used}, {released}");
    assert_eq!(screen.hair(&[&groom]).counters, counters, "and is there again");
}
