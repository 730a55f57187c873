//! The reference renderer, which traces fibres as solids, against strips on a screen: two methods that share no code.

mod support;

use std::num::NonZeroU32;

use glam::DVec4;
use tressfx_conformance::render::{Difference, Groom, Screen, Setup};
use tressfx_core::view::View;
use tressfx_render::{Lights, Material, reference};
use tressfx_truth::{Section, Truth};

use support::screen;

fn groom() -> Groom {
    let material = Material::default().with(|m| {
        m.fibre_radius = Some(0.003);
        m.opacity = 0.7;
        m.tip_opacity = 0.5;
    });
    Groom::wavy(200, 16, 5, material)
}

/// The groom by rays.
fn traced(view: &View, lights: &Lights, groom: &Groom, samples: u32) -> Vec<DVec4> {
    let strands = groom.reference();
    let order = (0..groom.shape.vertices).flat_map(|v| (0..groom.shape.strands()).map(move |s| (s, v)));
    let shaded = order.map(|(strand, vertex)| reference::shade(view, lights, &strands, strand, vertex));
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
    let samples = NonZeroU32::new(samples).unwrap();
    Truth::new(view, &[section], None).unwrap().render(samples, &|_| ()).pixels().to_vec()
}

#[test]
fn strips_on_a_finer_and_finer_screen_come_to_the_picture_of_solids() {
    let Setup { camera, size, .. } = Setup::default();
    let (view, lights, groom) = (camera.view(size).unwrap(), tressfx_conformance::scene::lights(), groom());
    let truth = traced(&view, &lights, &groom, 1024);
    let finer = |factor| reference::supersampled(&view, &lights, &[groom.reference()], factor);
    let psnr = [1, 4, 16].map(|factor| Difference::between(&truth, &finer(factor)).psnr);
    eprintln!("PSNR of strips with 1, 16 and 256 samples a pixel against the truth: {psnr:.1?}");
    assert!(psnr.is_sorted(), "{psnr:?}");
    assert!(psnr[2] > 56.0, "{psnr:?}");
}

#[test]
fn the_picture_of_the_gpu_is_near_the_truth() {
    let Some(mut screen): Option<Screen> = screen(|setup| setup.ppll().k = 16) else { return };
    let groom = groom();
    let truth = traced(&screen.view, &screen.lights, &groom, 256);
    let difference = screen.hair(&[&groom]).difference(&truth);
    eprintln!("PPLL against the truth: {difference:?}");
    assert!(difference.psnr > 38.0, "{difference:?}");
}
