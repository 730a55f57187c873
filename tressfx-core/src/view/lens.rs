//! What the matrices of a view do, taken apart.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, Mat4, Vec2, Vec4};

use super::ViewError;
use crate::backend::DepthOrder;

/// A view and its projection as kernels use them: a rigid motion, and a lens.
///
/// The eye looks along -z of its space. A point at the distance `d` from the plane of the eye falls on the pixel
/// `center + (focal.x * x, -(skew * x + focal.y * y)) / w` where `w` is `d` in a perspective and 1 in an orthographic view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Lens {
    /// World to the space of the eye; it turns, moves and may mirror.
    pub to_eye: Mat4,
    /// Position of the eye and 1, or the direction towards it and 0 where it is infinitely far.
    pub eye: Vec4,
    /// The pixel that the eye looks at, in pixels from the upper left corner of the viewport.
    pub center: Vec2,
    /// Pixels of a unit length at `w` 1, to the right and up.
    pub focal: Vec2,
    /// Pixels by which a unit length to the right leads up at `w` 1: 0 but where the matrices shear.
    pub skew: f32,
    /// Whether `w` is the distance.
    pub is_perspective: bool,
    /// Distance of the near plane.
    pub near: f32,
    /// In an orthographic view the nearness is 1 at the near plane and falls by this much with each unit of distance. In a
    /// perspective it is 1 / distance.
    pub nearness_slope: f32,
    /// The depth `z` stands for the nearness `(z - depth_offset) * depth_scale`.
    pub depth_offset: f32,
    /// See `depth_offset`.
    pub depth_scale: f32,
}

/// By how much depth may differ across a plane that faces the eye, for the rounding of matrices.
const DEPTH_TOLERANCE: f64 = 1e-5;

/// Sine of the angle between axes below which space is flattened.
const FLAT: f64 = 1e-7;

/// Rows of a matrix, as functions of the position: a direction and a constant.
struct Rows {
    x: DVec4,
    y: DVec4,
    z: DVec4,
    w: DVec4,
}

impl Lens {
    pub(super) fn new(view: Mat4, projection: Mat4, depth: DepthOrder, size: [u32; 2]) -> Result<Self, ViewError> {
        if !view.is_finite() || !projection.is_finite() {
            return Err(ViewError::NotFinite);
        }
        let clip = projection.as_dmat4() * view.as_dmat4();
        let is_perspective = clip.row(3).truncate() != DVec3::ZERO;
        // All of clip space can be scaled at will; this scale makes `w` a distance, or 1.
        let scale = if is_perspective { clip.row(3).truncate().length() } else { clip.row(3).w };
        let row = |index: usize| clip.row(index) / scale;
        let rows = Rows { x: row(0), y: row(1), z: row(2), w: row(3) };
        let lens = if is_perspective { rows.perspective(depth, size) } else { rows.orthographic(depth, size) }?;
        if lens.is_finite() { Ok(lens) } else { Err(ViewError::NotFinite) }
    }

    fn is_finite(&self) -> bool {
        let rest = [self.skew, self.near, self.nearness_slope, self.depth_offset, self.depth_scale];
        self.to_eye.is_finite()
            && self.eye.is_finite()
            && self.center.is_finite()
            && self.focal.is_finite()
            && rest.iter().all(|x| x.is_finite())
    }

    /// The focal length in pixels if it is the same in all directions, up to rounding.
    pub fn even_focal(&self) -> Option<f32> {
        let allowed = 1e-6 * self.focal.x;
        let is_even = (self.focal.x - self.focal.y).abs() <= allowed && self.skew.abs() <= allowed;
        is_even.then_some(self.focal.x)
    }
}

impl Rows {
    fn perspective(&self, depth: DepthOrder, size: [u32; 2]) -> Result<Lens, ViewError> {
        let forward = self.w.truncate();
        let eye = meeting_point([self.x, self.y, self.w])?;
        // What of each row does not grow with the distance.
        let [of_x, of_y, of_z] = [self.x, self.y, self.z].map(|row| row.truncate().dot(forward));
        let across_z = self.z.truncate() - of_z * forward;
        let constant = self.z.truncate().dot(eye) + self.z.w;
        if across_z.length() > DEPTH_TOLERANCE {
            return Err(ViewError::Depth);
        }
        if constant == 0.0 {
            return Err(ViewError::Singular);
        }
        if (constant > 0.0) != (depth == DepthOrder::Reverse) {
            return Err(ViewError::Order(depth));
        }
        let near = constant / (1.0 - f64::from(depth.far()) - of_z);
        if !(near > 0.0 && near.is_finite()) {
            return Err(ViewError::Near(near));
        }
        let across = [self.x.truncate() - of_x * forward, self.y.truncate() - of_y * forward];
        Ok(Lens {
            eye: eye.extend(1.0).as_vec4(),
            is_perspective: true,
            near: near as f32,
            depth_offset: of_z as f32,
            depth_scale: (1.0 / constant) as f32,
            ..on_pixels(across, DVec2::new(of_x, of_y), forward, eye, size)
        })
    }

