//! How many fragments a frame will have.

use glam::{Mat4, Vec2, Vec3};
use tressfx_core::view::View;

use crate::section::SectionDraw;

/// Fragments that a view of sections makes, from the samples of their rest poses, what is hidden behind meshes included.
pub(crate) fn fragments(view: &View, draws: &[SectionDraw]) -> f64 {
    draws.iter().filter(|draw| !draw.section.info.sample.is_empty()).map(|draw| of_section(view, draw)).sum()
}

fn of_section(view: &View, draw: &SectionDraw) -> f64 {
    let info = &draw.section.info;
    let to_view = view.view_matrix() * draw.pose.matrix();
    let radius = info.radius(draw.material);
    let width = |share: f32| radius * (draw.material.tip_width + (1.0 - draw.material.tip_width) * share);
    let sum: f64 =
        info.sample.iter().map(|(ends, shares)| f64::from(of_segment(view, to_view, *ends, shares.map(width)))).sum();
    sum * f64::from(draw.section.buffers.shape.segments()) / info.sample.len() as f64
}

/// The expected number of pixel centres within reach of a segment: its length on the screen times the width of the strip,
/// which a pixel's own extent across the strand makes wider on both sides.
fn of_segment(view: &View, to_view: Mat4, ends: [Vec3; 2], radii: [f32; 2]) -> f32 {
    let focal = 1.0 / view.pixel_angle();
    let center = Vec2::new(view.size[0] as f32, view.size[1] as f32) * 0.5;
    let in_view = ends.map(|end| to_view.transform_point3(end));
    if in_view.iter().any(|end| -end.z < view.near) {
        return 0.0;
    }
    let [a, b] = in_view.map(|end| end.truncate() * focal / -end.z);
    let middle = (a + b) * 0.5;
    let length = a.distance(b);
    if middle.abs().cmpgt(center + length).any() {
        return 0.0;
    }
    let width: f32 = radii.iter().zip(in_view).map(|(radius, end)| radius * focal / -end.z).sum();
    length * width + (b - a).abs().element_sum()
}
