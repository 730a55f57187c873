//! Coverage is proportional to the true width, and opacity counts once.

mod support;

use glam::{DVec2, Vec3};
use tressfx_asset::grow::{Amount, Direction, Growth, SurfaceMap, grow};
use tressfx_asset::mesh::skinned_obj;
use tressfx_conformance::render::{Groom, Screen};
use tressfx_conformance::sim::strands_of;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_render::{Light, Material, reference};
use tressfx_sim::{Interpolation, InterpolationParams};

use support::screen;

/// A material that shades to one colour whatever the light.
fn flat(screen: &mut Screen, material: Material) -> Material {
    screen.lights.sky = Vec3::ONE;
    screen.lights.ground = Vec3::ONE;
    screen.lights.lights = Vec::<Light>::new();
    material.with(|m| {
        m.base_color = Vec3::new(0.25, 0.5, 0.75);
        m.tip_color = Vec3::new(0.25, 0.5, 0.75);
        m.variation = 0.0;
        m.root_shade = 0.0;
        m.self_shadow = 0.0;
        m.tip_width = 1.0;
    })
}

fn opaque(radius: f32) -> Material {
    Material::default().with(|m| {
        m.fibre_radius = Some(radius);
        m.opacity = 1.0;
        m.tip_opacity = 1.0;
    })
}

/// A straight strand through the middle of the picture at an angle to the horizontal, 1 unit long.
fn line(angle: f32, vertices: u32) -> Vec<Vec3> {
    let direction = Vec3::new(angle.cos(), angle.sin(), 0.0);
    let middle = Vec3::new(0.003, 0.007, 0.0);
    (0..vertices).map(|i| middle + direction * (i as f32 / (vertices - 1) as f32 - 0.5)).collect()
}

#[test]
fn coverage_integrates_to_width_times_length() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let pixels_per_unit = screen.view.lens().focal.x / 3.0;
    for width in [0.02, 0.1, 0.4, 1.0, 2.5, 6.0f32] {
        for degrees in [0.0, 17.0, 45.0, 63.0, 90.0f32] {
            let material = flat(&mut screen, opaque(0.5 * width / pixels_per_unit));
            let groom = Groom::new(&[line(degrees.to_radians(), 7)], material);
            let picture = screen.hair(&[&groom]);
            let area: f64 = picture.pixels().iter().map(|pixel| pixel.w).sum();
            // A rectangle and two half discs.
            let width = f64::from(width);
            let expected = width * f64::from(pixels_per_unit) + width * width * std::f64::consts::FRAC_PI_4;
            let error = area / expected - 1.0;
            eprintln!("{width} px at {degrees}: {:+.3}%", 100.0 * error);
            assert!(error.abs() < 0.005, "width {width} at {degrees} degrees: {area} instead of {expected}");
        }
    }
}

#[test]
fn a_thin_strand_has_the_same_opacity_in_every_column() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let pixels_per_unit = screen.view.lens().focal.x / 3.0;
    let material = flat(&mut screen, opaque(0.05 / pixels_per_unit));
    for degrees in [0.0, 10.0, 30.0, 44.0f32] {
        let groom = Groom::new(&[line(degrees.to_radians(), 2)], material);
        let pixels = screen.hair(&[&groom]).pixels();
        let columns: Vec<f64> = (40..56).map(|x| (0..64).map(|y| pixels[y * 96 + x].w).sum()).collect();
        let expected = 0.1 / f64::from(degrees.to_radians().cos());
        for column in columns {
            assert!((column / expected - 1.0).abs() < 0.01, "{column} instead of {expected} at {degrees} degrees");
        }
    }
}

#[test]
fn segments_of_a_straight_strand_share_no_pixel_and_leave_none_out() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let material = flat(&mut screen, opaque(0.02));
    for degrees in [0.0, 31.0, 45.0, 90.0f32] {
        let whole = screen.hair(&[&Groom::new(&[line(degrees.to_radians(), 2)], material)]);
        let parts = screen.hair(&[&Groom::new(&[line(degrees.to_radians(), 64)], material)]);
        assert_eq!(whole.counters, parts.counters, "{degrees} degrees");
        let difference = whole.difference(&parts.pixels());
        assert!(difference.max < 0.002, "{difference:?}");
    }
}

#[test]
fn opacity_counts_once() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let middle = |picture: &tressfx_conformance::render::Picture| picture.pixels()[32 * 96 + 48];
    for opacity in [1.0, 0.5f32] {
        let wide = flat(&mut screen, opaque(0.1)).with(|m| {
            m.opacity = opacity;
            m.tip_opacity = opacity;
        });
        let groom = Groom::new(&[line(0.3, 2)], wide);
        let pixel = middle(&screen.hair(&[&groom]));
        let expected = f64::from(opacity) * glam::DVec4::new(0.25, 0.5, 0.75, 1.0);
        assert!((pixel - expected).abs().max_element() < 0.0006, "{pixel} instead of {expected}");
        let twice = middle(&screen.hair(&[&groom, &groom]));
        let expected = (1.0 - (1.0 - f64::from(opacity)).powi(2)) * glam::DVec4::new(0.25, 0.5, 0.75, 1.0);
        assert!((twice - expected).abs().max_element() < 0.0012, "{twice} instead of {expected}");
    }
}

