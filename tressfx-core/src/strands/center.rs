//! The centre of a groom: positions on the GPU are relative to it, wherever the head is.
//!
//! Grooms are modelled on characters that stand on their origin, so that hair lies a metre and more away from it, and
//! characters walk. The larger a coordinate, the coarser its rounding: relative to the centre, coordinates are as small as the
//! groom.

use glam::{Vec3, Vec4};

use super::Bounds;

/// The centre is rounded to a grid with at least this many steps in the radius of the groom. Subtracting such a point from
/// coordinates that are larger than the groom loses no bit; smaller ones are rounded as finely as anything in the groom.
const STEPS: f32 = 64.0;

impl Bounds {
    /// The point that the positions of a groom with these bounds are relative to: the centre, rounded to a coarse grid.
    pub fn rounded_center(&self) -> Vec3 {
        let step = (self.radius() / STEPS).log2().floor().exp2();
        let center = self.center();
        if step.is_normal() { (center / step).round() * step } else { center }
    }
}

/// Points of the rest pose relative to a centre; `w` stays.
pub fn relative_to(center: Vec3, points: &[Vec4]) -> Vec<Vec4> {
    points.iter().map(|&point| point - center.extend(0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_relative_to_the_center() {
        let point = |i: u32| {
            let x = i as f32;
            Vec4::new(1.6 + 0.1 * (1.3 * x).sin(), 0.12 * (0.7 * x).cos(), -0.07 + 0.09 * (2.1 * x).sin(), 1.0)
        };
        let points: Vec<Vec4> = (0..1000).map(point).collect();
        let center = Bounds::of(points.iter().map(|point| point.truncate())).rounded_center();
        for (point, relative) in points.iter().zip(relative_to(center, &points)) {
            let lost = relative.as_dvec4() - (point.as_dvec4() - center.extend(0.0).as_dvec4());
            assert_eq!((lost.x, lost.w), (0.0, 0.0), "{point}");
            assert!(lost.abs().max_element() <= f64::from(f32::EPSILON) / 16.0, "{point} {lost}");
            assert!(relative.truncate().length() < 0.25, "{relative}");
        }
    }

    #[test]
    fn a_groom_without_an_extent_has_a_center() {
        let point = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(Bounds { min: point, max: point }.rounded_center(), point);
        assert!(Bounds::default().rounded_center().is_finite());
    }
}
