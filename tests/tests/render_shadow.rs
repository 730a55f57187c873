//! What arrives of the sky and of lights at strand vertices: against f64, and against what is known of it.

mod support;

use glam::{DVec4, Vec3};
use tressfx_asset::mesh::Mesh;
use tressfx_conformance::render::{Groom, Random, Screen};
use tressfx_conformance::run_and_read;
use tressfx_core::backend::DepthOrder;
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Command, PassList};
use tressfx_core::shape::Ellipsoid;
use tressfx_core::view::{Pose, View};
use tressfx_render::reference::{self, Arriving, Shadows, shadow_light, shadow_opaque};
use tressfx_render::uniforms::{OpaqueUniform, ShadowUniform};
use tressfx_render::{
    Cone, FibreScattering, Light, Lights, Lod, MAX_LIGHTS, Material, OpaqueDepth, SectionDraw, ShadowDesc, ViewDraw,
};

use support::screen;

const DESC: fn() -> ShadowDesc = || ShadowDesc::default().texels(96, 48).cells(24);

/// What the kernels leave at each vertex of a groom that is drawn, and what the references do.
fn arriving(screen: &mut Screen, desc: &ShadowDesc, groom: &Groom) -> (Vec<Arriving>, Vec<Arriving>) {
    let mut list = PassList::new();
    let section = screen.section(&mut list, groom);
    let draws = [SectionDraw::new(&section, &groom.material, groom.pose).lod(groom.lod)];
    let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
    screen.renderer.draw(&mut list, &[view], &draws).unwrap();
    let ticket = list.read_buffer(section.arriving(), 0, 16 * groom.positions.len() as u64);
    let uniform = ShadowUniform::new(desc, &screen.lights, &draws);
    let bytes = run_and_read(&mut *screen.backend, &list, ticket);
    let lights = screen.lights.clone();
    let strands = groom.reference();
    let shadows = Shadows::new(&uniform, &lights, &[strands]);
    let lod = groom.lod.uniform(groom.shape);
    let last = groom.shape.vertices - 1;
    let drawn = (0..lod.vertices).flat_map(|v| (0..lod.strands).map(move |strand| (strand, (v * lod.step).min(last))));
    let drawn = || drawn.clone().map(|(strand, vertex)| groom.shape.index(strand, vertex) as usize);
    let expected = drawn().map(|i| shadow_light(&shadows, strands.posed(i))).collect();
    (drawn().map(|i| decoded(&bytes[16 * i..])).collect(), expected)
}

fn decoded(bytes: &[u8]) -> Arriving {
    let half = |i: usize| half::f16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]).to_f64();
    let share = |i: usize| (f64::from(bytes[8 + i]) / 255.0).powi(2);
    Arriving { sky: DVec4::new(half(0), half(1), half(2), half(3)), lights: std::array::from_fn(share) }
}

fn shadowed(desc: ShadowDesc) -> Option<Screen> {
    screen(|setup| setup.shadows = Some(desc))
}

/// The error that a share of `of_all` differences is below.
fn quantile(mut differences: Vec<f64>, of_all: f64) -> f64 {
    differences.sort_by(f64::total_cmp);
    differences[((differences.len() - 1) as f64 * of_all) as usize]
}

#[test]
fn every_vertex_is_as_in_f64() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    // All of it, and fewer strands of fewer vertices, the last of which does not come in its turn.
    [Lod::FULL, Lod { share: 0.4005, step: 4 }].into_iter().for_each(|lod| is_as_in_f64(&mut screen, lod));
}

