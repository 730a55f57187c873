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
