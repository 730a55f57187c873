//! Where the picture is taken from.

use anyhow::Result;
use glam::Vec3;
use tressfx_core::strands::Bounds;
use tressfx_core::view::{self, View};

use crate::cli::numbers;

/// `--camera`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Camera {
    /// So that the groom fills the picture.
    Auto,
    /// As given.
    Given {
        eye: Vec3,
        target: Vec3,
        /// Vertical, in radians.
        fov: f32,
    },
}

impl Camera {
    /// `auto`, or seven numbers.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let [ex, ey, ez, tx, ty, tz, degrees] = numbers(text)?;
        if !(1.0..=170.0).contains(&degrees) {
            return Err(format!("{degrees} degrees is not between 1 and 170"));
        }
        let (eye, target) = (Vec3::new(ex, ey, ez), Vec3::new(tx, ty, tz));
        if eye == target {
            return Err(String::from("the eye is where the target is"));
        }
        Ok(Self::Given { eye, target, fov: degrees.to_radians() })
    }

    /// The view of a groom with these vertices.
    pub(crate) fn view(self, vertices: &[Vec3], size: [u32; 2]) -> Result<View> {
        let mut camera = view::Camera::around(vertices, size);
        if let Self::Given { eye, target, fov } = self {
            let bounds = Bounds::of(vertices.iter().copied());
            let reach = eye.distance(bounds.center()) + bounds.radius();
            camera = view::Camera { eye, target, fov, near: reach * 1e-3, far: reach * 10.0, ..camera };
        }
        Ok(camera.view(size)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seven_numbers_or_auto() {
        assert_eq!(Camera::parse("auto"), Ok(Camera::Auto));
        let given = Camera::parse("0,0,5,0,0,0,90").unwrap();
        assert_eq!(given, Camera::Given { eye: Vec3::Z * 5.0, target: Vec3::ZERO, fov: 90f32.to_radians() });
        assert!(Camera::parse("0,0,5").unwrap_err().contains("7 numbers"));
        assert!(Camera::parse("0,0,5,0,0,0,0").unwrap_err().contains("between 1 and 170"));
        assert!(Camera::parse("0,0,5,0,0,5,30").unwrap_err().contains("where the target is"));
    }
}