fn is_as_in_f64(screen: &mut Screen, lod: Lod) {
    screen.lights = Lights {
        sky: Vec3::ONE,
        ground: Vec3::splat(0.2),
        lights: vec![
            Light::directional(Vec3::new(0.3, 1.0, 0.4), Vec3::ONE),
            Light::point(Vec3::new(2.0, 1.0, 1.5), 1.0, Vec3::ONE),
            Light::directional(Vec3::X, Vec3::ONE).casts(false),
            Light::point(Vec3::new(0.1, 0.1, 0.0), 1.0, Vec3::ONE),
            Light::directional(Vec3::new(-1.0, 0.2, 0.0), Vec3::ONE),
        ],
    };
    let pose = Pose { rotation: glam::Quat::from_rotation_z(0.4), translation: Vec3::new(0.1, 0.2, -0.3) };
    let material = Material::default().with(|m| m.fibre_radius = Some(0.002));
    let groom = Groom { pose, lod, ..Groom::wavy(700, 16, 1, material) };
    let (found, expected) = arriving(screen, &DESC(), &groom);
    for light in 0..5 {
        let shares = || expected.iter().map(|expected| expected.lights[light]);
        let off = found.iter().zip(&expected).map(|(a, b)| (a.lights[light] - b.lights[light]).abs()).collect();
        let (low, error) = (shares().fold(1.0, f64::min), quantile(off, 0.99));
        eprintln!("light {light}: from {low:.3}, 99 of 100 vertices within {error:.4}");
        // Bytes that hold square roots are 1/255 apart: twice that in the share. A piece on the border of two cells may be in either.
        assert!(error < 0.006, "{error}");
        assert!(if light == 2 { low == 1.0 } else { low < 0.5 }, "light {light} casts: {low}");
    }
    let off = found.iter().zip(&expected).map(|(a, b)| (a.sky - b.sky).abs().max_element()).collect();
    let error = quantile(off, 0.99);
    eprintln!("sky: 99 of 100 vertices within {error:.4}");
    assert!(error < 0.003, "{error}");
}

#[test]
fn fibres_that_scatter_as_glass_are_shaded_as_in_f64() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    screen.lights.sky = Vec3::new(0.5, 0.6, 0.7);
    let material = Material::default().with(|m| m.fibre = Some(FibreScattering::default()));
    is_shaded_as_in_f64(&mut screen, material);
}

/// Lights of every kind, half of which have no share of their own at a vertex.
fn sixteen() -> Vec<Light> {
    let cone = Cone { along: Vec3::NEG_ONE, inner: 0.2, outer: 0.9 };
    let light = |i: usize| {
        let turned = glam::Quat::from_rotation_y(0.4 * i as f32) * Vec3::new(1.0, 0.5, 0.2);
        let color = Vec3::new(0.2, 0.3, 0.1 * i as f32);
        match i % 4 {
            0 => Light::directional(turned, color),
            1 => Light::point(2.0 * turned, 1.0, color),
            2 => Light::spot(2.0 * turned, 1.0, Cone { along: -turned, ..cone }, color),
            _ => Light::directional(turned, color).casts(i % 8 == 3),
        }
    };
    (0..MAX_LIGHTS).map(light).collect()
}

#[test]
fn sixteen_lights_shade_as_in_f64() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    screen.lights.lights = sixteen();
    is_shaded_as_in_f64(&mut screen, Material::default());
}

#[test]
fn lights_beyond_eight_take_no_pass_and_no_memory() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    let groom = Groom::wavy(20, 8, 3, Material::default());
    let mut frame = |lights: &[Light]| {
        screen.lights.lights = lights.to_vec();
        let mut list = PassList::new();
        let section = screen.section(&mut list, &groom);
        let draws = [SectionDraw::new(&section, &groom.material, groom.pose)];
        let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
        screen.renderer.draw(&mut list, &[view], &draws).unwrap();
        let groups = list.passes().filter_map(|(label, pass)| match pass {
            Command::Compute(pass) if label.starts_with("hair.render.shadow") => Some((label, pass.groups)),
            _ => None,
        });
        (groups.collect::<Vec<_>>(), screen.renderer.shadow_bytes())
    };
    let all = sixteen();
    let (four, bytes) = frame(&all[..4]);
    assert!(four.len() == 5, "{four:?}");
    assert_eq!(frame(&all), (four, bytes));
}