#[test]
fn the_tip_has_its_own_width_and_opacity() {
    let Some(mut screen) = screen(|setup| setup.ppll().k = 1) else { return };
    let material = flat(&mut screen, opaque(0.1)).with(|m| m.tip_opacity = 0.25);
    let groom = Groom::new(&[line(0.0, 2)], material);
    let pixels = screen.hair(&[&groom]).pixels();
    let row = |x: usize| pixels[32 * 96 + x].w;
    assert!(row(34) > 0.9 && row(62) < 0.4 && (row(48) - 0.625).abs() < 0.03, "{} {} {}", row(34), row(48), row(62));
    let mut tapered = Groom::new(&[line(0.0, 2)], flat(&mut screen, opaque(0.1)).with(|m| m.tip_width = 0.2));
    tapered.thickness = vec![1.0, 0.0];
    let pixels = screen.hair(&[&tapered]).pixels();
    let height = |x: usize| (0..64).map(|y| pixels[y * 96 + x].w).sum::<f64>();
    let full = 0.2 / f64::from(3.0 / screen.view.lens().focal.x);
    assert!((height(48) / full - 0.6).abs() < 0.03, "{} of {full}", height(48));
}

#[test]
fn coverage_in_f64_is_the_area_of_a_polygon() {
    // The area of a unit square within a slab, by counting samples.
    let sampled = |distance: f64, half: f64, normal: DVec2| {
        let n = 400;
        let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) - 0.5;
        let inside = |x: i32, y: i32| (DVec2::new(at(x), at(y)).dot(normal) - distance).abs() < half;
        let count = (0..n).flat_map(|y| (0..n).map(move |x| (x, y))).filter(|&(x, y)| inside(x, y)).count();
        count as f64 / f64::from(n * n)
    };
    for degrees in [0.0, 20.0, 45.0, 77.0f64] {
        let normal = DVec2::from_angle(degrees.to_radians());
        for (distance, half) in [(0.0, 0.05), (0.3, 0.1), (-0.5, 0.2), (0.65, 0.05), (0.2, 2.0), (0.9, 0.1)] {
            let (exact, counted) = (reference::coverage(distance, half, normal), sampled(distance, half, normal));
            assert!((exact - counted).abs() < 0.004, "{degrees} {distance} {half}: {exact}, counted {counted}");
        }
    }
}

/// A hundred thousand strands between guides that are grown by a map, four times as dense on the right as on the left: each ninth of the skin is covered as the map says.
/// Strands that lie over each other count each for itself, which is the optical depth.
#[test]
fn covered_area_follows_the_map_of_density() {
    const WIDTH: usize = 384;
    const STRANDS: u32 = 100_000;
    let Some(mut screen) = screen(|setup| (setup.size, setup.hair_output) = ([WIDTH as u32, 256], true)) else {
        return;
    };
    let skin = "v -1 -0.6 0\nv 1 -0.6 0\nv 1 0.6 0\nv -1 0.6 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
    let densities = (0..256).map(|texel| 0.25 + 0.75 * (texel as f32 + 0.5) / 256.0).collect();
    let growth = Growth {
        amount: Amount::Count(2000),
        density_map: Some(SurfaceMap::new([256, 1], 1, densities).unwrap()),
        vertices: 16,
        length: 0.02,
        direction: Direction::Comb(Vec3::NEG_Y),
        ..Growth::default()
    };
    let guides = strands_of(grow(&skinned_obj("skin", skin.as_bytes()).unwrap(), &growth).unwrap(), 0);
    let mut backend = NullBackend::default();
    let buffers = StrandBuffers::new(&mut backend, StrandShape::of(&guides), Vec3::ZERO).unwrap();
    let of_guides = (&buffers, &guides);
    let params = InterpolationParams::default();
    let between = Interpolation::new(&mut backend, &mut PassList::new(), of_guides, STRANDS, &params).unwrap();
    let strands = between.rest(&guides, STRANDS).unwrap();
    let pixels_per_unit = screen.view.lens().focal.x / 3.0;
    let material = opaque(0.1 / pixels_per_unit).with(|m| (m.opacity, m.tip_opacity, m.tip_width) = (0.5, 0.5, 1.0));
    let groom = Groom { pose: tressfx_core::view::Pose::IDENTITY, ..Groom::of(&strands, material) };
    let picture = screen.hair(&[&groom]);
    // The groom is drawn about its own middle.
    let middle = f64::from(strands.bounds.rounded_center().x);
    let part_of = |column: usize| {
        let x = (column as f64 + 0.5 - WIDTH as f64 / 2.0) / f64::from(pixels_per_unit) + middle;
        // Beyond the outermost guides there is no hair: parts are within.
        ((x + 0.95) / 1.9 * 9.0).floor()
    };
    let (mut areas, mut densities) = ([0.0; 9], [0.0; 9]);
    for (index, [depth, coverage]) in picture.hair.iter().enumerate() {
        let part = part_of(index % WIDTH);
        if (0.0..9.0).contains(&part) {
            let x = (index % WIDTH) as f64 + 0.5 - WIDTH as f64 / 2.0;
            // Away from the middle a strand that hangs is seen wider: from its side, and in pixels that are seen from theirs.
            let wider = 1f64.hypot(x / f64::from(screen.view.lens().focal.x));
            densities[part as usize] += wider * (0.25 + 0.375 * (1.0 + x / f64::from(pixels_per_unit) + middle));
            areas[part as usize] -= if *depth < 0.0 { 0.0 } else { (1.0 - f64::from(*coverage)).ln() };
        }
    }
    let [covered, density]: [f64; 2] = [areas.iter().sum(), densities.iter().sum()];
    for (part, (area, expected)) in areas.iter().zip(densities).enumerate() {
        let error = area / covered / (expected / density) - 1.0;
        println!("part {part}: {:+.2} %", 100.0 * error);
        assert!(error.abs() < 0.03, "part {part}: {error}");
    }
}
