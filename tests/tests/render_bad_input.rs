//! Input that nobody should give, by every technique on both backends: a picture or a clear error, and a device that draws on.

mod support;

use glam::camera::rh;
use glam::{Mat4, Quat, Vec3};
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::render::{Groom, Picture, Random, Screen, Setup};
use tressfx_core::backend::{DepthOrder, Format};
use tressfx_core::pass::PassList;
use tressfx_core::view::{Camera, Pose, View, ViewError};
use tressfx_render::{
    AutoDesc, Cone, FibreScattering, Fill, HairRenderer, Light, MAX_LIGHTS, Material, Pigment, PpllDesc, RenderDesc,
    SectionDraw, ShortCutDesc, Tail, Technique, TilesDesc, ViewDraw,
};

use support::gpu;
use support::hair::{is_sound, material};

const RASTER: Fill = Fill::Raster;

fn techniques() -> Vec<Technique> {
    let (lists, mean, tiles) = (PpllDesc::default(), ShortCutDesc::default(), TilesDesc::default());
    vec![
        lists.into(),
        lists.fill(RASTER).into(),
        lists.cap(2).into(),
        lists.cap(2).fill(RASTER).into(),
        lists.places(16).tail(Tail::Weighted).into(),
        lists.places(4).tail(Tail::Weighted).cap(2).into(),
        mean.into(),
        mean.fill(RASTER).into(),
        mean.ordered(true).into(),
        mean.ordered(true).fill(RASTER).into(),
        lists.skips_hidden(true).into(),
        lists.skips_hidden(true).cap(2).fill(RASTER).into(),
        mean.skips_hidden(true).into(),
        tiles.into(),
        AutoDesc::default().into(),
    ]
}

/// A screen on each backend; the validation layer looks at raw Vulkan, and fails a run that it has something to say about.
fn screens() -> Option<[Screen; 2]> {
    let wgpu = gpu()?;
    let watched = VulkanOptions { validation: true, ..VulkanOptions::default() };
    let vulkan = VulkanBackend::headless_with(&watched).unwrap();
    Some([Screen::new(wgpu, |_| ()), Screen::new(Box::new(vulkan), |_| ())])
}

fn hair() -> Groom {
    Groom::wavy(60, 12, 1, material())
}

/// Does something on a screen of each backend, once for each technique. Each must draw as ever after it.
fn each(techniques: &[Technique], case: impl FnMut(&str, &mut Screen, Technique)) {
    each_on([techniques, techniques], case);
}

/// The same with techniques for each backend.
fn each_on(techniques: [&[Technique]; 2], mut case: impl FnMut(&str, &mut Screen, Technique)) {
    let Some(screens) = screens() else { return };
    for (backend, (mut screen, techniques)) in ["wgpu", "Vulkan"].into_iter().zip(screens.into_iter().zip(techniques)) {
        for &technique in techniques {
            let name = format!("{backend}, {technique:?}");
            let usual = Setup { technique, ..Setup::default() };
            screen.turn_to(&usual);
            case(&name, &mut screen, technique);
            screen.turn_to(&usual);
            let after = screen.hair(&[&hair()]);
            assert!(is_sound(&after) && after.counters.fragments > 1000, "{name}: {:?}", after.counters);
        }
    }
}

fn sound(name: &str, screen: &mut Screen, groom: &Groom) -> Picture {
    let picture = screen.hair(&[groom]);
    assert!(is_sound(&picture), "{name}: {:?}", picture.counters);
    picture
}