/// It may be refused, and its list thrown away.
#[test]
fn what_was_cast_counts_for_the_next_frame_alone() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    let groom = Groom::wavy(50, 8, 1, Material::default());
    let strands = screen.section(&mut PassList::new(), &groom);
    let draws = [SectionDraw::new(&strands, &groom.material, groom.pose)];
    let (view, lights, targets) = (screen.view, screen.lights.clone(), screen.targets());
    let seen = ViewDraw::new(&view, &lights, targets);
    let refused = ViewDraw::new(&view, &lights, targets.hair(targets.color));
    let renderer = &mut screen.renderer;
    let mut drawn = |is_cast: bool, views: &[ViewDraw]| {
        let mut list = PassList::new();
        if is_cast {
            renderer.cast(&mut PassList::new(), &lights, &draws).unwrap();
        }
        let done = renderer.draw(&mut list, views, &draws);
        done.map(|()| list.labels().filter(|label| label.starts_with("hair.render.shadow_")).count())
    };
    let all = drawn(false, &[seen]).unwrap();
    assert!(all > 3 && drawn(true, &[seen]).unwrap() == 0, "{all} passes of shadows");
    assert_eq!(drawn(false, &[seen]).unwrap(), all);
    drawn(true, &[refused]).unwrap_err();
    assert_eq!(drawn(false, &[seen]).unwrap(), all, "those of the frame that was refused are not there");
}

fn is_shaded_as_in_f64(screen: &mut Screen, material: Material) {
    let groom = Groom::wavy(500, 16, 1, material);
    let mut list = PassList::new();
    let section = screen.section(&mut list, &groom);
    let draws = [SectionDraw::new(&section, &groom.material, groom.pose)];
    let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
    screen.renderer.draw(&mut list, &[view], &draws).unwrap();
    let vertices = groom.positions.len() as u64;
    let ticket = list.read_buffer(section.colors(), 0, 8 * vertices);
    let bytes = run_and_read(&mut *screen.backend, &list, ticket);
    // The same list leaves the same light.
    let (arriving, _) = arriving(screen, &DESC(), &groom);
    let table = reference::FibreTable::of(&groom.material);
    let strands = reference::Strands { fibre: table.as_ref(), arriving: Some(&arriving), ..groom.reference() };
    let (count, mut worst, mut darkest) = (groom.shape.strands(), 0.0f64, f64::INFINITY);
    for (i, bytes) in (0..).zip(bytes.chunks(8)) {
        let channel = |c: usize| half::f16::from_le_bytes([bytes[2 * c], bytes[2 * c + 1]]).to_f64();
        let found = DVec4::from_array([0, 1, 2, 3].map(channel));
        let expected = reference::shade(&screen.view, &screen.lights, &strands, i % count, i / count);
        worst = worst.max(((found - expected).abs() / expected.max(DVec4::ONE)).max_element());
        darkest = darkest.min(expected.x);
    }
    eprintln!("{vertices} vertices in shadows: largest error {worst:.2e}, the darkest is {darkest:.3}");
    assert!(worst < 2e-3, "{worst}");
}

/// A slab of fibres in the plane across y, all along x, that is 1 deep and in which a ray along y meets `crossings` fibres in the mean.
fn slab(crossings: f32, radius: f32) -> Groom {
    let mut random = Random(5);
    let count = (crossings / (2.0 * radius)) as u32;
    let fibre = |_| {
        let (y, z) = (random.unit(), random.unit());
        (0..9).map(|i| Vec3::new(i as f32 / 8.0, y, z)).collect()
    };
    let strands: Vec<Vec<Vec3>> = (0..count).map(fibre).collect();
    Groom::new(&strands, Material::default().with(|m| m.fibre_radius = Some(radius)))
}

