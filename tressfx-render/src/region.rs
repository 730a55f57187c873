//! Where in a picture hair may be: what lies outside is neither cleared nor resolved.

use glam::{DVec2, DVec3};
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::view::{Lens, View};

use crate::reach::{Ball, MARGIN};
use crate::resolved::TILE;

/// A rectangle of tiles of a view, at least one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Region {
    /// Pixels of the view.
    size: [u32; 2],
    /// Columns and rows of tiles before it.
    pub(crate) first: [u32; 2],
    /// Columns and rows of tiles of it.
    tiles: [u32; 2],
}

impl Region {
    /// The tiles in which a view may see any of these.
    pub(crate) fn of(view: &View, balls: impl Iterator<Item = Ball>) -> Self {
        let lens = view.lens();
        let around = balls.map(|ball| seen(lens, &ball)).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let [low, high] = around.unwrap_or_default();
        let size = view.size();
        let of_axis = |axis: usize| {
            let last = size[axis].div_ceil(TILE).saturating_sub(1);
            let tile = |at: f64| (at / f64::from(TILE)).clamp(0.0, f64::from(last)) as u32;
            let (first, end) = (tile(low[axis] - MARGIN), tile(high[axis] + MARGIN));
            (first, end - first.min(end) + 1)
        };
        let [columns, rows] = [0, 1].map(of_axis);
        Self { size, first: [columns.0, rows.0], tiles: [columns.1, rows.1] }
    }

    /// One group a tile.
    pub(crate) fn grid(&self) -> Grid {
        Grid([self.tiles[0], self.tiles[1], 1])
    }

    /// Empties the rows with such pixels of a buffer with so many bytes a pixel, row by row.
    pub(crate) fn clear(&self, list: &mut PassList, buffer: BufferId, pixel_bytes: u64) {
        let end = (TILE * (self.first[1] + self.tiles[1])).min(self.size[1]);
        let row = pixel_bytes * u64::from(self.size[0]);
        let [first, end] = [TILE * self.first[1], end].map(|rows| row * u64::from(rows));
        list.clear(buffer, first, end - first);
    }

    /// Empties the rows with such tiles of a buffer with so many bytes a tile, row by row.
    pub(crate) fn clear_tiles(&self, list: &mut PassList, buffer: BufferId, tile_bytes: u64) {
        let row = tile_bytes * u64::from(self.size[0].div_ceil(TILE));
        list.clear(buffer, row * u64::from(self.first[1]), row * u64::from(self.tiles[1]));
    }
}

/// The smallest and the largest slope of a ray from the eye that meets a ball, so far to the side and ahead.
fn slopes(aside: f64, ahead: f64, radius: f64) -> [f64; 2] {
    let square = (ahead - radius) * (ahead + radius);
    let root = radius * (aside * aside + square).sqrt();
    [-root, root].map(|root| (aside * ahead + root) / square)
}