#[test]
fn targets_of_one_pixel_and_of_one_row() {
    let groom = Groom::wavy(300, 16, 2, material());
    each(&techniques(), |name, screen, technique| {
        for (size, least) in [([1, 1], 1), ([16384, 1], 100), ([1, 16384], 100), ([3, 2], 10)] {
            let mut setup = Setup { size, technique, ..Setup::default() };
            setup.camera.fov = 1.0;
            screen.turn_to(&setup);
            let picture = sound(name, screen, &groom);
            assert!(picture.counters.fragments > least, "{name}, {size:?}: {:?}", picture.counters);
            assert!(picture.bytes.iter().any(|&byte| byte != 0), "{name}, {size:?}");
        }
        let beyond = screen.backend.caps().max_texture_size + 1;
        let desc = RenderDesc::new([beyond, 1], Format::Rgba16F).technique(technique);
        let error = HairRenderer::new(&mut *screen.backend, &desc).unwrap_err().to_string();
        assert!(error.contains(&beyond.to_string()), "{name}: {error}");
    });
}

#[test]
fn an_eye_within_the_hair() {
    let groom = Groom::wavy(300, 16, 2, material());
    // The last one is on a strand itself.
    let on_strand = Vec3::from_slice(&groom.positions[8 * 300 + 7][..3]);
    each(&techniques(), |name, screen, technique| {
        for (eye, near) in [(Vec3::new(0.1, 0.0, 0.2), 0.001), (Vec3::ZERO, 1e-6), (on_strand, 1e-5)] {
            let mut setup = Setup { technique, ..Setup::default() };
            (setup.camera.eye, setup.camera.target, setup.camera.near) = (eye, eye - Vec3::Z, near);
            screen.turn_to(&setup);
            let picture = sound(name, screen, &groom);
            assert!(picture.counters.pixels_with_hair > 500, "{name}, {eye}: {:?}", picture.counters);
        }
    });
}

#[test]
fn matrices_that_make_no_picture_are_refused_by_a_view() {
    let (view, size) = (Mat4::from_translation(Vec3::NEG_Z * 3.0), [96, 64]);
    let projection = rh::proj::directx::perspective(0.6, 1.5, 50.0, 0.05);
    let refused = |view, projection| View::new(view, projection, DepthOrder::Reverse, size).unwrap_err();
    assert_eq!(refused(Mat4::ZERO, projection), ViewError::Singular);
    assert_eq!(refused(view, Mat4::ZERO), ViewError::Singular);
    let not_finite = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for (bad, place) in not_finite.into_iter().flat_map(|bad| (0..16).map(move |place| (bad, place))) {
        let spoilt = |matrix: Mat4| {
            let mut numbers = matrix.to_cols_array();
            numbers[place] = bad;
            Mat4::from_cols_array(&numbers)
        };
        assert_eq!(refused(spoilt(view), projection), ViewError::NotFinite, "{bad} at {place}");
        assert_eq!(refused(view, spoilt(projection)), ViewError::NotFinite, "{bad} at {place}");
    }
    for bad in not_finite.into_iter().chain([0.0]) {
        let camera = Setup::default().camera;
        for spoilt in [
            Camera { fov: bad, ..camera },
            Camera { near: bad, ..camera },
            Camera { eye: Vec3::splat(bad) / bad, ..camera },
        ] {
            assert!(spoilt.view(size).is_err(), "{spoilt:?}");
        }
    }
}

