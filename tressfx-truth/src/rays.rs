//! Rays through the points of the picture.

use glam::{DMat4, DVec2, DVec3, Vec2};
use tressfx_core::view::{Lens, View};

/// A ray in the space of the eye: x right, y up, z the distance from the plane of the eye. The point at the parameter `s` is
/// `origin + s * direction`; on a ray through the picture `s` is its z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl Ray {
    pub(crate) fn at(&self, s: f64) -> DVec3 {
        self.origin + s * self.direction
    }
}

/// The lens of a view in f64.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rays {
    lens: Lens,
    to_eye: DMat4,
    /// Distance at which all rays begin.
    pub(crate) near: f64,
    /// The most pixels that a unit length at w 1 can be on the picture, in any direction.
    pub(crate) scale: f64,
}

impl Rays {
    pub(crate) fn new(view: &View) -> Self {
        let lens = *view.lens();
        let ahead = DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0));
        // The Frobenius norm is not below the spectral norm.
        let Vec2 { x, y } = lens.focal;
        let scale = [x, y, lens.skew].iter().map(|&part| f64::from(part).powi(2)).sum::<f64>().sqrt();
        let scale = if let Some(focal) = lens.even_focal() { f64::from(focal) * (1.0 + 1e-5) } else { scale };
        Self { lens, to_eye: ahead * lens.to_eye.as_dmat4(), near: f64::from(lens.near), scale }
    }

    pub(crate) fn is_perspective(&self) -> bool {
        self.lens.is_perspective
    }

    /// A point of the world in the space of the eye.
    pub(crate) fn in_eye_space(&self, point: DVec3) -> DVec3 {
        self.to_eye.transform_point3(point)
    }

    /// A direction of the world in the space of the eye, as long as it was.
    pub(crate) fn turned(&self, direction: DVec3) -> DVec3 {
        self.to_eye.transform_vector3(direction)
    }

    /// The ray through a point of the picture, in pixels from the upper left corner.
    pub(crate) fn through(&self, at: DVec2) -> Ray {
        let [center, focal] = [self.lens.center, self.lens.focal].map(|v| v.as_dvec2());
        let x = (at.x - center.x) / focal.x;
        let y = -(at.y - center.y + f64::from(self.lens.skew) * x) / focal.y;
        if self.lens.is_perspective {
            Ray { origin: DVec3::ZERO, direction: DVec3::new(x, y, 1.0) }
        } else {
            Ray { origin: DVec3::new(x, y, 0.0), direction: DVec3::Z }
        }
    }

    /// The pixel of a point whose x and y were divided by w.
    pub(crate) fn pixel(&self, across: DVec2) -> DVec2 {
        let [center, focal] = [self.lens.center, self.lens.focal].map(|v| v.as_dvec2());
        center + DVec2::new(focal.x * across.x, -(f64::from(self.lens.skew) * across.x + focal.y * across.y))
    }

    /// The distance that a depth of the scene stands for; infinite where there is nothing.
    pub(crate) fn distance(&self, depth: f32) -> f64 {
        let nearness = (f64::from(depth) - f64::from(self.lens.depth_offset)) * f64::from(self.lens.depth_scale);
        if !self.lens.is_perspective {
            (1.0 - nearness) / f64::from(self.lens.nearness_slope)
        } else if nearness > 0.0 {
            1.0 / nearness
        } else {
            f64::INFINITY
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::camera::rh;
    use glam::{Mat4, Vec3};
    use tressfx_core::backend::DepthOrder;

    use super::*;

    #[test]
    fn a_ray_goes_through_all_points_that_the_matrices_put_on_its_pixel() {
        let size = [320, 200];
        let turned = Mat4::from_rotation_z(0.7) * rh::view::look_at_mat4(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, Vec3::Y);
        let sheared = turned * Mat4::from_scale(Vec3::new(1.0, 1.5, 0.8));
        use rh::proj::directx::{frustum, orthographic, perspective};
        let cases = [
            (turned, perspective(0.9, 1.6, 50.0, 0.1), DepthOrder::Reverse),
            (sheared, perspective(0.9, 1.6, 0.1, 50.0), DepthOrder::Standard),
            (turned, frustum(-0.02, 0.09, -0.03, 0.05, 0.1, 50.0), DepthOrder::Standard),
            (turned, orthographic(-2.0, 1.0, -1.5, 2.5, 50.0, 0.1), DepthOrder::Reverse),
        ];
        for (view, projection, depth) in cases {
            let view = View::new(view, projection, depth, size).unwrap();
            let rays = Rays::new(&view);
            let matrix = projection.as_dmat4() * view.view_matrix().as_dmat4();
            for i in 0..27 {
                let part = |by: i32| f64::from(i / by % 3) / 2.0;
                let ndc = DVec3::new(1.6 * part(1) - 0.8, 1.6 * part(3) - 0.8, 0.1 + 0.8 * part(9));
                let point = rays.in_eye_space(matrix.inverse().project_point3(ndc));
                let at = DVec2::new(1.0 + ndc.x, 1.0 - ndc.y) * 0.5 * DVec2::new(320.0, 200.0);
                let ray = rays.through(at);
                let miss = ray.at(point.z).distance(point) / point.z;
                assert!(miss < 1e-4, "{ndc}: {miss}");
                let distance = rays.distance(ndc.z as f32);
                assert!((distance / point.z - 1.0).abs() < 1e-3, "{ndc}: {distance} is not {}", point.z);
                let across = if rays.is_perspective() { point.truncate() / point.z } else { point.truncate() };
                assert!(rays.pixel(across).distance(at) < 2e-2, "{ndc}");
            }
        }
    }
}
