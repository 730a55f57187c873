//! Tiles against the f64 picture in exact order, and what they promise: nothing is lost, and the bits are the same every time.

mod support;

use std::collections::{HashMap, HashSet};

use glam::{DVec4, Vec3};
use tressfx_asset::mesh::Mesh;
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_conformance::render::{Difference, Groom, Picture, Screen, Setup};
use tressfx_core::view::Pose;
use tressfx_render::{Counters, TilesDesc, reference};

use support::hair::{endless, faint, tiles, varied};
use support::passes::read;
use support::screen;

/// As near as half floats can come.
fn rounded(exact: &[DVec4]) -> Vec<DVec4> {
    let half = |x: f64| half::f16::from_f64(x).to_f64();
    exact.iter().map(|pixel| DVec4::from_array(pixel.to_array().map(half))).collect()
}

/// Where pixels close at this, what lies behind is less than the rounding of half floats.
const SOON_ENOUGH: f32 = 1.0 / 4096.0;

/// The PSNR of what a picture has of errors beside those that the rounding of its target makes, which are independent of them: squares of errors add up.
fn psnr_beside(difference: &Difference, rounding: &Difference) -> f64 {
    let square = |psnr: f64| 10f64.powf(-0.1 * psnr);
    -10.0 * (square(difference.psnr) - square(rounding.psnr)).max(1e-15).log10()
}

#[test]
fn loose_and_dense_hair_is_as_in_exact_order() {
    let grooms = [
        ("loose", Groom::wavy(60, 12, 1, varied()), [96, 64], 2.0),
        ("dense", Groom::wavy(1500, 16, 3, varied()), [96, 64], 30.0),
        ("faint", Groom::wavy(6000, 16, 4, faint()), [48, 32], 250.0),
    ];
    for (name, groom, size, in_a_pixel) in grooms {
        for closed_below in [TilesDesc::default().closed_below, SOON_ENOUGH, 0.0] {
            let technique = TilesDesc::default().closed_below(closed_below).into();
            let Some(mut screen) = screen(|setup| (setup.technique, setup.size) = (technique, size)) else { return };
            let (picture, exact) = (screen.hair(&[&groom]), screen.exact(&[&groom]));
            let (difference, best) = (picture.difference(&exact), Difference::between(&rounded(&exact), &exact));
            eprintln!("{name}, closed below {closed_below}: {difference:?}, half floats {:.1}", best.psnr);
            let Counters { fragments, pixels_with_hair, .. } = picture.counters;
            assert!(f64::from(fragments) > in_a_pixel * f64::from(pixels_with_hair), "{:?}", picture.counters);
            // What is left out lies behind what lets so little through.
            let brightest = exact.iter().map(|pixel| pixel.max_element()).fold(1.0, f64::max);
            let most = f64::from(closed_below) * brightest + 0.0004;
            assert!(difference.max < most, "{name}: {difference:?}, {most}");
            // Colours are rounded to half floats twice: where they are shaded, and as those of the surface.
            let settled = closed_below <= SOON_ENOUGH;
            assert!(!settled || difference.psnr > best.psnr - 3.5, "{name}: {difference:?}, {best:?}");
            let beside = psnr_beside(&difference, &best);
            eprintln!("    {beside:.1} dB beside the rounding of the target");
            assert!(!settled || beside > 90.0, "{name}: {beside}");
        }
    }
}

#[test]
fn a_pixel_is_closed_where_less_passes_than_was_asked_for() {
    let groom = Groom::wavy(1500, 16, 3, varied());
    let mut last = (0, 0.0);
    for closed_below in [2.0, 0.1, 0.001, 0.0] {
        let technique = TilesDesc::default().closed_below(closed_below).into();
        let Some(mut screen) = screen(|setup| setup.technique = technique) else { return };
        let picture = screen.hair(&[&groom]);
        let psnr = picture.difference(&screen.exact(&[&groom])).psnr;
        assert!((picture.counters.fragments, psnr) > last, "{closed_below}: {:?}, {psnr} dB", picture.counters);
        assert!(closed_below < 1.0 || picture.bytes.iter().all(|&byte| byte == 0), "all are closed before they begin");
        last = (picture.counters.fragments, psnr);
    }
}

