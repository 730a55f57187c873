//! Axis-aligned boxes.

use glam::Vec3;
use serde::Serialize;

/// An axis-aligned box. Both corners are 0 where it was made of no points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Bounds {
    /// The smallest coordinates.
    pub min: Vec3,
    /// The largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The smallest box around points.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        let grow = |b: Self, p: Vec3| Self { min: b.min.min(p), max: b.max.max(p) };
        points.into_iter().map(|p| Self { min: p, max: p }).reduce(|b, p| grow(b, p.min)).unwrap_or_default()
    }

    /// The smallest box around two boxes.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The centre. Halved before it is added, so that no corner can overflow.
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// The radius of the sphere around the box: half of its diagonal.
    pub fn radius(&self) -> f32 {
        (self.max * 0.5 - self.min * 0.5).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_hold_their_points() {
        let bounds = Bounds::of([Vec3::new(1.0, 0.0, -2.0), Vec3::new(-1.0, 4.0, 0.0)]);
        assert_eq!((bounds.center(), bounds.radius()), (Vec3::new(0.0, 2.0, -1.0), 6.0f32.sqrt()));
        assert_eq!(Bounds::of([]), Bounds::default());
        let far = Bounds::of([Vec3::MAX, Vec3::MIN]);
        assert_eq!(far.union(bounds), far);
        assert_eq!(far.center(), Vec3::ZERO);
    }
}