#[test]
fn light_falls_off_in_a_slab_as_the_number_of_fibres_says() {
    let Some(mut screen) = shadowed(ShadowDesc::default()) else { return };
    screen.lights.lights = vec![Light::directional(Vec3::Y, Vec3::ONE)];
    let groom = slab(8.0, 0.0005);
    let (found, _) = arriving(&mut screen, &ShadowDesc::default(), &groom);
    // Away from the sides, and from the skin that the roots stand for.
    let inside = |p: &[f32; 4]| (0.2..0.8).contains(&p[2]) && (0.3..0.8).contains(&p[0]);
    for depth in [0.1f32, 0.3, 0.5, 0.9] {
        let near = |p: &[f32; 4]| (1.0 - p[1] - depth).abs() < 0.02;
        let shares: Vec<f64> = groom
            .positions
            .iter()
            .zip(&found)
            .filter(|(p, _)| inside(p) && near(p))
            .map(|(_, a)| a.lights[0])
            .collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        // Fibres that lie at random: the number on a ray has a Poisson distribution, and each takes 0.3.
        let expected = f64::from(-0.3 * 8.0 * depth).exp();
        eprintln!("depth {depth}: {mean:.4} of {} vertices, {expected:.4} expected", shares.len());
        assert!(shares.len() > 50 && (mean / expected - 1.0).abs() < 0.06, "{mean} is not {expected}");
    }
}

#[test]
fn a_single_strand_shades_itself_hardly() {
    let Some(mut screen) = shadowed(ShadowDesc::default()) else { return };
    screen.lights.lights = vec![Light::directional(Vec3::new(0.2, 1.0, 0.3), Vec3::ONE)];
    let strand: Vec<Vec3> = (0..16).map(|i| Vec3::new(0.3 * i as f32 / 15.0, 0.02 * i as f32, 0.0)).collect();
    let groom = Groom::new(&[strand], Material::default().with(|m| m.fibre_radius = Some(0.00006)));
    let (found, _) = arriving(&mut screen, &ShadowDesc::default(), &groom);
    let darkest = found[2..].iter().map(|arriving| arriving.lights[0]).fold(1.0, f64::min);
    assert!(darkest > 0.97, "{darkest}");
}

#[test]
fn two_runs_give_the_same_bits() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    let groom = Groom::wavy(300, 12, 3, Material::default());
    let (one, _) = arriving(&mut screen, &DESC(), &groom);
    let (other, _) = arriving(&mut screen, &DESC(), &groom);
    assert_eq!(one, other);
}

#[test]
fn nothing_that_casts_and_no_sky_means_no_pass() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    let groom = Groom::wavy(20, 8, 3, Material::default());
    let mut labels = |lights: Lights| {
        screen.lights = lights;
        let mut list = PassList::new();
        let section = screen.section(&mut list, &groom);
        let draws = [SectionDraw::new(&section, &groom.material, groom.pose)];
        let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
        screen.renderer.draw(&mut list, &[view, view], &draws).unwrap();
        list.labels().filter_map(|label| label.strip_prefix("hair.render.shadow_")).collect::<Vec<_>>()
    };
    let light = Light::directional(Vec3::Y, Vec3::ONE);
    let lights = |sky, casts| Lights { sky, ground: Vec3::ZERO, lights: vec![light.casts(casts)] };
    assert_eq!(labels(lights(Vec3::ONE, true)), ["bounds", "splat", "sum", "sky", "light"], "two views share them");
    assert_eq!(labels(lights(Vec3::ZERO, true)), ["bounds", "splat", "sum", "light"]);
    assert_eq!(labels(lights(Vec3::ONE, false)), ["bounds", "splat", "sky", "light"]);
    assert!(labels(lights(Vec3::ZERO, false)).is_empty());
}

#[test]
fn hair_that_is_nowhere_tiny_or_huge_gets_light_that_is_a_share() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    let point = vec![vec![Vec3::ZERO; 4]];
    let huge = vec![(0..4).map(|i| Vec3::splat(1e11 * i as f32)).collect()];
    let lost = vec![vec![Vec3::splat(f32::NAN); 4], (0..4).map(|i| Vec3::Y * i as f32).collect()];
    for (name, strands) in [("a point", point), ("huge", huge), ("not a number", lost)] {
        let groom = Groom::new(&strands, Material::default());
        let (found, _) = arriving(&mut screen, &DESC(), &groom);
        for one in found {
            assert!(
                one.sky.is_finite() && one.lights.iter().all(|share| (0.0..=1.0).contains(share)),
                "{name}: {one:?}"
            );
        }
    }
}

