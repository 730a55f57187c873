//! Where a picture is taken from, and rigid poses.

use glam::camera::rh;
use glam::{Mat4, Quat, Vec2, Vec3};

use crate::backend::DepthOrder;
use crate::strands::Bounds;

/// A camera, right-handed, y up, looking along -z; clip space as in WebGPU: y up, z from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the eye is.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Vertical angle of view in radians, between 0 and pi.
    pub fov: f32,
    /// Distance of the near plane, in the unit of the scene.
    pub near: f32,
    /// Distance of the far plane.
    pub far: f32,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Which end of the depth range is near.
    pub depth: DepthOrder,
}

impl View {
    /// World to view. Looking straight up or down is fine.
    pub fn view_matrix(&self) -> Mat4 {
        let forward = (self.target - self.eye).normalize_or(Vec3::NEG_Z);
        let up = if forward.y.abs() > 0.9999 { Vec3::Z } else { Vec3::Y };
        rh::view::look_to_mat4(self.eye, forward, up)
    }

    /// View to clip; columns, applied from the left.
    pub fn projection_matrix(&self) -> Mat4 {
        let aspect = self.size[0] as f32 / self.size[1].max(1) as f32;
        match self.depth {
            DepthOrder::Standard => rh::proj::directx::perspective(self.fov, aspect, self.near, self.far),
            DepthOrder::Reverse => rh::proj::directx::perspective(self.fov, aspect, self.far, self.near),
        }
    }

    /// World to clip.
    pub fn view_projection(&self) -> Mat4 {
        self.projection_matrix() * self.view_matrix()
    }

    /// Size of a pixel, in the unit of the scene, at distance 1.
    pub fn pixel_angle(&self) -> f32 {
        2.0 * (self.fov * 0.5).tan() / self.size[1].max(1) as f32
    }

    /// A view in which points fill most of the picture: slightly from above, from the front or, where they extend much
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
            size,
            depth: DepthOrder::Reverse,
        }
    }

    /// The share of the picture's half width or height that [`View::around`] fills.
    const FILLED: f32 = 0.88;
}

/// A rotation followed by a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation, of length 1.
    pub rotation: Quat,
    /// The translation.
    pub translation: Vec3,
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self { rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// Moves a point.
    pub fn transform(&self, point: Vec3) -> Vec3 {
        self.rotation * point + self.translation
    }

    /// The pose that undoes this one.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: rotation * -self.translation }
    }

    /// This pose after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Self { rotation: (self.rotation * first.rotation).normalize(), translation: self.transform(first.translation) }
    }

    /// From `self` at 0 to `other` at 1.
    pub fn interpolate(&self, other: &Self, t: f32) -> Self {
        Self {
            rotation: self.rotation.slerp(other.rotation, t),
            translation: self.translation.lerp(other.translation, t),
        }
    }

    /// As a matrix.
    pub fn matrix(&self) -> Mat4 {
        Mat4::from_rotation_translation(self.rotation, self.translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_and_far_map_to_the_ends_of_the_depth_range() {
        for depth in [DepthOrder::Standard, DepthOrder::Reverse] {
            let view = View { depth, ..View::around(&[Vec3::NEG_ONE, Vec3::ONE], [640, 480]) };
            let forward = (view.target - view.eye).normalize();
            let project = |distance: f32| view.view_projection().project_point3(view.eye + forward * distance).z;
            assert!((project(view.far) - depth.far()).abs() < 1e-4, "{depth:?}");
            assert!((project(view.near) - (1.0 - depth.far())).abs() < 1e-4, "{depth:?}");
        }
    }

    #[test]
    fn points_fill_the_picture_and_stay_inside() {
        let ball = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        for points in [&ball[..], &[Vec3::ZERO, Vec3::Y * 5.0], &[Vec3::ZERO, Vec3::new(0.1, 1.0, 7.0)]] {
            for size in [[1280, 720], [200, 900]] {
                let matrix = View::around(points, size).view_projection();
                let reach = points.iter().map(|&point| matrix.project_point3(point).truncate().abs().max_element());
                let reach = reach.fold(0.0, f32::max);
                assert!((reach - View::FILLED).abs() < 1e-3, "{reach}");
            }
        }
    }

    #[test]
    fn a_pose_after_its_inverse_is_the_identity() {
        let pose = Pose { rotation: Quat::from_rotation_y(0.7), translation: Vec3::new(1.0, -2.0, 3.0) };
        let point = Vec3::new(0.3, 0.2, 0.1);
        assert!(pose.after(&pose.inverse()).transform(point).distance(point) < 1e-6);
        assert!(pose.matrix().transform_point3(point).distance(pose.transform(point)) < 1e-6);
    }
}