#[test]
fn the_same_bits_every_time_and_on_both_backends_whatever_the_order_of_sections() {
    let (groom, hazy) = (Groom::wavy(6000, 16, 6, varied()), Groom::wavy(800, 12, 7, faint()));
    let mut pictures: Vec<[Picture; 2]> = Vec::new();
    for vulkan in [false, true] {
        let large = |setup: &mut Setup| {
            tiles(setup);
            setup.size = [320, 200];
        };
        let made =
            if vulkan { Some(Screen::new(Box::new(VulkanBackend::headless().unwrap()), large)) } else { screen(large) };
        let Some(mut screen) = made else { return };
        let mut draw = || [screen.hair(&[&groom]), screen.hair(&[&groom, &hazy])];
        let first = draw();
        assert!(first[0].counters.fragments > 300_000, "many threads race: {:?}", first[0].counters);
        for _ in 0..2 {
            let again = draw();
            assert!(first.iter().zip(&again).all(|(a, b)| a.bytes == b.bytes && a.counters == b.counters));
        }
        assert!(screen.hair(&[&hazy, &groom]).bytes == first[1].bytes, "the order of sections is no order of depth");
        pictures.push(first);
    }
    // Two compilers may round in two ways, though those of this technique need not.
    for (wgpu, vulkan) in pictures[0].iter().zip(&pictures[1]) {
        assert!(wgpu.bytes == vulkan.bytes, "{:?}", wgpu.difference(&vulkan.pixels()));
    }
}

/// Units end where those of the frame before have ended: of other hair that is far too near, too far, too dense or too loose.
#[test]
fn what_the_frame_before_tells_of_units_changes_no_bit() {
    let grooms = [
        Groom::wavy(60, 12, 1, varied()),
        Groom::wavy(2500, 16, 6, varied()),
        Groom::wavy(4000, 8, 2, faint()),
        Groom::wavy(800, 16, 3, varied()),
    ];
    for (few_tiles, places) in [(0, 1), (10_000, 1), (0, 4), (10_000, 16), (0, 64)] {
        let technique = TilesDesc::default().few_tiles(few_tiles).places(places);
        let with = |setup: &mut Setup| setup.technique = technique.into();
        let alone = |groom| Some(screen(with)?.hair(&[groom]).bytes);
        let Some(alone) = grooms.iter().map(alone).collect::<Option<Vec<_>>>() else { return };
        let Some(mut screen) = screen(with) else { return };
        for turn in 0..12 {
            // Each comes behind each other one.
            let groom = [0, 1, 2, 3, 2, 1, 3, 0, 2, 0, 3, 1][turn];
            let bytes = screen.hair(&[&grooms[groom]]).bytes;
            assert!(bytes == alone[groom], "{few_tiles} few tiles, {places} places: groom {groom} in turn {turn}");
        }
    }
}

#[test]
fn too_many_fragments_of_one_depth_are_their_mean() {
    let across =
        |z: f32| -> Vec<Vec3> { (0..4).map(|v| Vec3::new(0.3 * v as f32 - 0.45, 0.0, z * (v as f32 - 1.5))).collect() };
    // In one plane before the eye, and through many depths.
    for (z, opacity) in [(0.0, 0.004), (0.1, 0.004), (0.1, 0.5), (0.0, 1.0)] {
        let material = varied().with(|m| {
            m.fibre_radius = Some(0.02);
            (m.opacity, m.tip_opacity) = (opacity, opacity);
        });
        // More than a group has room for, in each pixel.
        let groom = Groom::new(&vec![across(z); 1000], material);
        let Some(mut screen) = screen(endless) else { return };
        let far = screen.view.depth().far();
        let mean = reference::resolved(&screen.view, &screen.lights, &[groom.reference()], &|_| far, 0);
        let picture = screen.hair(&[&groom]);
        let difference = picture.difference(&mean);
        eprintln!("z {z}, opacity {opacity}: {difference:?}, {:?}", picture.counters);
        assert!(mean.iter().filter(|pixel| pixel.w > 0.5).count() > 40);
        // The sums are rounded: colours to 1/65536, optical depths to 1/16384, which where a round end covers little of a pixel is much
        // of each of a thousand.
        assert!(difference.max < 0.02 && difference.psnr > 70.0, "{difference:?}");
        assert!(screen.hair(&[&groom]).bytes == picture.bytes);
    }
}

