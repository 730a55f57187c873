//! Hair and settings that several tests of rendering share.
#![allow(dead_code, reason = "each test takes what it needs")]

use glam::Vec3;
use tressfx_asset::mesh::Mesh;
use tressfx_conformance::render::{Picture, Setup};
use tressfx_render::{Material, TilesDesc};

/// Hair of about a third of a pixel on the test's screen, half of which is opaque.
pub(crate) fn material() -> Material {
    Material::default().with(|m| {
        m.fibre_radius = Some(0.005);
        m.opacity = 0.7;
        m.tip_opacity = 0.5;
    })
}

/// The same with a colour of its own for each strand, so that a wrong order is seen.
pub(crate) fn varied() -> Material {
    material().with(|m| m.variation = 1.0)
}

/// Hair through which hundreds of fragments of a pixel are seen.
pub(crate) fn faint() -> Material {
    varied().with(|m| {
        m.fibre_radius = Some(0.01);
        (m.opacity, m.tip_opacity) = (0.03, 0.02);
    })
}

/// A square across the line of sight, with its left edge at `left`.
pub(crate) fn wall(left: f32, z: f32) -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, z);
    Mesh {
        positions: vec![corner(left, -5.0), corner(5.0, -5.0), corner(left, 5.0), corner(5.0, 5.0)],
        normals: vec![Vec3::Z; 4],
        indices: vec![0, 1, 2, 2, 1, 3],
    }
}

pub(crate) fn tiles(setup: &mut Setup) {
    setup.technique = TilesDesc::default().into();
}

/// Tiles that make every fragment, however little of it is seen.
pub(crate) fn endless(setup: &mut Setup) {
    setup.technique = TilesDesc::default().closed_below(0.0).into();
}

/// Whether all pixels are colours and opacities.
pub(crate) fn is_sound(picture: &Picture) -> bool {
    picture.pixels().iter().all(|pixel| pixel.is_finite() && pixel.min_element() >= 0.0 && pixel.w <= 1.0)
}