#[test]
fn lights_where_no_light_should_be_leave_shares() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    let groom = Groom::wavy(50, 8, 3, Material::default());
    let places = [Vec3::ZERO, Vec3::splat(1e30), Vec3::splat(f32::NAN), screen.view.lens().eye.truncate()];
    for place in places {
        screen.lights.lights = vec![Light::point(place, 1.0, Vec3::ONE), Light::directional(place, Vec3::ONE)];
        let (found, _) = arriving(&mut screen, &DESC(), &groom);
        let sound = |one: &Arriving| one.lights.iter().all(|share| (0.0..=1.0).contains(share)) && one.sky.is_finite();
        assert!(found.iter().all(sound), "{place}");
    }
}

/// Where a ball hides the light, and where not: from a map of what the light sees, and by hand.
#[test]
fn hair_behind_a_ball_is_dark() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    let towards = Vec3::new(1.0, 0.5, 0.3).normalize();
    let (center, radius) = (Vec3::new(0.1, 0.2, 0.0), 0.25f32);
    let eye = glam::camera::rh::view::look_to_mat4(center + 3.0 * towards, -towards, Vec3::Y);
    let reverse = [false, true];
    for (is_reverse, order) in reverse.into_iter().zip([DepthOrder::Standard, DepthOrder::Reverse]) {
        let planes = if is_reverse { [6.0, 1.0] } else { [1.0, 6.0] };
        let lens = glam::camera::rh::proj::directx::orthographic(-0.5, 0.5, -0.5, 0.5, planes[0], planes[1]);
        let view = View::new(eye, lens, order, [256; 2]).unwrap();
        let ball = Mesh::ellipsoid(&Ellipsoid { center, radii: Vec3::splat(radius) }, 96);
        let depth = screen.depth_from(&view, &[&ball]);
        let opaque = OpaqueDepth { depth: depth.0, view, bias: 0.01 };
        screen.lights.lights = vec![Light::directional(towards, Vec3::ONE).opaque(opaque)];
        // Fibres that take nothing: what is dark is dark for the ball.
        let material = Material::default().with(|m| m.shadow_alpha = 0.0);
        let groom = Groom::wavy(400, 24, 9, material);
        let (found, _) = arriving(&mut screen, &DESC(), &groom);
        let uniform = OpaqueUniform::new(&opaque, 0);
        let (mut dark, mut lit) = (0, 0);
        for (position, arriving) in groom.positions.iter().zip(&found) {
            let off = Vec3::from_slice(&position[..3]) - center;
            let past = (off - towards * off.dot(towards)).length();
            let expected = shadow_opaque(&uniform, &depth.1, (off + center).as_dvec3());
            // A byte, and a comparison that rounding decides.
            assert!((arriving.lights[0] - expected).abs() < 0.12, "{arriving:?}: {expected}");
            // Four texels are half lit.
            if (past - radius).abs() < 0.016 || off.length() < radius + 0.02 {
                continue;
            }
            let is_dark = past < radius && off.dot(towards) < 0.0;
            assert_eq!(arriving.lights[0], if is_dark { 0.0 } else { 1.0 }, "{position:?}");
            *(if is_dark { &mut dark } else { &mut lit }) += 1;
        }
        assert!(dark > 300 && lit > 3000, "{dark} dark, {lit} lit");
    }
}

