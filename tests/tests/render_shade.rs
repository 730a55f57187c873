//! Colours of strand vertices against f64.

mod support;

use glam::{DVec4, Quat, Vec3};
use tressfx_conformance::render::{Groom, Random, Screen};
use tressfx_conformance::run_and_read;
use tressfx_conformance::sim::{random_asset, strands_of};
use tressfx_core::pass::PassList;
use tressfx_core::view::Pose;
use tressfx_render::{
    Cone, DrawError, FibreScattering, Highlight, Light, Material, OwnLook, Pigment, SectionDraw, ViewDraw, reference,
};

use support::screen;

/// Colours as the kernel leaves them, in the order of the buffers.
fn shaded(screen: &mut Screen, groom: &Groom) -> Vec<DVec4> {
    let mut list = PassList::new();
    let section = screen.section(&mut list, groom);
    let draw = SectionDraw::new(&section, &groom.material, groom.pose);
    let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
    screen.renderer.draw(&mut list, &[view], &[draw]).unwrap();
    let ticket = list.read_buffer(section.colors(), 0, 8 * groom.positions.len() as u64);
    let bytes = run_and_read(&mut *screen.backend, &list, ticket);
    let channel = |i: usize| half::f16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]).to_f64();
    (0..groom.positions.len()).map(|i| DVec4::from_array([0, 1, 2, 3].map(|c| channel(4 * i + c)))).collect()
}

/// The largest difference, as a share of the colour where that is above 1.
fn error(screen: &mut Screen, groom: &Groom) -> f64 {
    let colors = shaded(screen, groom);
    let table = reference::FibreTable::of(&groom.material);
    let strands = reference::Strands { fibre: table.as_ref(), ..groom.reference() };
    let (view, lights) = (screen.view, screen.lights.clone());
    let count = groom.shape.strands();
    let mut worst = 0.0f64;
    for (i, color) in colors.iter().enumerate() {
        let (strand, vertex) = (i as u32 % count, i as u32 / count);
        let expected = reference::shade(&view, &lights, &strands, strand, vertex);
        assert!(expected.max_element() > 0.0, "lit");
        worst = worst.max(((*color - expected).abs() / expected.max(DVec4::ONE)).max_element());
    }
    worst
}

#[test]
fn every_vertex_is_as_in_f64() {
    let Some(mut screen) = screen(|_| ()) else { return };
    screen.lights.lights.push(Light::point(Vec3::new(0.4, 0.3, 0.8), 0.7, Vec3::new(2.0, 1.0, 0.5)));
    let cone = Cone { along: Vec3::new(-0.2, -0.5, -0.7), inner: 0.2, outer: 0.9 };
    screen.lights.lights.push(Light::spot(Vec3::new(0.1, 0.9, 1.0), 1.0, cone, Vec3::new(0.3, 0.5, 2.0)));
    let sharp = Highlight { strength: 1.0, exponent: 200.0 };
    let materials = [
        Material::default(),
        Material::default().with(|m| {
            m.primary = sharp;
            m.tilt = -8.0;
            m.self_shadow = 0.0;
        }),
    ];
    for material in materials {
        let pose = Pose { rotation: Quat::from_rotation_z(0.4), translation: Vec3::new(0.1, 0.2, -0.3) };
        let groom = Groom { pose, ..Groom::wavy(500, 16, 1, material) };
        let error = error(&mut screen, &groom);
        eprintln!("8000 vertices: largest error {error:.2e}");
        // Half floats have 11 bits.
        assert!(error < 6e-4, "{error}");
    }
}

fn glass(pigment: Pigment, roughness: f32, azimuthal_roughness: f32) -> Material {
    let mut fibre = FibreScattering::default().with_pigment(pigment);
    (fibre.roughness, fibre.azimuthal_roughness) = (roughness, azimuthal_roughness);
    Material::default().with(|m| m.fibre = Some(fibre))
}