/// The tilt where a strand begins or ends.
const ROUND: f32 = 65024.0;

/// What tiles keep of a vertex.
struct Kept {
    /// Its pixel, nearness and radius.
    point: DVec4,
    color: DVec4,
    tilt: f32,
    leads_on: bool,
}

impl Kept {
    /// From its words of `vertices` and of `paints`.
    fn new(words: &[u32], paint: &[u32]) -> Self {
        let point = [0, 1, 2].map(|axis| f64::from(f32::from_bits(words[axis])));
        let radius = (words[3] >> 16) << 2 | (words[3] >> 2) & 3;
        let radius = f32::from_bits((radius << 11) + 0x2b80_0000);
        let tilt = half::f16::from_bits((words[3] & 0xfff0) as u16).to_f32();
        assert_eq!(words[3] & 2, 0, "it is not beyond the near plane");
        Self {
            point: DVec4::new(point[0], point[1], point[2], radius.into()),
            color: color(paint),
            tilt,
            leads_on: words[3] & 1 == 1,
        }
    }

    /// So many of them.
    fn all(words: &[u32], paints: &[u32], count: u32) -> Vec<Self> {
        let both = words.chunks(4).zip(paints.chunks(2)).take(count as usize);
        both.map(|(words, paint)| Self::new(words, paint)).collect()
    }
}

/// Four half floats.
fn color(words: &[u32]) -> DVec4 {
    let half = |word: u32, shift: u32| half::f16::from_bits((word >> shift) as u16).to_f64();
    DVec4::from_array([(0, 0), (0, 16), (1, 0), (1, 16)].map(|(i, at)| half(words[i], at)))
}

/// Where a vertex of a groom is on the screen: its pixel, nearness and radius.
fn on_screen(screen: &Screen, groom: &Groom, vertex: usize) -> DVec4 {
    let lens = screen.view.lens();
    let to_eye = lens.to_eye.as_dmat4() * groom.pose.matrix().as_dmat4();
    let point = to_eye.transform_point3(Vec3::from_slice(&groom.positions[vertex][..3]).as_dvec3());
    let flat = lens.focal.as_dvec2() * point.truncate() * glam::DVec2::new(1.0, -1.0) / -point.z;
    let taper = f64::from(groom.material.tip_width);
    let radius = 0.005 * (taper + (1.0 - taper) * f64::from(groom.thickness[vertex]));
    (lens.center.as_dvec2() + flat).extend(1.0 / -point.z).extend(radius / -point.z)
}

/// The vertex of a groom that each of those that are kept is.
fn sources(screen: &Screen, groom: &Groom, kept: &[Kept]) -> Vec<usize> {
    let all: Vec<DVec4> = (0..groom.positions.len()).map(|vertex| on_screen(screen, groom, vertex)).collect();
    let near = |of: &Kept, vertex: usize| (all[vertex] - of.point).abs();
    let is_it =
        |of: &Kept, vertex: usize| near(of, vertex).cmple(DVec4::new(1e-4, 1e-4, 1e-6, 1e-3 * of.point.w)).all();
    let source = |of: &Kept| (0..all.len()).find(|&vertex| is_it(of, vertex)).expect("a vertex of the groom");
    kept.iter().map(source).collect()
}

#[test]
fn tile_points_keeps_what_may_be_seen() {
    let Some(mut screen) = screen(tiles) else { return };
    let pose = Pose { rotation: glam::Quat::from_rotation_y(0.8), translation: Vec3::new(0.1, -0.1, 0.2) };
    // Strands of one piece, and of several.
    for (strands, vertices) in [(37, 12), (5, 75), (150, 2), (9, 33)] {
        let mut groom = Groom { pose, ..Groom::wavy(strands, vertices, 9, varied().with(|m| m.tip_width = 0.3)) };
        groom.positions[2][1] = f32::NAN;
        let (label, all) = ("hair.render.tile_points", groom.positions.len() as u64);
        let counts = read(&mut screen, &[&groom], [("hair.render.tile_bin", "state", 8)]);
        let count = u64::from(counts[0][7]);
        let names = [(label, "vertices", 4 * count), (label, "paints", 2 * count), (label, "colors", 2 * all)];
        let [words, paints, colors] = read(&mut screen, &[&groom], names);
        let kept = Kept::all(&words, &paints, counts[0][7]);
        let sources = sources(&screen, &groom, &kept);
        let own: Vec<DVec4> = colors.chunks(2).map(color).collect();
        let (stride, last) = (strands as usize, groom.positions.len() - 1);
        let mut segments = HashSet::new();
        for (i, (kept, &source)) in kept.iter().zip(&sources).enumerate() {
            assert_eq!(kept.color, own[source], "vertex {source}");
            let is_end = source < stride || source + stride > last || source == 2 + stride;
            assert!(if is_end { kept.tilt == ROUND } else { kept.tilt.abs() < 0.8 }, "vertex {source}: {}", kept.tilt);
            if kept.leads_on {
                assert_eq!(sources[i + 1], source + stride, "the next vertex is the next one of the strand");
                assert!(segments.insert(source), "a segment is kept once");
            }
        }
        let expected = (strands * (vertices - 1)) as usize;
        assert_eq!(segments.len(), expected - 1, "all but that without a place on the screen");
        assert!(kept.len() < expected + 3 * stride, "{} vertices of {strands} strands", kept.len());
    }
}