/// Views whose matrices are as large, small or flat as a view takes them.
fn wild_views() -> Vec<(String, View)> {
    use rh::proj::directx::{orthographic, perspective, perspective_infinite_reverse};
    let view = Mat4::from_translation(Vec3::NEG_Z * 3.0);
    let usual = perspective(0.6, 1.5, 50.0, 0.05);
    let scaled = |scale: f32| (view * Mat4::from_scale(Vec3::splat(scale)), usual);
    let mut wild = vec![
        (String::from("an angle of a millionth"), (view, perspective(1e-6, 1.5, 50.0, 0.05))),
        (String::from("almost 180 degrees"), (view, perspective(std::f32::consts::PI - 1e-4, 1.5, 50.0, 0.05))),
        (String::from("a near plane at the eye"), (view, perspective_infinite_reverse(0.6, 1.5, 1e-30))),
        (String::from("planes that meet"), (view, perspective(0.6, 1.5, 3.0001, 3.0))),
        (String::from("thousands of times as wide as high"), (view, perspective(0.6, 1e4, 50.0, 0.05))),
        (String::from("a world in an orthographic pixel"), (view, orthographic(-1e9, 1e9, -1e9, 1e9, 1e9, -1e9))),
        (String::from("an atom in an orthographic picture"), (view, orthographic(-1e-9, 1e-9, -1e-9, 1e-9, 9.0, 0.0))),
        (String::from("far away"), (Mat4::from_translation(Vec3::NEG_Z * 1e30), usual)),
        (String::from("flattened"), (view * Mat4::from_scale(Vec3::new(1.0, 1e-6, 1.0)), usual)),
    ];
    wild.extend(
        [1e-30, 1e-12, 1e-3, 1e3, 1e12, 1e30].map(|scale| (format!("{scale:e} times as large"), scaled(scale))),
    );
    let made = wild.into_iter().filter_map(|(name, (view, projection))| {
        let made = View::new(view, projection, DepthOrder::Reverse, [96, 64]);
        made.ok().map(|view| (name, view))
    });
    made.collect()
}

#[test]
fn wild_matrices_draw_what_is_a_picture() {
    let views = wild_views();
    assert!(views.len() >= 10, "{} are views", views.len());
    each(&techniques(), |name, screen, _| {
        for (view_name, view) in &views {
            screen.view = *view;
            sound(&format!("{name}, {view_name}"), screen, &hair());
        }
    });
}

#[test]
fn poses_that_are_no_poses_are_refused_and_nothing_is_written() {
    let at = |translation| Pose { translation, ..Pose::IDENTITY };
    let turned = |rotation| Pose { rotation, ..Pose::IDENTITY };
    let bad = [
        at(Vec3::NAN),
        at(Vec3::new(0.0, f32::INFINITY, 0.0)),
        turned(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        turned(Quat::from_xyzw(0.0, f32::NAN, 0.0, 1.0)),
    ];
    each(&techniques(), |name, screen, _| {
        let groom = hair();
        let section = screen.section(&mut PassList::new(), &groom);
        for pose in bad {
            let draw = SectionDraw::new(&section, &groom.material, pose);
            let (view, lights, targets, mut list) =
                (screen.view, screen.lights.clone(), screen.targets(), PassList::new());
            let drawn = screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &[draw]);
            let error = drawn.unwrap_err().to_string();
            assert!(error.contains("pose: "), "{name}: {error}");
            assert_eq!(list.passes().count(), 0, "{name}");
        }
    });
}

#[test]
fn opacity_of_nothing_and_of_all() {
    each(&techniques(), |name, screen, _| {
        for (opacity, tip_opacity) in [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)] {
            let mut groom = Groom::wavy(400, 12, 1, material().with(|m| m.fibre_radius = Some(0.02)));
            (groom.material.opacity, groom.material.tip_opacity) = (opacity, tip_opacity);
            let picture = sound(name, screen, &groom);
            let most = picture.pixels().iter().map(|pixel| pixel.w).fold(0.0, f64::max);
            if (opacity, tip_opacity) == (0.0, 0.0) {
                assert!(picture.bytes.iter().all(|&byte| byte == 0), "{name}: clear hair leaves the picture as it was");
            } else {
                assert!(most > 0.999, "{name}, {opacity} to {tip_opacity}: {most}");
            }
        }
    });
}

#[test]
fn strands_without_width_and_100_pixels_wide() {
    // A pixel is 0.029 wide where they are.
    each(&techniques(), |name, screen, _| {
        for (radius, tip_width) in [(0.0, 1.0), (1e-30, 1.0), (1e-6, 1.0), (1.45, 1.0), (1.45, 0.0), (1e6, 1.0)] {
            let wide = material().with(|m| (m.fibre_radius, m.tip_width) = (Some(radius), tip_width));
            let picture = sound(name, screen, &Groom::wavy(40, 6, 5, wide));
            let covered = picture.counters.pixels_with_hair;
            match radius {
                ..1e-20 => assert_eq!((covered, picture.counters.fragments), (0, 0), "{name}, radius {radius}"),
                1.45 => assert!(covered > 96 * 64 / 2, "{name}: {covered}"),
                _ => assert!(covered > 0, "{name}, radius {radius}: {:?}", picture.counters),
            }
        }
    });
}

