//! `hair.render.velocity`.

use glam::{DMat4, DVec2, DVec3, Mat4, Vec2};
use tressfx_core::view::View;

use super::Strands;

/// How far, in pixels to the right and down, a pixel's point of a segment has moved on the screen since the frame before, without jitter; 0 where it
/// was not before the eye. `segment` is its first vertex, see [`Fragment::segment`](super::Fragment::segment); `past` are the same strands in the frame before.
///
/// The segment is before the near plane.
pub fn velocity(view: &View, strands: &Strands, past: &Strands, segment: u32, pixel: [u32; 2]) -> DVec2 {
    let (first, strand) = (segment / strands.numbered_strands(), segment % strands.numbered_strands());
    let last = (first + strands.uniform.lod.step).min(strands.uniform.vertices - 1);
    let ends = [first, last].map(|vertex| strands.point_of(strand, vertex));
    let before = [first, last].map(|vertex| past.point_of(strand, vertex));
    let [to_view, projection] = view.previous_matrices();
    let clip_now = clip(view.view_matrix(), view.projection_matrix());
    let clip_before = clip(to_view, projection);
    let at = ends.map(|end| on_screen(view, &clip_now, end));
    let weights = ends.map(|end| 1.0 / w_of(&clip_now, end));
    // Where the pixel is along the segment on the screen, and then along it in space.
    let delta = at[1] - at[0];
    let middle = DVec2::new(f64::from(pixel[0]), f64::from(pixel[1])) + 0.5;
    let place = ((middle - at[0]).dot(delta) / delta.length_squared().max(1e-12)).clamp(0.0, 1.0);
    let share = place * weights[1] / (weights[0] + (weights[1] - weights[0]) * place);
    let (here, there) = (ends[0].lerp(ends[1], share), before[0].lerp(before[1], share));
    if !there.is_finite() || w_of(&clip_before, there) <= 0.0 {
        return DVec2::ZERO;
    }
    let [jitter, jitter_before] = view.jitter().map(Vec2::as_dvec2);
    on_screen(view, &clip_now, here) - jitter - (on_screen(view, &clip_before, there) - jitter_before)
}

fn clip(to_view: Mat4, projection: Mat4) -> DMat4 {
    projection.as_dmat4() * to_view.as_dmat4()
}

fn w_of(clip: &DMat4, point: DVec3) -> f64 {
    (*clip * point.extend(1.0)).w
}

fn on_screen(view: &View, clip: &DMat4, point: DVec3) -> DVec2 {
    let size = DVec2::new(f64::from(view.size()[0]), f64::from(view.size()[1]));
    let place = clip.project_point3(point);
    0.5 * size * DVec2::new(1.0 + place.x, 1.0 - place.y)
}