#[test]
fn what_is_behind_the_scene_is_not_kept() {
    let Some(mut screen) = screen(odd) else { return };
    let groom = Groom::wavy(400, 12, 3, varied());
    let open = screen.hair(&[&groom]).counters.vertices;
    let corners = [[-9.0, -5.0], [0.0, -5.0], [0.0, 15.0]].map(|[x, y]| Vec3::new(x, y, 0.6));
    let wall = Mesh { positions: corners.to_vec(), normals: vec![Vec3::Z; 3], indices: vec![0, 1, 2] };
    let picture = screen.scene(&[&wall], &[&groom]);
    let depth = screen.depth();
    let kept = picture.counters.vertices;
    let seen: HashSet<u32> = touched(&screen, &groom, &depth).into_iter().map(|(_, segment)| segment).collect();
    eprintln!("{open} vertices, behind a wall {kept}, of {} segments that are seen", seen.len());
    assert_eq!(open, 400 * 12);
    assert!(kept as usize >= seen.len() && kept < 5 * open / 6, "{kept} of {open}");
}

/// A triangle that hides a part of the picture, nearer to its right.
fn roof() -> Mesh {
    let positions = vec![Vec3::new(-0.6, -0.7, -1.0), Vec3::new(1.5, -0.5, 0.6), Vec3::new(0.2, 1.1, 0.0)];
    Mesh { positions, normals: vec![Vec3::Z; 3], indices: vec![0, 1, 2] }
}

const ODD: [u32; 2] = [93, 61];

fn odd(setup: &mut Setup) {
    endless(setup);
    setup.size = ODD;
}

#[test]
fn tile_depth_leaves_the_farthest_that_the_scene_shows() {
    let Some(mut screen) = screen(odd) else { return };
    screen.scene(&[&roof()], &[]);
    let (depth, lens) = (screen.depth(), screen.view.lens());
    let mut farthest = vec![f64::MAX; 12 * 8];
    for (i, depth) in depth.iter().enumerate() {
        let (x, y) = (i % 93, i / 93);
        let nearness = (f64::from(*depth) - f64::from(lens.depth_offset)) * f64::from(lens.depth_scale);
        let tile = &mut farthest[y / 8 * 12 + x / 8];
        *tile = tile.min(nearness.max(0.0));
    }
    let groom = Groom::wavy(20, 4, 1, varied());
    let label = "hair.render.tile_depth";
    let [infos] = read(&mut screen, &[&groom], [(label, "infos", 6 * 96)]);
    let (nearest, nothing) =
        (farthest.iter().copied().fold(0.0, f64::max), farthest.iter().copied().fold(1.0, f64::min));
    assert!(nearest > 0.3 && nothing < 0.03, "some tiles are hidden whole, others are not: {nearest}, {nothing}");
    for (info, expected) in infos.chunks(6).zip(farthest) {
        let [seen, scene] = [1, 2].map(|at| f32::from_bits(info[at]));
        assert!((f64::from(scene) - expected).abs() <= 1e-6 * expected, "{scene} is not {expected}");
        assert_eq!(seen, scene, "nothing was hidden before the first frame");
    }
}