/// Strands of two vertices that all lie within one pixel, and how many of them leave a fragment in it.
fn in_one_pixel(count: u32, techniques: [&[Technique]; 2]) {
    let mut random = Random(5);
    // The pixel is 0.029 wide where they are; its middle is half of that from the middle of the picture.
    let strand = |_| {
        let (z, y) = (0.6 * random.unit() - 0.3, 0.004 * random.unit() - 0.016);
        vec![Vec3::new(0.004, y, z), Vec3::new(0.025, y, z)]
    };
    let look = material().with(|m| (m.opacity, m.tip_opacity, m.variation) = (0.002, 0.002, 1.0));
    let groom = Groom::new(&(0..count).map(strand).collect::<Vec<_>>(), look);
    each_on(techniques, |name, screen, technique| {
        let picture = sound(name, screen, &groom);
        let counters = picture.counters;
        // Mesa's CPU driver ends loops that run on: there a group of tiles ends before, and says what it has left out.
        let places = match technique {
            Technique::Tiles(tiles) => Some(tiles.places),
            _ => None,
        };
        let is_tiles = places.is_some();
        let may_drop = screen.backend.caps().is_cpu && is_tiles;
        assert!(counters.pixels_with_hair <= 4 && (counters.dropped == 0 || may_drop), "{name}: {counters:?}");
        let most = picture.pixels().iter().map(|pixel| pixel.w).fold(0.0, f64::max);
        // With more places, hair in a part of the pixel leaves the others free.
        let least = if places > Some(1) { 0.1 } else { 0.999 - 0.019 * f64::from(counters.dropped.min(1)) };
        assert!(most > least * (1.0 - (-0.001 * f64::from(count)).exp()), "{name}: an opacity of {most}");
        if is_tiles {
            assert!(sound(name, screen, &groom).bytes == picture.bytes, "{name}: another picture the second time");
        }
    });
}

#[test]
fn very_many_strands_in_one_pixel() {
    let more_places = [4, 16, 64].map(|places| TilesDesc::default().places(places).into());
    let all = [techniques(), more_places.into()].concat();
    in_one_pixel(30_000, [&all, &all]);
}

#[test]
fn a_million_strands_in_one_pixel() {
    let (lists, mean, tiles) = (PpllDesc::default(), ShortCutDesc::default(), TilesDesc::default());
    // A picture takes seconds: each technique on both backends, each of its variants on one of them.
    let by_wgpu = [lists.into(), mean.into(), mean.ordered(true).fill(RASTER).into(), tiles.into()];
    let by_vulkan =
        [lists.cap(2).fill(RASTER).into(), lists.skips_hidden(true).into(), mean.into(), tiles.places(16).into()];
    in_one_pixel(1_000_000, [&by_wgpu, &by_vulkan]);
}

