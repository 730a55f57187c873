//! `hair.render.fill`.

use glam::{DVec3, DVec4};
use tressfx_core::view::View;

use super::Strands;
use super::coverage::Stripe;
use super::projection::Projection;
use super::ribbon::Ribbon;

/// What a strand leaves in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// Column and row.
    pub pixel: [u32; 2],
    /// The first vertex of its segment: a number in the order of the positions, as if copies had their own.
    pub segment: u32,
    /// Its depth, turned so that more is nearer, and 0 at the far end of the range.
    pub nearness: f64,
    /// Colour of the strand, not multiplied by alpha.
    pub color: DVec3,
    /// Coverage times opacity.
    pub alpha: f64,
    /// What it covers.
    pub stripe: Stripe,
}

/// The fragments of a section. `colors` holds colour and opacity of each strand vertex, in the order of the positions;
/// `scene` is the depth of what is opaque at a pixel of the viewport.
pub fn fill(
    view: &View,
    strands: &Strands,
    colors: &[DVec4],
    scene: &dyn Fn([u32; 2]) -> f32,
    sink: &mut dyn FnMut(Fragment),
) {
    fill_projected(&Projection::new(view), strands, colors, scene, sink);
}

pub(super) fn fill_projected(
    projection: &Projection,
    strands: &Strands,
    colors: &[DVec4],
    scene: &dyn Fn([u32; 2]) -> f32,
    sink: &mut dyn FnMut(Fragment),
) {
    for vertex in 0..strands.uniform.lod.vertices - 1 {
        for strand in 0..strands.uniform.lod.strands {
            if let Some(ribbon) = Ribbon::new(projection, strands, colors, strand, vertex) {
                ribbon.walk(projection, scene, sink);
            }
        }
    }
}