#[test]
fn every_vertex_of_fibres_that_scatter_as_glass_is_as_in_f64() {
    let Some(mut screen) = screen(|_| ()) else { return };
    screen.lights.lights.push(Light::point(Vec3::new(0.4, 0.3, 0.8), 0.7, Vec3::new(2.0, 1.0, 0.5)));
    let materials = [
        glass(Pigment::Color, 0.3, 0.3),
        glass(Pigment::Melanin { eumelanin: 0.3, pheomelanin: 0.1 }, 0.15, 0.2).with(|m| m.tilt = -8.0),
        glass(Pigment::Absorption(Vec3::new(0.0, 1.0, 1e6)), 1.0, 1.0),
    ];
    for material in materials {
        let groom = Groom::wavy(500, 16, 1, material);
        let error = error(&mut screen, &groom);
        eprintln!("8000 vertices: largest error {error:.2e}");
        // The table has half floats too.
        assert!(error < 2e-3, "{error}");
    }
}

/// Strands with two followers each, and colours, opacities and widths of their own.
fn coloured(material: Material) -> Groom {
    let mut asset = random_asset(100, 12, 5);
    let mut random = Random(9);
    asset.vertex_colors = Some(asset.points.iter().map(|_| [(); 4].map(|()| random.unit())).collect());
    asset.vertex_thickness = Some(asset.points.iter().map(|_| random.unit()).collect());
    Groom::of(&strands_of(asset, 2), material)
}

#[test]
fn every_vertex_with_a_colour_of_its_own_is_as_in_f64() {
    let Some(mut screen) = screen(|setup| setup.own_colors = true) else { return };
    let varied = Material::default().with(|m| {
        (m.own_colors, m.tip_start) = (0.6, 0.7);
        (m.variation, m.hue_variation) = (0.5, 0.8);
    });
    let of_glass = glass(Pigment::Color, 0.3, 0.3);
    let hues = |m: &mut Material| (m.tip_start, m.hue_variation) = (0.4, 0.3);
    // Half floats go in and come out.
    let materials = [
        (Material::default(), 1.2e-3),
        (varied, 1.2e-3),
        (Material::default().with(|m| m.own_colors = 0.0), 1.2e-3),
        (of_glass, 2e-3),
        (of_glass.with(|m| m.own_colors = 0.3).with(hues), 2e-3),
        (glass(Pigment::Melanin { eumelanin: 0.3, pheomelanin: 0.1 }, 0.3, 0.2), 2e-3),
    ];
    for (material, most) in materials {
        let error = error(&mut screen, &coloured(material));
        eprintln!("3600 vertices: largest error {error:.2e}");
        assert!(error < most, "{material:?}: {error}");
    }
}

#[test]
fn black_of_its_own_is_black_and_white_is_white() {
    let Some(mut screen) = screen(|setup| setup.own_colors = true) else { return };
    for fibre in [None, Some(FibreScattering::default())] {
        let look = Material::default().with(|m| {
            (m.fibre, m.variation, m.root_shade) = (fibre, 0.0, 0.0);
            m.primary.strength = 0.0;
        });
        let bright = |screen: &mut Screen, part: f32| {
            let groom = Groom::wavy(20, 8, 2, look);
            let own = OwnLook::default().with_colors(vec![[part, part, part, 1.0]; groom.positions.len()]);
            let colors = shaded(screen, &Groom { own, ..groom });
            colors.iter().map(|color| color.truncate()).sum::<glam::DVec3>() / colors.len() as f64
        };
        let (black, gray, white) = (bright(&mut screen, 0.0), bright(&mut screen, 0.2), bright(&mut screen, 0.999));
        // Glass mirrors light whatever its pigment is.
        assert!(black.x < if fibre.is_none() { 1e-6 } else { 0.5 * gray.x } && black.is_finite(), "{black}");
        assert!(white.x > 1.5 * gray.x && gray.x > black.x, "{black} {gray} {white}");
    }
}

#[test]
fn whatever_a_fibre_is_made_of_its_colour_is_a_number() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let (sound, broken) = ([0.0, 0.5, 1.0], [f32::NAN, f32::INFINITY, -1.0, 1e9]);
    let all = || sound.into_iter().chain(broken);
    for (a, roughness) in all().flat_map(|a| all().map(move |roughness| (1e6 * a, roughness))) {
        let material = glass(Pigment::Absorption(Vec3::splat(a)), roughness, roughness);
        let is_sound = sound.contains(&(a / 1e6)) && sound.contains(&roughness);
        assert_eq!(material.validate().is_ok(), is_sound, "{a}, {roughness}");
        for color in shaded(&mut screen, &Groom::wavy(20, 8, 2, material)) {
            assert!(color.is_finite() && color.min_element() >= 0.0, "{a}, {roughness}: {color}");
        }
    }
}