/// The corners of the pixels in which a ball may be seen, which may be any.
fn seen(lens: &Lens, ball: &Ball) -> [DVec2; 2] {
    let middle: DVec3 = lens.to_eye.as_dmat4().transform_point3(ball.center.as_dvec3());
    let (radius, ahead) = (f64::from(ball.radius), -middle.z);
    let is_ahead = ahead - radius > f64::from(lens.near).max(0.0);
    // What is no number is not known to be outside, and must not be lost among other balls.
    let is_known = middle.is_finite() && radius.is_finite() && (is_ahead || !lens.is_perspective);
    if !is_known {
        return [DVec2::NEG_INFINITY, DVec2::INFINITY];
    }
    let of_axis = |aside: f64| {
        if lens.is_perspective { slopes(aside, ahead, radius) } else { [aside - radius, aside + radius] }
    };
    let (focal, center) = (lens.focal.as_dvec2(), lens.center.as_dvec2());
    let scaled = |by: f64, [low, high]: [f64; 2]| [(by * low).min(by * high), (by * low).max(by * high)];
    let (x, y) = (of_axis(middle.x), of_axis(middle.y));
    let right = scaled(focal.x, x);
    let [sheared, up] = [scaled(-f64::from(lens.skew), x), scaled(-focal.y, y)];
    [0, 1].map(|i| center + DVec2::new(right[i], sheared[i] + up[i]))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use glam::camera::rh;
    use tressfx_core::backend::DepthOrder;
    use tressfx_core::hash::hash;
    use tressfx_core::view::Camera;

    use super::*;

    const SIZE: [u32; 2] = [1000, 600];

    fn random(place: u32) -> f32 {
        2.0 * hash(place) as f32 - 1.0
    }

    fn perspective() -> View {
        let (eye, target) = (Vec3::new(1.0, 2.0, 8.0), Vec3::ZERO);
        Camera { eye, target, fov: 0.7, near: 0.1, far: 100.0, depth: DepthOrder::Reverse }.view(SIZE).unwrap()
    }

    fn orthographic() -> View {
        let to_eye = rh::view::look_at_mat4(Vec3::new(3.0, -1.0, 8.0), Vec3::ZERO, Vec3::Y);
        let projection = rh::proj::directx::orthographic(-4.0, 4.0, -2.4, 2.4, 0.1, 100.0);
        View::new(to_eye, projection, DepthOrder::Standard, SIZE).unwrap()
    }

    fn pixel_of(lens: &Lens, point: Vec3) -> DVec2 {
        let at = lens.to_eye.as_dmat4().transform_point3(point.as_dvec3());
        let w = if lens.is_perspective { -at.z } else { 1.0 };
        let (focal, skew) = (lens.focal.as_dvec2(), f64::from(lens.skew));
        lens.center.as_dvec2() + DVec2::new(focal.x * at.x, -(skew * at.x + focal.y * at.y)) / w
    }

    #[test]
    fn no_point_of_a_ball_is_seen_outside_and_some_are_seen_at_each_side() {
        for view in [perspective(), orthographic()] {
            let lens = view.lens();
            for trial in 0..200 {
                let at = |i: u32| random(5000 * trial + i);
                let ball = Ball { center: 2.0 * Vec3::new(at(0), at(1), at(2)), radius: 0.2 + 0.15 * at(3) };
                let [low, high] = seen(lens, &ball);
                let points = (0..1500).map(|i| Vec3::new(at(4 + 3 * i), at(5 + 3 * i), at(6 + 3 * i)));
                let pixels = points.map(|way| pixel_of(lens, ball.center + ball.radius * way.normalize_or(Vec3::X)));
                let nothing = [DVec2::INFINITY, DVec2::NEG_INFINITY];
                let found = pixels.fold(nothing, |[low, high], at| [low.min(at), high.max(at)]);
                let slack = 0.02 * (high - low);
                assert!(found[0].cmpge(low - 1e-6).all() && found[1].cmple(high + 1e-6).all(), "{ball:?}");
                assert!(found[0].cmple(low + slack).all() && found[1].cmpge(high - slack).all(), "{ball:?}");
            }
        }
    }

    #[test]
    fn all_tiles_are_taken_where_a_ball_has_no_end_or_the_eye_is_in_it() {
        let all = Region { size: SIZE, first: [0, 0], tiles: [125, 75] };
        let ball = |center: Vec3, radius: f32| Ball { center, radius };
        let [small, around_the_eye] = [ball(Vec3::ZERO, 0.1), ball(Vec3::new(1.0, 2.0, 8.2), 0.5)];
        let endless = [ball(Vec3::ZERO, f32::INFINITY), ball(Vec3::NAN, 1.0)];
        let of_both = endless.into_iter().flat_map(|ball| [(perspective(), ball), (orthographic(), ball)]);
        for (view, ball) in of_both.chain([(perspective(), around_the_eye)]) {
            for balls in [[ball, small], [small, ball]] {
                assert_eq!(Region::of(&view, balls.into_iter()), all, "{balls:?}");
            }
        }
    }

    #[test]
    fn a_small_ball_takes_few_tiles_and_two_take_what_lies_between() {
        let view = orthographic();
        let small = |x: f32| Ball { center: Vec3::new(x, 0.0, 0.0), radius: 0.01 };
        let one = Region::of(&view, [small(0.0)].into_iter());
        assert!(one.tiles[0] <= 3 && one.tiles[1] <= 3, "{one:?}");
        let two = Region::of(&view, [small(0.0), small(1.0)].into_iter());
        assert!(two.tiles[0] > 10 && two.tiles[1] < 10, "{two:?}");
        let outside = Region::of(&view, [small(100.0)].into_iter());
        assert_eq!((outside.first[0], outside.tiles[0]), (124, 1), "at least one column");
    }
}
