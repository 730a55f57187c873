//! How many fragments a frame will have.

use std::f32::consts::FRAC_PI_8;

use glam::{Mat4, Vec2, Vec3};
use tressfx_core::view::View;

use crate::resolved::{TILE, tile_count};
use crate::strands::SectionDraw;

/// References to a segment within a tile, one for every second slice of depth that it touches, in the mean, those of tiles that turns reach into beyond their
/// joints included. Five grooms at three distances need 0.78 to 0.97 of it, straight and curly ones the least, long hair from far away the most.
const REFERENCES_OF_A_TILE: f64 = 1.44;

/// Fragments that a view of sections makes, from the samples of their rest poses, what is hidden behind meshes included.
pub(crate) fn fragments(view: &View, draws: &[SectionDraw]) -> f64 {
    sum(view, draws, fragments_of)
}

/// References of tiles to segments that a view of sections makes, from the same samples.
pub(crate) fn references(view: &View, draws: &[SectionDraw]) -> f64 {
    REFERENCES_OF_A_TILE * sum(view, draws, tiles_of)
}

/// How far hair swings out of the bounds of its rest pose, in parts of their size.
const SWING: f32 = 0.15;

/// Tiles that may have hair: those of a box on the screen around the samples of each section, made larger on all sides.
pub(crate) fn tiles(view: &View, draws: &[SectionDraw]) -> u64 {
    let all = u64::from(tile_count(view.size()));
    let of_section = |draw: &SectionDraw| {
        let to_eye = view.lens().to_eye * draw.pose.matrix();
        let ends = draw.strands.info.sample.iter().flat_map(|(ends, _)| ends);
        let mut bounds: Option<[Vec2; 2]> = None;
        for end in ends.map(|&end| to_eye.transform_point3(end)).filter(|end| end.is_finite()) {
            let Some((pixel, scale)) = on_screen(view, end) else { return all };
            let aside = draw.farthest_copy() * view.lens().focal.abs() * scale;
            let [low, high] = bounds.unwrap_or([pixel; 2]);
            bounds = Some([low.min(pixel - aside), high.max(pixel + aside)]);
        }
        bounds.map_or(0, |bounds| tiles_in(bounds, view.size()))
    };
    draws.iter().map(of_section).sum::<u64>().min(all)
}

/// The pixel of a point in the space of the eye, and by how much what is there is made smaller; none where it is not beyond the near plane.
fn on_screen(view: &View, end: Vec3) -> Option<(Vec2, f32)> {
    let lens = view.lens();
    let scale = if lens.is_perspective { -1.0 / end.z } else { 1.0 };
    let moved = Vec2::new(lens.focal.x * end.x, -(lens.skew * end.x + lens.focal.y * end.y));
    (-end.z >= lens.near).then(|| (lens.center + moved * scale, scale))
}

/// The tiles of a box of pixels that is made larger by [`SWING`].
fn tiles_in([low, high]: [Vec2; 2], size: [u32; 2]) -> u64 {
    let last = Vec2::new(size[0] as f32, size[1] as f32) - 1.0;
    let margin = (high - low) * SWING + TILE as f32;
    let (low, high) = ((low - margin).max(Vec2::ZERO), (high + margin).min(last));
    if low.cmpgt(high).any() {
        return 0;
    }
    let [low, high] = [low, high].map(|corner| (corner / TILE as f32).as_u64vec2());
    (high - low + 1).element_product()
}

/// The sum of something over the segments of all sections that are before the eye, from their samples.
fn sum(view: &View, draws: &[SectionDraw], of: impl Fn(&Strip) -> f32) -> f64 {
    let of_section = |draw: &SectionDraw| {
        let info = &draw.strands.info;
        let to_eye = view.lens().to_eye * draw.pose.matrix();
        let radius = info.radius(draw.material) * draw.lod.widening(draw.drawn_shape());
        let width = |share: f32| radius * (draw.material.tip_width + (1.0 - draw.material.tip_width) * share);
        // A root and a tip a strand.
        let lod = draw.lod_uniform();
        let ends = 2.0 / (lod.vertices - 1).max(1) as f32;
        // What is drawn leads over several segments.
        let longer = (draw.strands.buffers.shape.vertices - 1) as f32 / (lod.vertices - 1).max(1) as f32;
        let strip = |(at, shares): &([Vec3; 2], [f32; 2])| Strip::new(view, to_eye, *at, shares.map(width));
        let strips =
            info.sample.iter().filter_map(strip).map(|strip| Strip { ends, delta: strip.delta * longer, ..strip });
        let sum: f64 = strips.map(|strip| f64::from(of(&strip))).sum();
        sum * f64::from(draw.segments()) / info.sample.len() as f64
    };
    draws.iter().filter(|draw| !draw.strands.info.sample.is_empty()).map(of_section).sum()
}

