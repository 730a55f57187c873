//! How a strand goes on at a vertex, as the eye sees it.

use glam::DVec2;

use super::Strands;
use super::projection::Projection;

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Joint {
    /// Not at all.
    Round,
    /// With the tangent of half the angle by which it turns on the screen.
    Turn(f64),
}

impl Joint {
    pub(super) const AHEAD: Self = Self::Turn(0.0);
    /// The largest tangent of a turn that is not sharp.
    const SHARP: f64 = 0.42;
    /// Pixels by which a segment goes on behind its round end at a sharp turn.
    const ELBOW: f64 = 0.75;

    /// At a vertex.
    pub(super) fn at(projection: &Projection, strands: &Strands, strand: u32, vertex: u32) -> Self {
        let (Some(before), Some(after)) = (strands.before(strand, vertex), strands.after(strand, vertex)) else {
            return Self::Round;
        };
        let points = [before, vertex, after].map(|vertex| projection.point(strands.point(strand, vertex)));
        if points.iter().any(|point| projection.behind_near(point) <= 0.0) {
            return Self::AHEAD;
        }
        let [before, middle, after] = points.map(|point| projection.pixel(&point));
        let (own, next) = (middle - before, after - middle);
        let ahead = own.length() * next.length() + own.dot(next);
        Self::Turn(rounded_tilt((own.perp_dot(next) / ahead.max(1e-30)).clamp(-1e3, 1e3)))
    }

    pub(super) fn is_sharp(self) -> bool {
        matches!(self, Self::Round) || matches!(self, Self::Turn(tilt) if tilt.abs() > Self::SHARP)
    }

    /// How far the segment goes on behind its round end.
    pub(super) fn slack(self) -> f64 {
        match self {
            Self::Round => 0.0,
            _ if self.is_sharp() => Self::ELBOW,
            Self::Turn(_) => f64::INFINITY,
        }
    }

    /// Whether a point is behind the bisector, if there is one: so far along a segment from its end and across it, where `side` is 1,
    /// or from its start, where it is -1.
    pub(super) fn is_behind(self, at: DVec2, side: f64) -> Option<bool> {
        match self {
            Self::Round => None,
            Self::Turn(tilt) => Some(at.x + side * tilt * at.y >= 0.0),
        }
    }
}

/// A tilt has 6 bits behind its highest one, and is 0 below 2^-14.
fn rounded_tilt(tilt: f64) -> f64 {
    if tilt.abs() < 2f64.powi(-14) {
        return 0.0;
    }
    let last = 2f64.powi(tilt.abs().log2().floor() as i32 - 6);
    (tilt / last).round() * last
}
