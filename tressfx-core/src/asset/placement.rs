//! Where the header of a file puts its points.

use glam::{DAffine3, DMat3, DVec3};

/// The placement that the header of a text 2.0 file asks for: scaled first, then turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Uniform factor.
    pub scale: f32,
    /// Degrees about x, then about y, then about z.
    pub rotation: [f32; 3],
    /// In the unit of the scaled points.
    pub translation: [f32; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Self { scale: 1.0, rotation: [0.0; 3], translation: [0.0; 3] }
    }
}

impl Placement {
    /// True where [`Placement::apply`] would change no point.
    pub fn is_identity(&self) -> bool {
        *self == Self::default()
    }

    fn affine(&self) -> DAffine3 {
        let [x, y, z] = self.rotation.map(|degrees| f64::from(degrees).to_radians());
        let rotation = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
        let translation = DVec3::from_array(self.translation.map(f64::from));
        DAffine3::from_mat3_translation(rotation * f64::from(self.scale), translation)
    }

    /// The placed points. Computed in f64, so that a large translation costs no precision before the last rounding.
    pub fn apply(&self, points: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let affine = self.affine();
        points
            .iter()
            .map(|p| affine.transform_point3(DVec3::from_array(p.map(f64::from))).as_vec3().to_array())
            .collect()
    }
}