    fn orthographic(&self, depth: DepthOrder, size: [u32; 2]) -> Result<Lens, ViewError> {
        let near_depth = 1.0 - depth.far();
        let middle = meeting_point([self.x, self.y, self.z - f64::from(near_depth) * DVec4::W])?;
        let across = [self.x.truncate(), self.y.truncate()];
        let gradient = self.z.truncate();
        let away = if depth == DepthOrder::Standard { gradient } else { -gradient };
        let line_of_sight = across[0].cross(across[1]).normalize();
        let forward = line_of_sight * away.dot(line_of_sight).signum();
        if (away - forward * away.dot(forward)).length() > DEPTH_TOLERANCE * away.length() {
            return Err(ViewError::Depth);
        }
        Ok(Lens {
            eye: -forward.extend(0.0).as_vec4(),
            nearness_slope: away.dot(forward) as f32,
            depth_offset: depth.far(),
            depth_scale: 1.0 - 2.0 * depth.far(),
            ..on_pixels(across, DVec2::ZERO, forward, middle, size)
        })
    }
}

/// The point where three planes meet.
fn meeting_point(planes: [DVec4; 3]) -> Result<DVec3, ViewError> {
    let normals = planes.map(|plane| plane.truncate().normalize_or_zero());
    let volume = DMat3::from_cols_array_2d(&normals.map(|normal| normal.to_array())).determinant();
    if volume.abs() < FLAT {
        return Err(ViewError::Singular);
    }
    let rows = DMat3::from_cols_array_2d(&planes.map(|plane| plane.truncate().to_array())).transpose();
    Ok(rows.inverse() * -DVec3::from_array(planes.map(|plane| plane.w)))
}

/// The part of a lens that says which point falls on which pixel. `across` are the rows for x and y without what grows
/// with the distance, `shift` is where on the picture the eye looks.
fn on_pixels(across: [DVec3; 2], shift: DVec2, forward: DVec3, eye: DVec3, size: [u32; 2]) -> Lens {
    let [x, y] = across;
    let right = x.normalize();
    let up = (y - right * y.dot(right)).normalize();
    let turn = DMat3::from_cols(right, up, -forward).transpose();
    let to_eye = DMat4::from_mat3(turn) * DMat4::from_translation(-eye);
    let half = DVec2::new(f64::from(size[0]), f64::from(size[1])) * 0.5;
    Lens {
        to_eye: to_eye.as_mat4(),
        center: (half * (1.0 + shift * DVec2::new(1.0, -1.0))).as_vec2(),
        focal: (half * DVec2::new(x.length(), y.dot(up))).as_vec2(),
        skew: (half.y * y.dot(right)) as f32,
        ..Lens::default()
    }
}

#[cfg(test)]
mod tests {
    use glam::camera::{lh, rh};
    use glam::{Mat4, Quat, Vec3};

    use super::*;
    use crate::view::View;

    const SIZE: [u32; 2] = [320, 200];

    /// Pixel and nearness by the lens.
    fn through(lens: &Lens, point: Vec3) -> (DVec2, f64) {
        let at = lens.to_eye.as_dmat4().transform_point3(point.as_dvec3());
        let (w, nearness) =
            if lens.is_perspective { (-at.z, -1.0 / at.z) } else { (1.0, 1.0 + at.z * f64::from(lens.nearness_slope)) };
        let focal = lens.focal.as_dvec2();
        let moved = DVec2::new(focal.x * at.x, -(f64::from(lens.skew) * at.x + focal.y * at.y)) / w;
        (lens.center.as_dvec2() + moved, nearness)
    }

    /// Holds the lens to the matrices at some points in front of the near plane.
    fn hold(name: &str, view: Mat4, projection: Mat4, depth: DepthOrder) {
        let made = View::new(view, projection, depth, SIZE).unwrap_or_else(|error| panic!("{name}: {error}"));
        let lens = made.lens();
        let clip = projection.as_dmat4() * view.as_dmat4();
        for i in 0..64 {
            let part = |shift: i32| f64::from((i >> shift) & 3) / 3.0;
            // Between the near plane and where depth is half of it.
            let near = 1.0 - f64::from(depth.far());
            let ndc = DVec3::new(2.0 * part(0) - 1.0, 2.0 * part(2) - 1.0, near + (0.5 - near) * part(4));
            let point = clip.inverse().project_point3(ndc);
            let pixel = DVec2::new(1.0 + ndc.x, 1.0 - ndc.y) * 0.5 * DVec2::new(320.0, 200.0);
            let (found, nearness) = through(lens, point.as_vec3());
            assert!(found.distance(pixel) < 2e-2, "{name}: {found} is not {pixel}");
            let of_depth = (ndc.z - f64::from(lens.depth_offset)) * f64::from(lens.depth_scale);
            assert!((nearness / of_depth - 1.0).abs() < 1e-3, "{name}: {nearness} is not {of_depth}");
            assert!(nearness > 0.0);
        }
    }

