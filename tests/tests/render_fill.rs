//! Fragment shaders leave the fragments that the compute passes leave.

mod support;

use glam::Vec3;
use tressfx_asset::mesh::Mesh;
use tressfx_conformance::render::{Groom, Picture, Screen, Setup};
use tressfx_core::backend::{Caps, Format};
use tressfx_core::error::{Error, Need};
use tressfx_core::null::NullBackend;
use tressfx_core::view::{View, Viewport};
use tressfx_render::{Counters, Fill, HairRenderer, Material, PpllDesc, RenderDesc, ShortCutDesc, Technique};

use support::screen;

fn material(radius: f32) -> Material {
    Material::default().with(|m| {
        m.fibre_radius = Some(radius);
        m.opacity = 0.7;
        m.tip_opacity = 0.5;
    })
}

/// The techniques that can be filled in either way.
fn techniques() -> [Technique; 3] {
    let shortcut = ShortCutDesc::default();
    [PpllDesc::default().into(), shortcut.into(), shortcut.ordered(true).k(8).into()]
}

fn with_fill(technique: Technique, fill: Fill) -> Technique {
    match technique {
        Technique::Ppll(desc) => desc.fill(fill).into(),
        Technique::ShortCut(desc) => desc.fill(fill).into(),
        other => panic!("{other:?} has one way"),
    }
}

/// The same picture by either way.
fn both(
    technique: Technique,
    change: &dyn Fn(&mut Setup),
    draw: &dyn Fn(&mut Screen) -> Picture,
) -> Option<[Picture; 2]> {
    let mut pictures = Vec::new();
    for fill in [Fill::Compute, Fill::Raster] {
        let mut screen = screen(|setup| {
            change(setup);
            setup.technique = with_fill(technique, fill);
        })?;
        let many = Counters { wanted: 2_000_000, ..Counters::default() };
        screen.renderer.grow_to_measured(&mut *screen.backend, &many).unwrap();
        pictures.push(draw(&mut screen));
    }
    pictures.try_into().ok()
}

/// Holds the one against the other.
fn hold(name: &str, change: impl Fn(&mut Setup), draw: impl Fn(&mut Screen) -> Picture) {
    for technique in techniques() {
        let Some([compute, raster]) = both(technique, &change, &draw) else { return };
        eprintln!("{name}: {:?}", compute.counters);
        assert!(compute.counters.fragments > 0 && compute.counters.dropped == 0, "{name}, {technique:?}");
        assert_eq!(compute.counters, raster.counters, "{name}, {technique:?}");
        assert!(compute.bytes == raster.bytes, "{name}, {technique:?}");
    }
}

#[test]
fn strands_of_any_width_leave_the_same_fragments() {
    for radius in [1e-6, 0.0005, 0.005, 0.05, 1.5] {
        let groom = Groom::wavy(300, 16, 2, material(radius));
        hold(&format!("radius {radius}"), |_| (), |screen| screen.hair(&[&groom]));
    }
}

#[test]
fn straight_strands_in_all_directions_leave_the_same_fragments() {
    let strands: Vec<_> = (0..180)
        .map(|degrees| {
            let direction = Vec3::new((degrees as f32).to_radians().cos(), (degrees as f32).to_radians().sin(), 0.1);
            (0..6).map(|i| (i as f32 - 2.5) * 0.15 * direction).collect()
        })
        .collect();
    for radius in [0.002, 0.03] {
        let groom = Groom::new(&strands, material(radius));
        hold(&format!("star of {radius}"), |_| (), |screen| screen.hair(&[&groom]));
    }
}

#[test]
fn an_eye_within_the_hair_and_odd_screens_see_the_same_fragments() {
    let groom = Groom::wavy(300, 16, 2, material(0.005));
    for size in [[1, 1], [16384, 1], [1, 300], [7, 9], [333, 217]] {
        hold(&format!("{size:?}"), |setup| setup.size = size, |screen| screen.hair(&[&groom]));
    }
    let within = |setup: &mut Setup| {
        setup.camera.eye = Vec3::new(0.1, 0.0, 0.2);
        setup.camera.near = 0.001;
    };
    hold("within", within, |screen| screen.hair(&[&groom]));
}