/// What the blocks of 4 x 4 tiles have, where these tiles of 12 x 8 wait: the complement of the bits of the farthest that one of them refers to.
fn blocks_of(infos: &[u32], waits: impl Fn(&[u32]) -> bool) -> Vec<u32> {
    let mut blocks = vec![0; 6];
    for (tile, info) in infos.chunks(6).enumerate().filter(|(_, info)| waits(info)) {
        let block = &mut blocks[tile / 12 / 4 * 3 + tile % 12 / 4];
        *block = (!info[1]).max(*block);
    }
    blocks
}

/// Slices of depth of a tile.
const SLICES: u64 = 96;

/// The tiles that the fragments of each segment lie in, by its first vertex, in f64.
fn touched(screen: &Screen, groom: &Groom, depth: &[f32]) -> HashSet<(u32, u32)> {
    let mut pairs = HashSet::new();
    let scene = |[x, y]: [u32; 2]| depth[(y * ODD[0] + x) as usize];
    let colors = vec![DVec4::ONE; groom.positions.len()];
    reference::fill(&screen.view, &groom.reference(), &colors, &scene, &mut |fragment| {
        pairs.insert((fragment.pixel[1] / 8 * 12 + fragment.pixel[0] / 8, fragment.segment));
    });
    pairs
}

#[test]
fn tile_bin_refers_to_what_touches_a_tile_and_tile_alloc_gives_each_tile_a_place() {
    let Some(mut screen) = screen(odd) else { return };
    let groom = Groom::wavy(400, 12, 3, varied());
    screen.scene(&[&roof()], &[]);
    let depth = screen.depth();
    let names = [
        ("hair.render.tile_bin", "bins", SLICES * 96),
        ("hair.render.tile_bin", "references", u64::from(1u32 << 16)),
        ("hair.render.tile_alloc", "queue", 12 + 8 * 96),
        ("hair.render.tile_alloc", "infos", 6 * 96),
        ("hair.render.tile_points", "vertices", 4 * 4800),
        ("hair.render.tile_points", "paints", 2 * 4800),
        ("hair.render.tile_points", "state", 8),
    ];
    let [bins, references, queue, infos, words, paints, counters] = read(&mut screen, &[&groom], names);
    let kept = Kept::all(&words, &paints, counters[7]);
    let sources = sources(&screen, &groom, &kept);
    let wanted = queue[0];
    let (sizes, tiles) = (&queue[4..12], &queue[12..]);
    let waiting: Vec<_> = (sizes.iter().zip(tiles.chunks(96)))
        .flat_map(|(&size, tiles)| &tiles[..size as usize])
        .map(|&tile| (tile, infos[6 * tile as usize + 3]))
        .collect();
    let mut places: Vec<_> =
        waiting.iter().map(|&(tile, first)| (first, bins[(SLICES as usize - 1) * 96 + tile as usize])).collect();
    places.sort_unstable();
    assert!(places.windows(2).all(|pair| pair[0].1 == pair[1].0), "one behind the other: {places:?}");
    assert_eq!((places[0].0, places[places.len() - 1].1), (0, wanted));
    let mut nearest = HashMap::new();
    for (tile, first) in waiting {
        let end = bins[(SLICES as usize - 1) * 96 + tile as usize];
        for reference in &references[first as usize..end as usize] {
            let source = sources[(reference & 0x03ff_ffff) as usize] as u32;
            *nearest.entry((tile, source)).or_insert(0) += reference >> 31;
        }
    }
    assert!(nearest.values().all(|&flags| flags == 1), "one slice of a tile is the nearest");
    let touched = touched(&screen, &groom, &depth);
    eprintln!("{wanted} references to {} segments of tiles, of which {} leave fragments", nearest.len(), touched.len());
    assert!(touched.len() > 4000 && touched.iter().all(|pair| nearest.contains_key(pair)));
    assert!(nearest.len() < 2 * touched.len(), "what is referred to is near");
}

#[test]
fn what_is_outside_of_the_picture_is_in_no_tile() {
    let Some(mut screen) = screen(odd) else { return };
    let inside = Groom::wavy(200, 12, 3, varied());
    assert!(screen.hair(&[&inside]).counters.wanted > 1000);
    for offset in [[-6.0, 0.0], [6.0, 0.0], [0.0, -6.0], [0.0, 6.0], [-6.0, 6.0], [6.0, -6.0]] {
        let mut outside = inside.clone();
        for position in &mut outside.positions {
            position[0] += offset[0];
            position[1] += offset[1];
        }
        assert_eq!(screen.hair(&[&outside]).counters, Counters::default(), "{offset:?}");
    }
}

