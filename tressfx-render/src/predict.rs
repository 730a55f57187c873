//! How many fragments a frame will have.

use glam::{Mat4, Vec2, Vec3};
use tressfx_core::view::View;

use crate::resolved::TILE;
use crate::strands::SectionDraw;

/// Slices of depth that a segment touches within a tile, in the mean and generously.
const SLICES_OF_A_TILE: f64 = 1.5;

/// Fragments that a view of sections makes, from the samples of their rest poses, what is hidden behind meshes included.
pub(crate) fn fragments(view: &View, draws: &[SectionDraw]) -> f64 {
    draws.iter().filter(|draw| !draw.strands.info.sample.is_empty()).map(|draw| of_section(view, draw)).sum()
}

/// References of tiles to segments that a view of sections makes, from the same samples.
pub(crate) fn references(view: &View, draws: &[SectionDraw]) -> f64 {
    let tile = f64::from(TILE);
    let segments: u32 = draws.iter().map(|draw| draw.strands.buffers.shape.segments()).sum();
    // A segment crosses an edge between tiles every TILE pixels along either axis, and it is in several slices here and there.
    SLICES_OF_A_TILE * (f64::from(segments) + 2.0 * fragments(view, draws) / tile)
}

fn of_section(view: &View, draw: &SectionDraw) -> f64 {
    let info = &draw.strands.info;
    let to_eye = view.lens().to_eye * draw.pose.matrix();
    let radius = info.radius(draw.material);
    let width = |share: f32| radius * (draw.material.tip_width + (1.0 - draw.material.tip_width) * share);
    let sum: f64 =
        info.sample.iter().map(|(ends, shares)| f64::from(of_segment(view, to_eye, *ends, shares.map(width)))).sum();
    sum * f64::from(draw.strands.buffers.shape.segments()) / info.sample.len() as f64
}

/// The expected number of pixel centres within reach of a segment: its length on the screen times the width of the strip,
/// which a pixel's own extent across the strand makes wider on both sides.
fn of_segment(view: &View, to_eye: Mat4, ends: [Vec3; 2], radii: [f32; 2]) -> f32 {
    let lens = view.lens();
    let half = Vec2::new(view.size()[0] as f32, view.size()[1] as f32) * 0.5;
    let ends = ends.map(|end| to_eye.transform_point3(end));
    if ends.iter().any(|end| -end.z < lens.near) {
        return 0.0;
    }
    let scales = ends.map(|end| if lens.is_perspective { -1.0 / end.z } else { 1.0 });
    // Pixels from the middle of the picture.
    let on_screen = |end: Vec3, scale: f32| {
        let moved = Vec2::new(lens.focal.x * end.x, -(lens.skew * end.x + lens.focal.y * end.y));
        lens.center - half + moved * scale
    };
    let [a, b] = [on_screen(ends[0], scales[0]), on_screen(ends[1], scales[1])];
    let middle = (a + b) * 0.5;
    let length = a.distance(b);
    if middle.abs().cmpgt(half + length).any() {
        return 0.0;
    }
    let focal = (lens.focal.x * lens.focal.y).sqrt();
    let width: f32 = radii.iter().zip(scales).map(|(radius, scale)| radius * focal * scale).sum();
    length * width + (b - a).abs().element_sum()
}
