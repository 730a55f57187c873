//! From the world to the screen: with the whole matrix and the division by `w`, where the kernels use a lens.

use glam::{DMat4, DVec2, DVec3, DVec4};
use tressfx_core::backend::DepthOrder;
use tressfx_core::view::View;

/// The matrix of a view, and the size of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    clip: DMat4,
    order: DepthOrder,
    pub(super) size: [u32; 2],
    /// Three perpendicular unit directions; the last one leads away from the eye.
    axes: [DVec3; 3],
    /// Position of the eye and 1, or the direction towards it and 0.
    eye: DVec4,
}

/// A point before the division by `w`.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) world: DVec3,
    clip: DVec4,
}

impl Projection {
    pub(super) fn new(view: &View) -> Self {
        let clip = view.projection_matrix().as_dmat4() * view.view_matrix().as_dmat4();
        let row = |index: usize| clip.row(index).truncate();
        let is_perspective = row(3) != DVec3::ZERO;
        let forward = if is_perspective { row(3) } else { row(0).cross(row(1)) }.normalize();
        let across = forward.any_orthonormal_pair();
        // All rays meet where x, y and w are 0.
        let meeting = clip.inverse() * DVec4::Z;
        let eye = match (is_perspective, view.depth()) {
            (true, _) => meeting / meeting.w,
            (false, DepthOrder::Standard) => -meeting,
            (false, DepthOrder::Reverse) => meeting,
        };
        Self { clip, order: view.depth(), size: view.size(), axes: [across.0, across.1, forward], eye }
    }

    /// The same picture with more pixels.
    pub(super) fn finer(self, factor: u32) -> Self {
        Self { size: self.size.map(|side| side * factor), ..self }
    }

    pub(super) fn point(&self, world: DVec3) -> Point {
        Point { world, clip: self.clip * world.extend(1.0) }
    }

    /// How far a point is behind the near plane; negative where it is nearer.
    pub(super) fn behind_near(&self, point: &Point) -> f64 {
        match self.order {
            DepthOrder::Standard => point.clip.z,
            DepthOrder::Reverse => point.clip.w - point.clip.z,
        }
    }

    /// Which part of a segment, from and to, is behind the near plane.
    pub(super) fn visible(&self, ends: &[Point; 2]) -> Option<[f64; 2]> {
        let [a, b] = [self.behind_near(&ends[0]), self.behind_near(&ends[1])];
        let crossing = a / (a - b);
        match (a > 0.0, b > 0.0) {
            (true, true) => Some([0.0, 1.0]),
            (true, false) => Some([0.0, crossing]),
            (false, true) => Some([crossing, 1.0]),
            (false, false) => None,
        }
    }

    pub(super) fn pixel(&self, point: &Point) -> DVec2 {
        let ndc = point.clip.truncate().truncate() / point.clip.w;
        let size = DVec2::new(f64::from(self.size[0]), f64::from(self.size[1]));
        0.5 * size * DVec2::new(1.0 + ndc.x, 1.0 - ndc.y)
    }

    /// Half the width in pixels, along the unit direction `normal`, of a fibre that runs across it: the planes through the eye that touch the
    /// fibre do so where a step of its radius is seen as largest along `normal`.
    pub(super) fn half_width(&self, point: &Point, radius: f64, normal: DVec2) -> f64 {
        /// The share of the radius that stands for all of it, so that what is seen is linear.
        const STEP: f64 = 1e-4;
        let middle = self.pixel(point);
        let reach = self.axes.map(|axis| {
            let edge = self.point(point.world + STEP * radius * axis);
            (self.pixel(&edge) - middle).dot(normal) / STEP
        });
        DVec3::from_array(reach).length()
    }

    /// What depth interpolates with: 1 / w.
    pub(super) fn weight(point: &Point) -> f64 {
        1.0 / point.clip.w
    }

    /// Depth, turned so that more is nearer, and 0 at the far end of the range.
    pub(super) fn nearness(&self, point: &Point) -> f64 {
        self.nearness_of_depth(point.clip.z / point.clip.w)
    }

    pub(super) fn nearness_of_depth(&self, depth: f64) -> f64 {
        match self.order {
            DepthOrder::Standard => 1.0 - depth,
            DepthOrder::Reverse => depth,
        }
    }

    /// The unit direction from a point towards the eye.
    pub(super) fn towards_eye(&self, point: DVec3) -> DVec3 {
        (self.eye.truncate() - point * self.eye.w).normalize_or_zero()
    }
}
