//! Rotations, and directions that stay finite: `shaders/vector.wgsl`.

use glam::{DVec3, Vec4};

use crate::step::Step;

/// Below this squared length a vector has no direction.
pub(super) const NO_LENGTH: f64 = 1e-24;

/// Applies a rotation as the kernels do, without assuming that the quaternion has a length of exactly 1.
pub(super) fn rotate(rotation: Vec4, v: DVec3) -> DVec3 {
    let axis = rotation.truncate().as_dvec3();
    let t = 2.0 * axis.cross(v);
    v + f64::from(rotation.w) * t + axis.cross(t)
}

pub(super) fn rotate_back(rotation: Vec4, v: DVec3) -> DVec3 {
    rotate(Vec4::new(-rotation.x, -rotation.y, -rotation.z, rotation.w), v)
}

pub(super) fn direction_or(v: DVec3, otherwise: DVec3) -> DVec3 {
    let squared = v.length_squared();
    if squared > NO_LENGTH { v / squared.sqrt() } else { otherwise }
}

pub(super) fn across(u: DVec3) -> DVec3 {
    u.cross(if u.x.abs() > 0.6 { DVec3::Y } else { DVec3::X }).normalize()
}

/// The smallest rotation that takes `u` to `v`, applied to `w`.
pub(super) fn turn(u: DVec3, v: DVec3, w: DVec3) -> DVec3 {
    let c = u.dot(v);
    if c < -0.999999 {
        let axis = across(u);
        return 2.0 * axis.dot(w) * axis - w;
    }
    let a = u.cross(v);
    c * w + a.cross(w) + a * (a.dot(w) / (1.0 + c))
}

impl Step {
    /// A point of the rest pose, carried by the head.
    pub(super) fn in_world(&self, point: DVec3) -> DVec3 {
        rotate(self.head_rotation, point) + self.head_translation.as_dvec3()
    }

    /// A point of the world, in the space of the rest pose.
    pub(super) fn in_head(&self, point: DVec3) -> DVec3 {
        rotate_back(self.head_rotation, point - self.head_translation.as_dvec3())
    }

    /// A point as the head's motion during the sub-step moves it.
    pub(super) fn carry(&self, point: DVec3) -> DVec3 {
        rotate(self.motion_rotation, point) + self.motion_translation.as_dvec3()
    }
}

/// The position of a vertex of the rest pose.
pub(super) fn position(vertex: Vec4) -> DVec3 {
    vertex.truncate().as_dvec3()
}