#[test]
fn room_for_one_fragment_or_one_reference() {
    let lists = PpllDesc::default();
    let mut small: Vec<Technique> = Vec::new();
    for fill in [Fill::Compute, RASTER] {
        let lists = lists.fill(fill);
        small.extend([16, 0].map(|bytes| Technique::from(lists.max_node_bytes(bytes))));
        let more = [lists.max_node_bytes(16).cap(8), lists.count_limit(1), lists.count_limit(0)];
        small.extend(more.map(Technique::from));
    }
    small.extend([4, 0].map(|bytes| Technique::from(TilesDesc::default().max_reference_bytes(bytes))));
    let tiles = TilesDesc::default().max_reference_bytes(4);
    small.push(AutoDesc::default().lists(lists.max_node_bytes(16)).tiles(tiles).into());
    small.push(AutoDesc::default().lists(lists.max_node_bytes(16)).tiles(tiles).tiles_on_cpu(true).into());
    let Some(screens) = screens() else { return };
    let groom = Groom::wavy(100, 12, 1, material());
    // Tiles of a large picture wait for their turns in all rounds.
    let usual = Setup { size: [48, 32], ..Setup::default() };
    for (backend, mut screen) in ["wgpu", "Vulkan"].into_iter().zip(screens) {
        screen.turn_to(&usual);
        let all = screen.hair(&[&groom]);
        for &technique in &small {
            let name = format!("{backend}, {technique:?}");
            screen.turn_to(&Setup { technique, ..usual });
            for _ in 0..2 {
                let picture = sound(&name, &mut screen, &groom);
                screen.renderer.grow_to_measured(&mut *screen.backend, &picture.counters).unwrap();
                let pairs = || picture.pixels().into_iter().zip(all.pixels());
                assert!(pairs().all(|(some, every)| some.w <= every.w + 0.002), "{name}: more hair than there is");
            }
            let last = sound(&name, &mut screen, &groom).counters;
            let says_so = last.dropped > 0 || last.merged > 0 || last.saturated > 0;
            assert!(says_so, "{name}: {last:?}");
        }
        screen.turn_to(&usual);
        assert!(screen.hair(&[&groom]).bytes == all.bytes, "{backend}: the device draws as ever");
    }
}

#[test]
fn no_fragment_in_order_and_more_than_there_may_be() {
    let (lists, mean) = (PpllDesc::default(), ShortCutDesc::default());
    let none: Vec<Technique> = [Fill::Compute, RASTER]
        .into_iter()
        .flat_map(|fill| {
            [Tail::Shaded, Tail::Weighted, Tail::Unshaded, Tail::None]
                .map(|tail| lists.k(0).fill(fill).tail(tail).into())
        })
        .collect();
    let Some(screens) = screens() else { return };
    for (backend, mut screen) in ["wgpu", "Vulkan"].into_iter().zip(screens) {
        for &technique in &none {
            let name = format!("{backend}, {technique:?}");
            screen.turn_to(&Setup { technique, ..Setup::default() });
            let picture = sound(&name, &mut screen, &hair());
            let Technique::Ppll(desc) = technique else { unreachable!() };
            let is_empty = picture.bytes.iter().all(|&byte| byte == 0);
            assert_eq!(is_empty, desc.tail == Tail::None, "{name}: {:?}", picture.counters);
            assert!(picture.counters.pixels_with_hair > 100, "{name}");
        }
        let refused: [(Technique, &str); 8] = [
            (mean.k(0).into(), "k is 0, it must be from 1 to 8"),
            (mean.k(0).ordered(true).into(), "k is 0, it must be from 1 to 8"),
            (mean.k(9).fill(RASTER).into(), "k is 9, it must be from 1 to 8"),
            (mean.k(u32::MAX).into(), "it must be from 1 to 8"),
            (lists.k(33).into(), "k is 33, it must be from 0 to 32"),
            (lists.k(u32::MAX).fill(RASTER).into(), "it must be from 0 to 32"),
            (lists.k(33).cap(1).into(), "k is 33, it must be from 0 to 32"),
            (AutoDesc::default().lists(lists.k(33)).into(), "k is 33, it must be from 0 to 32"),
        ];
        for (technique, said) in refused {
            let desc = RenderDesc::new([96, 64], Format::Rgba16F).technique(technique);
            let error = HairRenderer::new(&mut *screen.backend, &desc).unwrap_err().to_string();
            assert!(error.contains(said), "{backend}, {technique:?}: {error}");
        }
        screen.turn_to(&Setup::default());
        sound(backend, &mut screen, &hair());
    }
}

fn glass(pigment: Pigment, roughness: f32) -> FibreScattering {
    let mut fibre = FibreScattering::default().with_pigment(pigment);
    (fibre.roughness, fibre.azimuthal_roughness, fibre.multiple) = (roughness, roughness, roughness);
    fibre
}