    fn views() -> Vec<(&'static str, Mat4)> {
        let eye = Vec3::new(1.0, 2.0, 3.0);
        let view = rh::view::look_at_mat4(eye, Vec3::ZERO, Vec3::Y);
        let turned = Mat4::from_quat(Quat::from_rotation_z(0.7)) * view;
        vec![
            ("plain", view),
            ("rolled", turned),
            ("scaled", Mat4::from_scale(Vec3::splat(0.01)) * view),
            ("mirrored", turned * Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))),
            ("sheared", turned * Mat4::from_scale(Vec3::new(1.0, 1.5, 0.8))),
        ]
    }

    #[test]
    fn a_lens_does_what_the_matrices_do() {
        use rh::proj::directx::{
            frustum, orthographic, perspective, perspective_infinite, perspective_infinite_reverse,
        };
        let (standard, reverse) = (DepthOrder::Standard, DepthOrder::Reverse);
        let flip = Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0));
        let jitter = Mat4::from_translation(Vec3::new(0.3 / 160.0, -0.2 / 100.0, 0.0));
        let turn = Mat4::from_rotation_z(std::f32::consts::FRAC_PI_2);
        for (name, view) in views() {
            let projections = [
                ("perspective", perspective(0.9, 1.6, 0.1, 50.0), standard),
                ("reverse", perspective(0.9, 1.6, 50.0, 0.1), reverse),
                ("infinite", perspective_infinite(0.9, 1.6, 0.1), standard),
                ("infinite reverse", perspective_infinite_reverse(0.9, 1.6, 0.1), reverse),
                ("off-axis", frustum(-0.02, 0.09, -0.03, 0.05, 0.1, 50.0), standard),
                ("jittered", jitter * perspective(0.9, 1.6, 50.0, 0.1), reverse),
                ("upside down", flip * perspective(0.9, 1.6, 50.0, 0.1), reverse),
                ("turned", turn * perspective(0.9, 1.6, 50.0, 0.1), reverse),
                ("orthographic", orthographic(-2.0, 1.0, -1.5, 2.5, 0.1, 50.0), standard),
                ("orthographic reverse", orthographic(-2.0, 1.0, -1.5, 2.5, 50.0, 0.1), reverse),
                ("behind the eye", orthographic(-2.0, 1.0, -1.5, 2.5, -10.0, 50.0), standard),
            ];
            for (projection, matrix, depth) in projections {
                // Parallel rays are not perpendicular to planes that are sheared.
                if name == "sheared" && matrix.row(3) == Vec4::W {
                    assert_eq!(View::new(view, matrix, depth, SIZE), Err(ViewError::Depth));
                    continue;
                }
                hold(&format!("{name}, {projection}"), view, matrix, depth);
            }
            let left = Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0)) * view;
            hold(&format!("{name}, left-handed"), left, lh::proj::directx::perspective(0.9, 1.6, 0.1, 50.0), standard);
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        let view = rh::view::look_at_mat4(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, Vec3::Y);
        let projection = rh::proj::directx::perspective(0.9, 1.6, 0.1, 50.0);
        let standard = DepthOrder::Standard;
        let refused = |view, projection, depth| View::new(view, projection, depth, SIZE).unwrap_err();
        assert_eq!(refused(view * f32::NAN, projection, standard), ViewError::NotFinite);
        assert_eq!(
            refused(Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0)) * view, projection, standard),
            ViewError::Singular
        );
        assert_eq!(refused(view, Mat4::ZERO, standard), ViewError::Singular);
        assert_eq!(refused(view, projection, DepthOrder::Reverse), ViewError::Order(DepthOrder::Reverse));
        // Lengyel's oblique near plane.
        let mut oblique = projection.transpose();
        oblique.z_axis = Vec4::new(0.3, 0.2, -1.0, -0.1);
        assert_eq!(refused(view, oblique.transpose(), standard), ViewError::Depth);
        let mut slanted = rh::proj::directx::orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 10.0).transpose();
        slanted.z_axis.x = 0.05;
        assert_eq!(refused(view, slanted.transpose(), standard), ViewError::Depth);
        let mut behind = projection;
        behind.w_axis.z = -behind.w_axis.z;
        assert_eq!(refused(view, behind, standard), ViewError::Order(standard), "near and far are exchanged");
        // Depth that falls with the distance from -1: no distance has the depth of the near plane.
        let mut nowhere = projection;
        nowhere.z_axis.z = 1.0;
        assert!(matches!(refused(view, nowhere, standard), ViewError::Near(_)));
        let minimized = View::new(view * f32::NAN, projection * f32::NAN, standard, [0, 200]).unwrap();
        assert!(minimized.is_empty());
    }
}
