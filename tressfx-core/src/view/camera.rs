//! A camera that looks at something.

use glam::camera::rh;
use glam::{Mat4, Vec2, Vec3};

use super::{Lens, View, ViewError, Viewport};
use crate::backend::DepthOrder;
use crate::strands::Bounds;

/// An eye that looks at a target, upright, with square pixels: one way to a [`View`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Vertical angle of view in radians, between 0 and pi.
    pub fov: f32,
    /// Distance of the near plane, in the unit of the scene.
    pub near: f32,
    /// Distance of the far plane, which may be infinite.
    pub far: f32,
    /// Which end of the depth range is near.
    pub depth: DepthOrder,
}

impl Camera {
    /// World to view. Looking straight up or down is fine.
    pub fn view_matrix(&self) -> Mat4 {
        let forward = (self.target - self.eye).normalize_or(Vec3::NEG_Z);
        let up = if forward.y.abs() > 0.9999 { Vec3::Z } else { Vec3::Y };
        rh::view::look_to_mat4(self.eye, forward, up)
    }

    /// View to clip for a picture of this size.
    pub fn projection_matrix(&self, size: [u32; 2]) -> Mat4 {
        use rh::proj::directx::{perspective, perspective_infinite, perspective_infinite_reverse};
        let aspect = size[0] as f32 / size[1].max(1) as f32;
        match (self.depth, self.far.is_finite()) {
            (DepthOrder::Standard, true) => perspective(self.fov, aspect, self.near, self.far),
            (DepthOrder::Reverse, true) => perspective(self.fov, aspect, self.far, self.near),
            (DepthOrder::Standard, false) => perspective_infinite(self.fov, aspect, self.near),
            (DepthOrder::Reverse, false) => perspective_infinite_reverse(self.fov, aspect, self.near),
        }
    }

    /// What it sees.
    ///
    /// # Errors
    /// [`ViewError`] if its angle or its planes make no picture.
    pub fn view(&self, viewport: impl Into<Viewport>) -> Result<View, ViewError> {
        let viewport = viewport.into();
        let projection = self.projection_matrix(viewport.size());
        let view = View::new(self.view_matrix(), projection, self.depth, viewport)?;
        if view.is_empty() {
            return Ok(view);
        }
        // What the camera is made from is nearer to the truth than what can be got back out of rounded matrices.
        let size = Vec2::new(viewport.size()[0] as f32, viewport.size()[1] as f32);
        let lens = Lens {
            to_eye: view.view,
            eye: self.eye.extend(1.0),
            center: 0.5 * size,
            focal: Vec2::splat(1.0 / (2.0 * (self.fov * 0.5).tan() / size.y)),
            skew: 0.0,
            near: self.near,
            ..view.lens
        };
        Ok(View { lens, ..view })
    }

    /// A camera that has the points in most of its picture: slightly from above, from the front or, where they extend much
    /// further from front to back than from side to side, from the side.
    pub fn around(points: &[Vec3], size: [u32; 2]) -> Self {
        let fov = 30f32.to_radians();
        let bounds = Bounds::of(points.iter().copied());
        let extent = bounds.max - bounds.min;
        let (center, radius) = (bounds.center(), bounds.radius().max(1e-6));
        let is_deep = extent.z > 1.5 * extent.x;
        let direction = if is_deep { Vec3::new(1.0, 0.12, 0.35) } else { Vec3::new(0.35, 0.12, 1.0) }.normalize();
        let aspect = size[0] as f32 / size[1].max(1) as f32;
        let half = Vec2::new(aspect, 1.0) * (fov * 0.5).tan() * Self::FILLED;
        let to_view = rh::view::look_to_mat4(Vec3::ZERO, -direction, Vec3::Y);
        // Each point must be so far away that it lies within the picture on both axes.
        let distances = points.iter().map(|&point| {
            let point = to_view.transform_point3(point - center);
            point.z + (point.truncate().abs() / half).max_element()
        });
        let distance = distances.fold(radius * 0.5, f32::max);
        Self {
            eye: center + direction * distance,
            target: center,
            fov,
            near: distance * 0.01,
            far: (distance + radius) * 10.0,
            depth: DepthOrder::Reverse,
        }
    }

    /// The share of the picture's half width or height that [`Camera::around`] fills.
    const FILLED: f32 = 0.88;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_and_far_map_to_the_ends_of_the_depth_range() {
        for depth in [DepthOrder::Standard, DepthOrder::Reverse] {
            for far in [40.0, f32::INFINITY] {
                let camera = Camera { depth, far, ..Camera::around(&[Vec3::NEG_ONE, Vec3::ONE], [640, 480]) };
                let view = camera.view([640, 480]).unwrap();
                let forward = (camera.target - camera.eye).normalize();
                let project = |distance: f32| view.view_projection().project_point3(camera.eye + forward * distance).z;
                let distant = if far.is_finite() { far } else { 1e6 };
                assert!((project(distant) - depth.far()).abs() < 1e-4, "{depth:?} {far}");
                assert!((project(camera.near) - (1.0 - depth.far())).abs() < 1e-4, "{depth:?} {far}");
            }
        }
    }

    #[test]
    fn the_lens_of_a_camera_is_that_of_its_matrices() {
        for depth in [DepthOrder::Standard, DepthOrder::Reverse] {
            let points = [Vec3::new(3.0, 1.0, -2.0), Vec3::new(4.0, 2.5, -1.0)];
            let camera = Camera { depth, ..Camera::around(&points, [640, 270]) };
            let view = camera.view([640, 270]).unwrap();
            let of_camera = view.lens();
            let derived = View::new(view.view_matrix(), view.projection_matrix(), depth, [640, 270]).unwrap();
            let derived = derived.lens();
            assert!(of_camera.to_eye.abs_diff_eq(derived.to_eye, 1e-5));
            assert!(of_camera.eye.abs_diff_eq(derived.eye, 1e-5));
            assert!(of_camera.center.abs_diff_eq(derived.center, 1e-4));
            assert!((of_camera.focal / derived.focal).abs_diff_eq(Vec2::ONE, 1e-6));
            assert!((of_camera.near / derived.near - 1.0).abs() < 1e-4);
            assert_eq!(of_camera.depth_offset, derived.depth_offset);
            assert_eq!(of_camera.depth_scale, derived.depth_scale);
            assert!(of_camera.even_focal().is_some() && derived.even_focal().is_some());
        }
    }

    #[test]
    fn points_fill_the_picture_and_stay_inside() {
        let ball = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        for points in [&ball[..], &[Vec3::ZERO, Vec3::Y * 5.0], &[Vec3::ZERO, Vec3::new(0.1, 1.0, 7.0)]] {
            for size in [[1280, 720], [200, 900]] {
                let matrix = Camera::around(points, size).view(size).unwrap().view_projection();
                let reach = points.iter().map(|&point| matrix.project_point3(point).truncate().abs().max_element());
                let reach = reach.fold(0.0, f32::max);
                assert!((reach - Camera::FILLED).abs() < 1e-3, "{reach}");
            }
        }
    }
}