#[test]
fn numbers_of_looks_and_lights_that_are_not_finite() {
    type Spoil = fn(&mut Material, f32);
    // What walks over segments are given, and what `shade` alone is given, which does not know of techniques.
    let walked: [Spoil; 4] = [
        |m, bad| m.opacity = bad,
        |m, bad| m.tip_opacity = bad,
        |m, bad| m.fibre_radius = Some(bad),
        |m, bad| m.tip_width = bad,
    ];
    let shaded: [Spoil; 6] = [
        |m, bad| m.base_color = Vec3::splat(bad),
        |m, bad| m.variation = bad,
        |m, bad| m.primary.exponent = bad,
        |m, bad| m.root_extent = bad,
        |m, bad| m.fibre = Some(glass(Pigment::Absorption(Vec3::splat(bad)), 0.3)),
        |m, bad| m.fibre = Some(glass(Pigment::Color, bad)),
    ];
    let bad_numbers = [f32::NAN, f32::INFINITY, -1.0];
    let hold = |spoil: &[Spoil], name: &str, screen: &mut Screen| {
        for bad in bad_numbers {
            for (which, spoil) in spoil.iter().enumerate() {
                let mut groom = hair();
                spoil(&mut groom.material, bad);
                sound(&format!("{name}, {bad} in parameter {which}"), screen, &groom);
            }
        }
    };
    each(&techniques(), |name, screen, _| hold(&walked, name, screen));
    each(&techniques()[..1], |name, screen, _| {
        hold(&shaded, name, screen);
        for bad in bad_numbers {
            let usual = screen.lights.clone();
            screen.lights.sky = Vec3::splat(bad);
            screen.lights.lights.push(Light::directional(Vec3::splat(bad), Vec3::splat(bad)));
            sound(&format!("{name}, {bad} in lights"), screen, &hair());
            screen.lights = usual;
        }
    });
}

#[test]
fn lights_that_no_lamp_is() {
    let below = Cone { along: Vec3::NEG_Y, inner: 0.1, outer: 0.4 };
    each(&techniques()[..1], |name, screen, _| {
        let eye = screen.view.lens().eye.truncate();
        let places = [Vec3::ZERO, eye, Vec3::splat(1e30), Vec3::splat(f32::NAN), Vec3::splat(1e-30)];
        for power in [0.0, 1.0, f32::INFINITY, f32::NAN] {
            let at = |place| {
                let color = Vec3::splat(power);
                let spot = Light::spot(place, 0.5, below, color);
                [
                    Light::point(place, 1.0, color),
                    spot,
                    Light::point(place, 0.0, color),
                    Light::directional(place, color),
                ]
            };
            // More than are stored at a vertex: what is stored, and what is taken from the sky.
            screen.lights.lights = places.iter().flat_map(|place| at(*place)).take(MAX_LIGHTS).collect();
            sound(&format!("{name}, power {power}"), screen, &hair());
            screen.lights.lights.reverse();
            sound(&format!("{name}, power {power}, reversed"), screen, &hair());
            for strand in [vec![Vec3::ZERO; 4], (0..4).map(|i| 0.2 * Vec3::Y * i as f32).collect()] {
                sound(
                    &format!("{name}, power {power}, one strand"),
                    screen,
                    &Groom::new(&[strand], Material::default()),
                );
            }
        }
        // What is as thin as a plane, shines nowhere, or is turned inside out.
        let cones =
            [(Vec3::NEG_Y, 0.0, 1e-7), (Vec3::NEG_Y, 3.0, std::f32::consts::PI), (Vec3::splat(1e-30), 0.1, 0.4)];
        for (along, inner, outer) in cones {
            screen.lights.lights = vec![Light::spot(Vec3::Y, 1.0, Cone { along, inner, outer }, Vec3::ONE); MAX_LIGHTS];
            sound(&format!("{name}, cone {inner} {outer}"), screen, &hair());
        }
    });
}
