//! Ends and turns of fibres, against hand-solved areas and against the reference renderer, which traces solids.

mod support;

use std::f32::consts::FRAC_PI_4;
use std::num::NonZeroU32;

use glam::{DVec4, Vec3};
use tressfx_conformance::render::{Difference, Groom, Screen, Setup};
use tressfx_render::{Material, TilesDesc, reference};
use tressfx_truth::{Section, Truth};

use support::screen;

/// Pixels of a unit length where the grooms are.
fn pixels(screen: &Screen) -> f32 {
    screen.view.lens().focal.x / 3.0
}

fn tiles(setup: &mut Setup) {
    setup.technique = TilesDesc::default().closed_below(0.0).into();
}

/// Opaque fibres of a width in pixels.
fn opaque(screen: &Screen, width: f32) -> Material {
    Material::default().with(|m| {
        m.fibre_radius = Some(0.5 * width / pixels(screen));
        (m.opacity, m.tip_opacity, m.tip_width) = (1.0, 1.0, 1.0);
    })
}

/// What the reference renderer makes of a groom.
fn traced(screen: &Screen, groom: &Groom) -> Vec<DVec4> {
    let strands = groom.reference();
    let order = (0..groom.shape.vertices).flat_map(|v| (0..groom.shape.strands()).map(move |s| (s, v)));
    let shaded = order.map(|(strand, vertex)| reference::shade(&screen.view, &screen.lights, &strands, strand, vertex));
    let colors: Vec<[f32; 4]> = shaded.map(|color| color.as_vec4().to_array()).collect();
    let section = Section {
        shape: groom.shape,
        pose: groom.pose,
        positions: &groom.positions,
        colors: &colors,
        thickness: &groom.thickness,
        fibre_radius: strands.uniform.fibre_radius,
        tip_width: strands.uniform.tip_width,
    };
    let samples = NonZeroU32::new(1024).unwrap();
    Truth::new(&screen.view, &[section], None).unwrap().render(samples, &|_| ()).pixels().to_vec()
}

fn area(pixels: &[DVec4]) -> f64 {
    pixels.iter().map(|pixel| pixel.w).sum()
}

/// How far the area and the picture of a groom are from those of the solids.
fn against_truth(name: &str, screen: &mut Screen, groom: &Groom) -> (f64, Difference) {
    let (picture, truth) = (screen.hair(&[groom]).pixels(), traced(screen, groom));
    let found = (area(&picture) / area(&truth) - 1.0, Difference::between(&picture, &truth));
    eprintln!("{name}: area {:+.2}%, {:?}", 100.0 * found.0, found.1);
    found
}

#[test]
fn a_strand_that_points_at_the_eye_is_a_disc() {
    let Some(mut screen) = screen(tiles) else { return };
    for width in [0.3, 1.0, 3.0, 8.0] {
        let mut sum = 0.0;
        for i in 0..24 {
            let at = Vec3::new(0.013 * i as f32 - 0.15, 0.0071 * i as f32 - 0.1, 0.0);
            let to_eye = (Vec3::new(0.0, 0.0, 3.0) - at).normalize();
            let strand = (0..5).map(|i| at - to_eye * (0.02 * i as f32)).collect();
            sum += area(&screen.hair(&[&Groom::new(&[strand], opaque(&screen, width))]).pixels());
        }
        let (found, disc) = (sum / 24.0, f64::from(FRAC_PI_4 * width * width));
        eprintln!("{width} pixels wide: {found:.4}, a disc has {disc:.4}");
        // The far end is smaller by a thirtieth, the slant of the view makes it larger.
        assert!((found / disc - 1.0).abs() < 0.05, "{width}: {found} instead of {disc}");
    }
}

