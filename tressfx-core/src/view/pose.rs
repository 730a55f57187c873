//! Rigid poses.

use glam::{Mat3, Mat4, Quat, Vec3};

/// A rotation followed by a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation, of length 1.
    pub rotation: Quat,
    /// The translation.
    pub translation: Vec3,
}

/// Why something is no [`Pose`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// A number is NaN or infinite.
    #[error("pose: it holds numbers that are not finite")]
    NotFinite,
    /// The quaternion does not rotate alone.
    #[error("pose: a rotation of length {0}, it must be 1")]
    Length(f32),
    /// The matrix does more than to turn and to move.
    #[error("pose: the matrix scales, shears or mirrors; scale the asset instead")]
    NotRigid,
}

/// By how much a rotation may differ from one: engines multiply them for some frames before they normalise them.
const TOLERANCE: f32 = 1e-3;

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self { rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// From the matrix of an engine.
    ///
    /// # Errors
    /// If it does more than to turn and to move.
    pub fn from_matrix(matrix: Mat4) -> Result<Self, PoseError> {
        if !matrix.is_finite() {
            return Err(PoseError::NotFinite);
        }
        let turn = Mat3::from_mat4(matrix);
        let is_rigid = (turn.transpose() * turn).abs_diff_eq(Mat3::IDENTITY, TOLERANCE) && turn.determinant() > 0.0;
        let is_affine = matrix.row(3).abs_diff_eq(glam::Vec4::W, TOLERANCE);
        if !is_rigid || !is_affine {
            return Err(PoseError::NotRigid);
        }
        Ok(Self { rotation: Quat::from_mat3(&turn).normalize(), translation: matrix.w_axis.truncate() })
    }

    /// Checks that it only turns and moves.
    ///
    /// # Errors
    /// If a number is not finite, or the rotation has another length than 1.
    pub fn validate(&self) -> Result<(), PoseError> {
        if !self.rotation.is_finite() || !self.translation.is_finite() {
            return Err(PoseError::NotFinite);
        }
        let length = self.rotation.length();
        if (length - 1.0).abs() > TOLERANCE { Err(PoseError::Length(length)) } else { Ok(()) }
    }

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
    fn a_pose_after_its_inverse_is_the_identity() {
        let pose = Pose { rotation: Quat::from_rotation_y(0.7), translation: Vec3::new(1.0, -2.0, 3.0) };
        let point = Vec3::new(0.3, 0.2, 0.1);
        assert!(pose.after(&pose.inverse()).transform(point).distance(point) < 1e-6);
        assert!(pose.matrix().transform_point3(point).distance(pose.transform(point)) < 1e-6);
    }

    #[test]
    fn what_does_not_only_turn_and_move_is_refused() {
        let pose = Pose { rotation: Quat::from_rotation_y(0.7), translation: Vec3::new(1.0, -2.0, 3.0) };
        let back = Pose::from_matrix(pose.matrix()).unwrap();
        assert!(back.rotation.angle_between(pose.rotation) < 1e-3 && back.translation == pose.translation);
        let after = |scale: Vec3| Pose::from_matrix(pose.matrix() * Mat4::from_scale(scale)).unwrap_err();
        assert_eq!(after(Vec3::splat(1.01)), PoseError::NotRigid);
        assert_eq!(after(Vec3::new(-1.0, 1.0, 1.0)), PoseError::NotRigid);
        assert_eq!(after(Vec3::splat(f32::NAN)), PoseError::NotFinite);
        let perspective = glam::camera::rh::proj::directx::perspective(1.0, 1.0, 0.1, 1.0);
        assert_eq!(Pose::from_matrix(perspective).unwrap_err(), PoseError::NotRigid);
        pose.validate().unwrap();
        assert_eq!(Pose { rotation: pose.rotation * 2.0, ..pose }.validate(), Err(PoseError::Length(2.0)));
        assert_eq!(
            Pose { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..pose }.validate(),
            Err(PoseError::Length(0.0))
        );
        assert_eq!(Pose { translation: Vec3::NAN, ..pose }.validate(), Err(PoseError::NotFinite));
    }
}
