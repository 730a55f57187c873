//! Simple solids: what hair collides with and what built-in grooms grow on.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// An ellipsoid whose axes are those of the space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Centre.
    pub center: Vec3,
    /// Half of its extent along x, y and z. Positive.
    pub radii: Vec3,
}

impl Ellipsoid {
    /// The distance of a point in multiples of the radii: below 1 inside, 1 on the surface.
    pub fn level(&self, point: Vec3) -> f32 {
        ((point - self.center) / self.radii).length()
    }

    /// The outward unit normal of the level surface through a point; up at the centre.
    pub fn normal(&self, point: Vec3) -> Vec3 {
        ((point - self.center) / (self.radii * self.radii)).try_normalize().unwrap_or(Vec3::Y)
    }

    /// Signed distance of a point, negative inside: to first order in the distance, exact on the surface and for a sphere.
    pub fn distance(&self, point: Vec3) -> f32 {
        let from = point - self.center;
        let level = (from / self.radii).length();
        let gradient = (from / (self.radii * self.radii)).length();
        if gradient > 0.0 { level * (level - 1.0) / gradient } else { -self.radii.min_element() }
    }

    /// Capsules that fill most of the ellipsoid and nowhere leave it, so that what grows on its surface is outside of them.
    ///
    /// Along an axis of half-length `a`, where the smallest half-length is `b`, the largest sphere inside that is `c` from
    /// the centre has the radius `b * sqrt(1 - c^2 / (a^2 - b^2))`, up to `c = (a^2 - b^2) / a`. That radius is concave in
    /// `c`, so a capsule between two such spheres is inside as well.
    pub fn inscribed_capsules(&self) -> Vec<Capsule> {
        let b = self.radii.min_element();
        let middle = Capsule { a: self.center, b: self.center, radius_a: b, radius_b: b };
        let mut capsules = Vec::new();
        for (axis, a) in [(Vec3::X, self.radii.x), (Vec3::Y, self.radii.y), (Vec3::Z, self.radii.z)] {
            let focus = a * a - b * b;
            if focus <= 0.01 * a * a {
                continue;
            }
            // Short of the largest `c`, where the sphere would be as tight as the curvature at the pole.
            let c = 0.85 * focus / a;
            let radius_b = b * (1.0 - c * c / focus).sqrt();
            let to = |c: f32| Capsule { b: self.center + axis * c, radius_b, ..middle };
            capsules.extend([to(c), to(-c)]);
        }
        if capsules.is_empty() { vec![middle] } else { capsules }
    }
}

/// A capsule with a radius at either end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Capsule {
    /// Centre of one end.
    pub a: Vec3,
    /// Centre of the other end; may be the same.
    pub b: Vec3,
    /// Radius at `a`.
    pub radius_a: f32,
    /// Radius at `b`.
    pub radius_b: f32,
}

impl Capsule {
    /// Whether its numbers make a solid: finite, and no negative radius.
    pub fn is_sound(&self) -> bool {
        let radii = [self.radius_a, self.radius_b];
        self.a.is_finite() && self.b.is_finite() && radii.iter().all(|radius| radius.is_finite() && *radius >= 0.0)
    }

    /// The nearest point of the axis and the radius there, interpolated along the axis.
    pub fn nearest(&self, point: Vec3) -> (Vec3, f32) {
        let axis = self.b - self.a;
        let squared = axis.length_squared();
        let t = if squared > 0.0 { ((point - self.a).dot(axis) / squared).clamp(0.0, 1.0) } else { 0.0 };
        (self.a + axis * t, self.radius_a + (self.radius_b - self.radius_a) * t)
    }

    /// Signed distance of a point to the surface, negative inside.
    pub fn distance(&self, point: Vec3) -> f32 {
        let (center, radius) = self.nearest(point);
        point.distance(center) - radius
    }
}