#[test]
fn a_turn_is_covered_once() {
    let Some(mut screen) = screen(tiles) else { return };
    for width in [0.3, 2.0, 6.0] {
        for degrees in [10.0, 40.0, 60.0, 90.0, 150.0f32] {
            let turned = glam::Vec2::from_angle(degrees.to_radians()).extend(0.0);
            let corner = Vec3::new(0.013, -0.021, 0.0);
            let strand = vec![corner - 0.4 * Vec3::X, corner, corner + 0.35 * turned];
            let groom = Groom::new(&[strand], opaque(&screen, width));
            let (area, difference) =
                against_truth(&format!("{width} pixels wide, {degrees} degrees"), &mut screen, &groom);
            // A strip with a sharp turn ends round, and is cut at the bisector within the turn.
            let (most, least) = if degrees < 100.0 { (0.006, 48.0) } else { (0.04, 40.0) };
            assert!(area.abs() < most && difference.psnr > least, "{area} {difference:?}");
        }
    }
}

#[test]
fn colours_are_those_of_the_surface() {
    let Some(mut screen) = screen(tiles) else { return };
    let look = opaque(&screen, 6.0).with(|m| {
        m.base_color = Vec3::new(0.6, 0.08, 0.08);
        m.tip_color = Vec3::new(0.08, 0.08, 0.6);
    });
    // In the middle of the picture, and near its edge, where rays do not lead along the axis of the view.
    for (slope, aside) in [(-3.0, 0.0), (-1.0, 0.0), (1.0, 0.0), (3.0, 0.0), (-1.0, 0.7), (0.0, 0.7), (1.0, 0.7)] {
        let at = |i: i32| aside * Vec3::X + (i as f32 - 1.5) * 0.12 * Vec3::new(1.0, 0.3, slope);
        let groom = Groom::new(&[(0..4).map(at).collect()], look);
        let (area, difference) = against_truth(&format!("slope {slope}, {aside} aside"), &mut screen, &groom);
        // Round ends are seen as discs everywhere.
        assert!(area.abs() < 0.004 + 0.012 * f64::from(aside) && difference.psnr > 40.0, "{area} {difference:?}");
    }
}

#[test]
fn a_fibre_is_as_wide_as_its_solid_away_from_the_centre() {
    for width in [0.4, 3.0] {
        let Some(mut screen) = screen(tiles) else { return };
        let look = opaque(&screen, width);
        // Across the whole picture, beside its middle and away from it.
        for (aside, lean) in [(Vec3::X, Vec3::Y), (Vec3::X, Vec3::new(0.0, 1.0, 1.0)), (Vec3::Y, Vec3::X)] {
            for distance in [0.0, 0.3, 0.6] {
                let strand = (0..9).map(|i| distance * aside + (i as f32 - 4.0) * 0.5 * lean).collect();
                let groom = Groom::new(&[strand], look);
                let (area, _) = against_truth(&format!("{width} px, {distance} aside"), &mut screen, &groom);
                assert!(area.abs() < 0.004, "{width} px, {lean}, {distance} aside: {area}");
            }
        }
    }
}

#[test]
fn twice_as_many_vertices_make_the_same_picture() {
    for (name, width) in [("thin", 0.4), ("wide", 5.0)] {
        let Some(mut screen) = screen(tiles) else { return };
        let curve = |i: usize, count: usize| {
            let s = i as f32 / count as f32;
            Vec3::new(0.5 * (4.0 * s).cos(), 0.35 * (4.0 * s).sin(), 0.3 * s)
        };
        // The middle of an edge is where the coarse strand has it.
        let coarse: Vec<Vec3> = (0..=12).map(|i| curve(i, 12)).collect();
        let fine = (0..=24).map(|i| if i % 2 == 0 { coarse[i / 2] } else { coarse[i / 2].midpoint(coarse[i / 2 + 1]) });
        let fine: Vec<Vec3> = fine.collect();
        let look = opaque(&screen, width).with(|m| (m.tip_color, m.root_shade, m.variation) = (m.base_color, 0.0, 0.0));
        let pictures = [coarse, fine].map(|strand| {
            let mut groom = Groom::new(&[strand], look);
            groom.tangents.fill([0.0, 1.0, 0.0, 0.0]);
            screen.hair(&[&groom])
        });
        let difference = pictures[0].difference(&pictures[1].pixels());
        eprintln!("{name}: {difference:?}");
        assert!(area(&pictures[0].pixels()) > 10.0 && difference.psnr > 60.0, "{name}: {difference:?}");
    }
}