#[test]
fn sections_and_a_scene_and_parts_of_a_target() {
    let (one, other) = (Groom::wavy(60, 12, 7, material(0.005)), Groom::wavy(40, 20, 8, material(0.01)));
    hold("two sections", |_| (), |screen| screen.hair(&[&one, &other]));
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let wall = Mesh {
        positions: vec![corner(0.0, -5.0), corner(5.0, -5.0), corner(0.0, 5.0), corner(5.0, 5.0)],
        normals: vec![Vec3::Z; 4],
        indices: vec![0, 1, 2, 2, 1, 3],
    };
    hold("a wall", |_| (), |screen| screen.scene(&[&wall], &[&one, &other]));
    let parts = |screen: &mut Screen| {
        let of = |offset, size| {
            let viewport = Viewport::part(offset, size, [96, 64]).unwrap();
            View::new(screen.view.view_matrix(), screen.view.projection_matrix(), screen.view.depth(), viewport)
                .unwrap()
        };
        let views = [of([3, 5], [40, 50]), of([50, 1], [46, 63])];
        screen.views(&views, &[&one])
    };
    hold("two parts of the target", |_| (), parts);
}

#[test]
fn strands_that_no_groom_should_hold_are_left_out_alike() {
    let whole = Groom::wavy(30, 8, 1, material(0.005));
    for bad in [f32::NAN, f32::INFINITY, 3e38, -1e13, 1e6] {
        let mut groom = whole.clone();
        // One vertex in the middle of strand 4, one at the tip of strand 9, one at the root of strand 11.
        for (strand, vertex) in [(4, 3), (9, 7), (11, 0)] {
            groom.positions[vertex * 30 + strand][1] = bad;
        }
        // A strand that is a point.
        for vertex in 0..8 {
            groom.positions[vertex * 30 + 20] = groom.positions[20];
        }
        hold(
            &format!("{bad}"),
            |_| (),
            |screen| {
                let picture = screen.hair(&[&groom]);
                assert!(picture.pixels().iter().all(|pixel| pixel.is_finite()), "{bad}");
                picture
            },
        );
    }
}

#[test]
fn a_full_pool_and_a_full_counter_are_harmless() {
    let groom = Groom::wavy(400, 16, 1, material(0.005));
    let Some(mut roomy) = screen(|setup| setup.ppll().fill = Fill::Raster) else { return };
    let all = roomy.hair(&[&groom]);
    for (capacity, limit) in [(1, PpllDesc::COUNT_LIMIT), (6000, PpllDesc::COUNT_LIMIT), (1000, 1000), (50_000, 64)] {
        let full = |setup: &mut Setup| {
            let lists = setup.ppll();
            (lists.fill, lists.max_node_bytes, lists.count_limit) = (Fill::Raster, 16 * capacity, limit);
        };
        let Some(mut screen) = screen(full) else { return };
        screen.may_grow = false;
        let picture = screen.hair(&[&groom]);
        let counters = picture.counters;
        eprintln!("room for {capacity}, counting to {limit}: {counters:?}");
        assert_eq!(counters.saturated, u32::from(all.counters.fragments >= limit));
        assert!(counters.saturated == 1 || counters.fragments == all.counters.fragments);
        assert!(counters.fragments >= limit.min(all.counters.fragments));
        assert_eq!(counters.dropped, counters.fragments - screen.renderer.capacity());
        let whole = all.pixels();
        assert!(picture.pixels().iter().zip(whole).all(|(some, every)| some.is_finite() && some.w <= every.w + 0.001));
    }
}

#[test]
fn twice_the_same_picture_to_the_bit() {
    let groom = Groom::wavy(6000, 16, 6, material(0.005));
    let large = |setup: &mut Setup| setup.size = [320, 200];
    hold("6000 strands", large, |screen| {
        let first = screen.hair(&[&groom]);
        assert!(first.bytes == screen.hair(&[&groom]).bytes);
        first
    });
}

#[test]
fn a_device_whose_fragment_shaders_write_nothing_says_so() {
    let mut caps = Caps::webgpu_default();
    caps.fragment_writes = false;
    let mut backend = NullBackend::new(caps);
    let mut make = |technique, fill| {
        let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(with_fill(technique, fill));
        HairRenderer::new(&mut backend, &desc)
    };
    for (technique, label) in
        techniques().into_iter().zip(["fill_raster", "shortcut_depths_raster", "shortcut_depths_raster"])
    {
        let error = make(technique, Fill::Raster).unwrap_err();
        assert!(matches!(error, Error::Unsupported { need: Need::FragmentWrites, .. }), "{error}");
        let said =
            format!("hair.render.{label}: needs fragment shaders that write storage buffers, the device has none");
        assert_eq!(error.to_string(), said);
        make(technique, Fill::Compute).unwrap();
    }
}