#[test]
fn lights_whose_depth_is_in_one_texture_share_a_pass_and_leave_the_same() {
    let Some(mut screen) = shadowed(DESC()) else { return };
    let ball = Mesh::ellipsoid(&Ellipsoid { center: Vec3::ZERO, radii: Vec3::splat(0.25) }, 96);
    let view_from = |towards: Vec3| {
        let eye = glam::camera::rh::view::look_to_mat4(3.0 * towards, -towards, Vec3::Y);
        let lens = glam::camera::rh::proj::directx::orthographic(-0.5, 0.5, -0.5, 0.5, 1.0, 6.0);
        View::new(eye, lens, DepthOrder::Standard, [128; 2]).unwrap()
    };
    // A ball looks the same from everywhere: what one light sees of it is what each of them sees.
    let ways = [Vec3::X, Vec3::new(0.6, 0.0, 0.8), Vec3::Z, Vec3::NEG_X, Vec3::new(0.0, 0.6, 0.8)];
    let textures = ways.map(|_| screen.depth_from(&view_from(Vec3::X), &[&ball]).0);
    let groom = Groom::wavy(200, 24, 9, Material::default());
    let mut found = |depth_of: &dyn Fn(usize) -> TextureId| {
        let light = |(i, way): (usize, &Vec3)| {
            let opaque = OpaqueDepth { depth: depth_of(i), view: view_from(*way), bias: 0.01 };
            Light::directional(*way, Vec3::ONE).opaque(opaque)
        };
        screen.lights.lights = ways.iter().enumerate().map(light).collect();
        let mut list = PassList::new();
        let section = screen.section(&mut list, &groom);
        let draws = [SectionDraw::new(&section, &groom.material, groom.pose)];
        let view = ViewDraw::new(&screen.view, &screen.lights, screen.targets());
        screen.renderer.draw(&mut list, &[view], &draws).unwrap();
        let passes = list.labels().filter(|label| *label == "hair.render.shadow_opaque").count();
        (passes, arriving(&mut screen, &DESC(), &groom).0)
    };
    let (apart, two, one) = (found(&|i| textures[i]), found(&|i| textures[i % 2]), found(&|_| textures[0]));
    assert_eq!([apart.0, two.0, one.0], [5, 2, 1]);
    assert!(two.1 == apart.1 && one.1 == apart.1);
    assert!((0..5).all(|light| apart.1.iter().any(|arriving| arriving.lights[light] == 0.0)), "each light is hidden");
}

#[test]
fn light_stops_behind_roots_only_where_hair_grows_on_skin() {
    let mut darkest = [true, false].into_iter().filter_map(|skin| {
        let desc = DESC().skin(skin);
        let mut screen = shadowed(desc)?;
        screen.lights.lights = vec![Light::directional(-Vec3::Y, Vec3::ONE)];
        // Fibres that take nothing: what is dark is dark for the skin.
        let groom = Groom::wavy(400, 8, 2, Material::default().with(|m| m.shadow_alpha = 0.0));
        let (found, expected) = arriving(&mut screen, &desc, &groom);
        let least = |all: &[Arriving]| all.iter().map(|one| one.lights[0].min(one.sky.w)).fold(1.0, f64::min);
        assert!((least(&found) - least(&expected)).abs() < 0.02, "{}: {}", least(&found), least(&expected));
        Some(least(&found))
    });
    let (Some(on_skin), Some(in_air)) = (darkest.next(), darkest.next()) else { return };
    assert!(on_skin < 0.7 && in_air == 1.0, "{on_skin} {in_air}");
}

/// Hair that moves as a whole has the same shadow: what differs is only how it falls into the cells. The light does not come through the
/// skin: that is in a cell or not.
#[test]
fn shadows_swim_little_when_hair_moves_as_a_whole() {
    let Some(mut screen) = shadowed(ShadowDesc::default()) else { return };
    screen.lights.lights = vec![Light::directional(Vec3::new(1.0, -0.3, 0.4), Vec3::ONE)];
    let groom = Groom::wavy(3000, 16, 1, Material::default().with(|m| m.fibre_radius = Some(0.0005)));
    let mut at = |x: f32| {
        let pose = Pose { translation: Vec3::new(x, 0.3 * x, 0.0), ..Pose::IDENTITY };
        let (found, _) = arriving(&mut screen, &ShadowDesc::default(), &Groom { pose, ..groom.clone() });
        found[4 * 3000..].to_vec()
    };
    let mut before = at(0.0);
    for step in 1..=6 {
        // A fifth of a cell.
        let now = at(0.0017 * step as f32);
        let off: Vec<f64> = before.iter().zip(&now).map(|(a, b)| (a.lights[0] - b.lights[0]).abs()).collect();
        let rms = (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt();
        let [most, all] = [0.99, 1.0].map(|share| quantile(off.clone(), share));
        eprintln!("step {step}: RMS {rms:.4}, 99 of 100 vertices within {most:.4}, all within {all:.4}");
        assert!(rms < 0.02 && most < 0.07 && all < 0.2, "{rms} {most} {all}");
        before = now;
    }
}
