//! Where on the picture a segment can be at most.

use glam::DVec2;

use crate::cone::RoundCone;
use crate::rays::Rays;

/// What rounding may add, as a share and in pixels.
const ROUNDING: f64 = 1e-9;

/// A part of the picture that no ray outside of can hit the segment through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bound {
    /// Corners of a rectangle, in pixels.
    pub(crate) low: DVec2,
    pub(crate) high: DVec2,
    /// No ray enters the segment nearer than this.
    pub(crate) nearest: f64,
    /// The axis on the picture, and how far from it the segment reaches; infinite where only the rectangle is known.
    start: DVec2,
    end: DVec2,
    reach: f64,
}

impl Bound {
    /// None for what lies in front of the near plane.
    pub(crate) fn new(rays: &Rays, cone: &RoundCone) -> Option<Self> {
        let near = rays.near;
        let front = (cone.a.z - cone.radius_a).min(cone.b.z - cone.radius_b);
        let back = (cone.a.z + cone.radius_a).max(cone.b.z + cone.radius_b);
        if back < near {
            return None;
        }
        if rays.is_perspective() && front < near {
            Some(Self::clipped(rays, cone, back))
        } else {
            Some(Self::whole(rays, cone, front))
        }
    }

    /// A strip around the axis, for a segment behind the near plane.
    ///
    /// A point of a ball with the centre `(c, d)` and the radius `r` is at `(c + e) / (d + f)` with `|(e, f)| <= r`. That is
    /// `(e - f c / d) / (d + f)` from `c / d`, which is not above `r sqrt(1 + |c / d|^2) / (d - r)`. The picture of the segment
    /// is within the convex hull of the two discs.
    fn whole(rays: &Rays, cone: &RoundCone, front: f64) -> Self {
        let disc = |center: glam::DVec3, radius: f64| {
            if !rays.is_perspective() {
                return (rays.pixel(center.truncate()), radius * rays.scale);
            }
            let across = center.truncate() / center.z;
            let reach = radius * (1.0 + across.length_squared()).sqrt() / (center.z - radius);
            (rays.pixel(across), reach * rays.scale)
        };
        let ((start, reach_a), (end, reach_b)) = (disc(cone.a, cone.radius_a), disc(cone.b, cone.radius_b));
        let reach = reach_a.max(reach_b);
        let reach = reach + ROUNDING * (1.0 + reach + start.abs().max(end.abs()).max_element());
        Self { low: start.min(end) - reach, high: start.max(end) + reach, nearest: front, start, end, reach }
    }

    /// A rectangle, for a segment that reaches through the near plane of a perspective: x / z and y / z are largest and
    /// smallest at corners of the box around what is behind the plane.
    fn clipped(rays: &Rays, cone: &RoundCone, back: f64) -> Self {
        let low = (cone.a - cone.radius_a).min(cone.b - cone.radius_b).truncate();
        let high = (cone.a + cone.radius_a).max(cone.b + cone.radius_b).truncate();
        let corners = [low, high, DVec2::new(low.x, high.y), DVec2::new(high.x, low.y)];
        let pixels = corners.map(|corner| [rays.near, back].map(|z| rays.pixel(corner / z)));
        let pixels = pixels.as_flattened();
        let low = pixels.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = pixels.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let slack = ROUNDING * (1.0 + low.abs().max(high.abs()).max_element());
        let (low, high) = (low - slack, high + slack);
        Self { low, high, nearest: rays.near, start: low, end: high, reach: f64::INFINITY }
    }

    /// Whether a disc on the picture meets the part.
    pub(crate) fn meets(&self, center: DVec2, radius: f64) -> bool {
        let in_box = center.cmpge(self.low - radius).all() && center.cmple(self.high + radius).all();
        let reach = self.reach + radius;
        in_box && self.square_to_axis(center) <= reach * reach
    }

    /// The square of the distance to the axis.
    fn square_to_axis(&self, point: DVec2) -> f64 {
        let (axis, from) = (self.end - self.start, point - self.start);
        let square = axis.length_squared();
        let t = if square > 0.0 { (from.dot(axis) / square).clamp(0.0, 1.0) } else { 0.0 };
        (from - axis * t).length_squared()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use tressfx_core::view::Camera;

    use super::*;

    #[test]
    fn no_ray_outside_of_the_bound_hits() {
        let size = [64, 48];
        let camera = Camera { near: 0.5, ..Camera::around(&[glam::Vec3::ONE, glam::Vec3::NEG_ONE], size) };
        let rays = Rays::new(&camera.view(size).unwrap());
        let mut seed = 1u32;
        let mut random = || {
            seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            f64::from(seed >> 8) / f64::from(1 << 24)
        };
        let (mut hits, mut clipped, mut outside) = (0, 0, 0);
        for i in 0..400 {
            let z = if i % 2 == 0 { 0.6 } else { 2.0 };
            let mut point = || DVec3::new(random() - 0.5, random() - 0.5, z * random());
            let (a, b) = (point(), point());
            let cone = RoundCone { a, radius_a: 0.2 * random(), b, radius_b: 0.2 * random() };
            let bound = Bound::new(&rays, &cone);
            clipped += u32::from(bound.is_some_and(|bound| bound.reach.is_infinite()));
            for (x, y) in (0..48).flat_map(|y| (0..64).map(move |x| (x, y))) {
                let at = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
                let hit = cone.interval(&rays.through(at)).filter(|hit| hit.exit > rays.near);
                let inside = bound.is_some_and(|bound| bound.meets(at, 0.0));
                if let Some(hit) = hit {
                    hits += 1;
                    assert!(inside, "{cone:?} is hit at {at}, outside of {bound:?}");
                    assert!(bound.unwrap().nearest <= hit.enter.max(rays.near));
                } else {
                    outside += u32::from(!inside);
                }
            }
        }
        assert!(hits > 10_000 && clipped > 100 && outside > 100_000, "{hits} {clipped} {outside}");
    }
}