#[test]
fn a_fibre_along_the_light_or_the_view_is_finite() {
    let Some(mut screen) = screen(|_| ()) else { return };
    screen.lights.lights = vec![Light::directional(Vec3::Z, Vec3::ONE), Light::directional(Vec3::Y, Vec3::ONE)];
    // Towards the light, towards the eye, and both at a length that is not quite 1 in f32.
    let directions = [Vec3::Y, Vec3::Z, Vec3::new(0.0, 0.6, 0.8), Vec3::splat(1.0)];
    let strands: Vec<Vec<Vec3>> = directions.iter().map(|&d| (0..4).map(|i| d * 0.1 * i as f32).collect()).collect();
    let mut groom = Groom::new(&strands, Material::default());
    groom.tangents.iter_mut().for_each(|tangent| *tangent = tangent.map(|x| x * 1.000_000_2));
    for color in shaded(&mut screen, &groom) {
        assert!(color.is_finite() && color.min_element() >= 0.0, "{color}");
    }
}

#[test]
fn more_light_than_a_half_float_holds_is_clamped() {
    let Some(mut screen) = screen(|_| ()) else { return };
    screen.lights.sky = Vec3::splat(1e9);
    screen.lights.ground = Vec3::splat(1e9);
    let groom = Groom::wavy(20, 8, 2, Material::default());
    let brightest = shaded(&mut screen, &groom).iter().map(|c| c.x).fold(0.0, f64::max);
    assert!((59_000.0..61_000.0).contains(&brightest), "{brightest}");
}

#[test]
fn a_cone_is_lit_inside_dark_outside_and_fades_between() {
    let Some(mut screen) = screen(|_| ()) else { return };
    // Strands on a plane before the eye, beside each other, along y; the light is straight before their middle.
    let strands: Vec<Vec<Vec3>> =
        (0..101).map(|i| (0..5).map(|v| Vec3::new(0.02 * i as f32 - 1.0, 0.001 * v as f32, 0.0)).collect()).collect();
    let flat = Material::default().with(|m| (m.primary.strength, m.secondary.strength, m.variation) = (0.0, 0.0, 0.0));
    let groom = Groom::new(&strands, flat.with(|m| m.root_shade = 0.0));
    let bright = |screen: &mut Screen, light: Light| -> Vec<f64> {
        (screen.lights.sky, screen.lights.ground, screen.lights.lights) = (Vec3::ZERO, Vec3::ZERO, vec![light]);
        shaded(screen, &groom)[..101].iter().map(|color| color.x).collect()
    };
    let position = Vec3::new(0.0, 0.0, 1.0);
    let all = bright(&mut screen, Light::point(position, 10.0, Vec3::ONE));
    let cone = Cone { along: -Vec3::Z, inner: 0.3, outer: 0.5 };
    let some = bright(&mut screen, Light::spot(position, 10.0, cone, Vec3::ONE));
    for (i, (all, some)) in all.iter().zip(&some).enumerate() {
        let angle = f64::from(0.02 * i as f32 - 1.0).abs().atan();
        let expected = ((angle.cos() - 0.5_f64.cos()) / (0.3_f64.cos() - 0.5_f64.cos())).clamp(0.0, 1.0).powi(2);
        assert!((some / all - expected).abs() < 0.003, "{angle}: {} for {expected}", some / all);
    }
}

#[test]
fn a_cone_that_is_none_is_refused() {
    let Some(mut screen) = screen(|_| ()) else { return };
    let groom = Groom::wavy(3, 5, 1, Material::default());
    let mut list = PassList::new();
    let section = screen.section(&mut list, &groom);
    let cones =
        [(Vec3::ZERO, 0.1, 0.2), (Vec3::NAN, 0.1, 0.2), (Vec3::X, 0.2, 0.2), (Vec3::X, -0.1, 0.2), (Vec3::X, 0.1, 3.2)];
    for (along, inner, outer) in cones {
        screen.lights.lights = vec![Light::spot(Vec3::ZERO, 1.0, Cone { along, inner, outer }, Vec3::ONE)];
        let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
        let draw = SectionDraw::new(&section, &groom.material, groom.pose);
        let said = screen.renderer.draw(&mut PassList::new(), &[view], &[draw]).unwrap_err();
        assert!(matches!(said, DrawError::Cone { light: 0, .. }) && said.to_string().contains("light 0"), "{said}");
    }
}
