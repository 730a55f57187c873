//! Rotations, and directions that stay finite: `shaders/vector.wgsl`.

use glam::{DQuat, DVec3, DVec4, Vec4};

use crate::step::Step;

/// Below this squared length a vector has no direction.
pub(super) const NO_LENGTH: f64 = 1e-24;
/// The direction of an edge that has none.
pub(super) const DOWN: DVec3 = DVec3::NEG_Y;

/// Applies a rotation as the kernels do, without assuming that the quaternion has a length of exactly 1.
pub(super) fn rotate(rotation: DVec4, v: DVec3) -> DVec3 {
    let axis = rotation.truncate();
    let t = 2.0 * axis.cross(v);
    v + rotation.w * t + axis.cross(t)
}

pub(super) fn rotate_back(rotation: DVec4, v: DVec3) -> DVec3 {
    rotate((-rotation.truncate()).extend(rotation.w), v)
}

pub(super) fn direction_or(v: DVec3, otherwise: DVec3) -> DVec3 {
    let squared = v.length_squared();
    if squared > NO_LENGTH { v / squared.sqrt() } else { otherwise }
}

pub(super) fn across(u: DVec3) -> DVec3 {
    u.cross(if u.x.abs() > 0.6 { DVec3::Y } else { DVec3::X }).normalize()
}

/// The smallest rotation that takes the unit vector `u` to the unit vector `v`, after `rotation`.
pub(super) fn turned(rotation: DVec4, u: DVec3, v: DVec3) -> DVec4 {
    let c = 1.0 + u.dot(v);
    let arc = if c < 1e-6 { across(u).extend(0.0) } else { u.cross(v).extend(c) };
    let product = DQuat::from_vec4(arc) * DQuat::from_vec4(rotation);
    DVec4::from(product).normalize()
}

impl Step {
    /// A point of the rest pose, turned by the head.
    pub(super) fn in_world(&self, point: DVec3) -> DVec3 {
        rotate(self.head_rotation.as_dvec4(), point)
    }

    /// A point of the world, as the head sees it.
    pub(super) fn in_head(&self, point: DVec3) -> DVec3 {
        rotate_back(self.head_rotation.as_dvec4(), point)
    }

    /// Where the head's motion during the sub-step took a point from.
    pub(super) fn carried_from(&self, point: DVec3) -> DVec3 {
        rotate_back(self.head_turn.as_dvec4(), point) - self.center_displacement.as_dvec3()
    }
}

/// The position of a vertex of the rest pose.
pub(super) fn position(vertex: Vec4) -> DVec3 {
    vertex.truncate().as_dvec3()
}