#[test]
fn tile_blend_makes_each_fragment_once() {
    for (groom, size) in [(Groom::wavy(300, 16, 2, varied()), ODD), (Groom::wavy(3000, 16, 4, faint()), [48, 32])] {
        let Some(mut lists) = screen(|setup| setup.size = size) else { return };
        let Some(mut screen) = screen(|setup| {
            endless(setup);
            setup.size = size;
        }) else {
            return;
        };
        let tiles = u64::from(size[0].div_ceil(8) * size[1].div_ceil(8));
        let [resolved, listed, draw] = read(
            &mut screen,
            &[&groom],
            [
                ("hair.render.tile_blend", "resolved", 128 * tiles),
                ("hair.render.tile_alloc", "hairy", 2 * tiles),
                ("hair.render.tile_alloc", "tile_vertices", 4),
            ],
        );
        let mut colors = vec![[0u32; 2]; (size[0] * size[1]) as usize];
        for listed in listed.chunks(2).take((draw[0] / 6) as usize) {
            let corner = [listed[0] % size[0].div_ceil(8), listed[0] / size[0].div_ceil(8)].map(|at| 8 * at);
            for (i, color) in resolved[128 * listed[1] as usize..][..128].chunks(2).enumerate() {
                let [x, y] = [corner[0] + i as u32 % 8, corner[1] + i as u32 / 8];
                if x < size[0] && y < size[1] {
                    colors[(y * size[0] + x) as usize] = [color[0], color[1]];
                }
            }
        }
        assert!(bytemuck::cast_slice::<_, u8>(&colors) == screen.hair(&[&groom]).bytes, "what lies over nothing");
        for meshes in [&[][..], &[&roof()]] {
            let (all, found) = (lists.scene(meshes, &[&groom]).counters, screen.scene(meshes, &[&groom]).counters);
            assert_eq!(all.dropped, 0);
            assert_eq!(found.pixels_with_hair, all.pixels_with_hair);
            // Tiles round radii to a part in 8,000: now and then the faintest fragment there is comes or goes.
            assert!(found.fragments.abs_diff(all.fragments) <= all.fragments / 50_000, "{found:?}, {all:?}");
        }
    }
}

#[test]
fn tile_reopen_puts_back_tiles_that_let_light_through() {
    let technique = TilesDesc::default().skips_hidden(true).into();
    let Some(mut screen) = screen(|setup| (setup.technique, setup.size) = (technique, ODD)) else { return };
    let dense = Groom::wavy(6000, 16, 3, varied().with(|m| m.fibre_radius = Some(0.01)));
    let far = Groom::wavy(300, 16, 8, varied());
    screen.hair(&[&dense, &far]);
    let label = "hair.render.tile_reopen";
    let names = [(label, "grids_again", 6), (label, "infos", 6 * 96), (label, "blocks", 7)];
    let [grids, infos, blocks] = read(&mut screen, &[&dense, &far], names);
    let counts = |infos: &[u32]| {
        let (seen, scene) = (|info: &[u32]| f32::from_bits(info[1]), |info: &[u32]| f32::from_bits(info[2]));
        let back = infos.chunks(6).filter(|info| seen(info) == scene(info)).count();
        let done = infos.chunks(6).filter(|info| seen(info) == 1e30 && info[4] == 0).count();
        assert_eq!(back + done, 96, "each tile is either put back or done");
        back
    };
    assert_eq!((grids, counts(&infos)), (vec![0; 6], 0), "what was hidden is hidden again");
    assert_eq!(blocks, [0; 7], "no block has a tile that waits");
    let [grids, infos, blocks] = read(&mut screen, &[&far], names);
    let back = counts(&infos);
    assert!(back > 2 && grids.iter().all(|&groups| groups > 0), "{back} tiles, {grids:?}");
    assert!(infos.chunks(6).all(|info| info[4] == 0), "all of them have been blended by now");
    let mut expected = vec![1];
    expected.extend(blocks_of(&infos, |info| info[1] == info[2]));
    assert!(blocks == expected && blocks[1..].iter().any(|&word| word != 0), "{blocks:?}, {expected:?}");
}