/// A segment on the screen, in pixels.
struct Strip {
    delta: Vec2,
    width: f32,
    /// How many of its ends are round, in the mean.
    ends: f32,
}

impl Strip {
    /// None where it is not in the picture.
    fn new(view: &View, to_eye: Mat4, ends: [Vec3; 2], radii: [f32; 2]) -> Option<Self> {
        let lens = view.lens();
        let half = Vec2::new(view.size()[0] as f32, view.size()[1] as f32) * 0.5;
        let ends = ends.map(|end| to_eye.transform_point3(end));
        if ends.iter().any(|end| -end.z < lens.near) {
            return None;
        }
        let scales = ends.map(|end| if lens.is_perspective { -1.0 / end.z } else { 1.0 });
        // Pixels from the middle of the picture.
        let on_screen = |end: Vec3, scale: f32| {
            let moved = Vec2::new(lens.focal.x * end.x, -(lens.skew * end.x + lens.focal.y * end.y));
            lens.center - half + moved * scale
        };
        let [a, b] = [on_screen(ends[0], scales[0]), on_screen(ends[1], scales[1])];
        let visible = part_within(a, b, half)?;
        let focal = (lens.focal.x * lens.focal.y).sqrt();
        let width = radii.iter().zip(scales).map(|(radius, scale)| radius * focal * scale).sum();
        Some(Self { delta: (b - a) * visible, width, ends: 0.0 })
    }
}

/// How much of the line between two points lies within a box about the origin; none where nothing does.
fn part_within(a: Vec2, b: Vec2, half: Vec2) -> Option<f32> {
    let delta = b - a;
    let step = Vec2::select(delta.abs().cmplt(Vec2::splat(1e-6)), Vec2::splat(1e-6), delta);
    let (one, other) = ((-half - a) / step, (half - a) / step);
    let (enter, leave) = (one.min(other).max_element().max(0.0), one.max(other).min_element().min(1.0));
    (enter < leave).then_some(leave - enter)
}

/// The expected number of pixel centres within reach of a segment: its length on the screen times the width of the strip,
/// which a pixel's own extent across the strand makes wider on both sides. A round end adds half a disc, made larger by half a pixel.
fn fragments_of(strip: &Strip) -> f32 {
    let end = FRAC_PI_8 * (strip.width + 1.0) * (strip.width + 1.0);
    strip.delta.length() * strip.width + strip.delta.abs().element_sum() + strip.ends * end
}

/// The expected number of tiles with a pixel centre within reach of a segment, wherever it lies on the screen: the area of the
/// strip, made larger on all sides by the square that the pixel centres of a tile span, in tiles.
fn tiles_of(strip: &Strip) -> f32 {
    let (tile, centers) = (TILE as f32, TILE as f32 - 1.0);
    let along = strip.delta.abs();
    let [long, short] = [along.max_element(), along.min_element()];
    let length = strip.delta.length().max(1e-6);
    // Across the strand the strip reaches as far as half its width and half a pixel's own extent.
    let reach = 0.5 * (strip.width + (long + short) / length);
    // At round ends as far along it.
    let long = long + strip.ends * reach * long / length;
    let short = short + strip.ends * reach * short / length;
    let length = length + strip.ends * reach;
    let columns = long + 2.0 * reach * short / length;
    let height = 2.0 * reach * length / long.max(1e-6);
    let rows = columns * short / long.max(1e-6) + height;
    (centers * centers + centers * (columns + rows) + columns * height) / (tile * tile)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_the_picture_is_not_counted() {
        let part = |a: [f32; 2], b: [f32; 2]| part_within(a.into(), b.into(), Vec2::new(4.0, 2.0));
        assert_eq!(part([-1.0, 0.0], [3.0, 1.0]), Some(1.0));
        assert_eq!(part([0.0, 0.0], [8.0, 0.0]), Some(0.5));
        assert_eq!(part([-8.0, 1.0], [8.0, 1.0]), Some(0.5));
        assert_eq!(part([5.0, -1.0], [5.0, 1.0]), None);
        assert_eq!(part([3.0, 3.0], [6.0, 0.0]), None);
    }
}
