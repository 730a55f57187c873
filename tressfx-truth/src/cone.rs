//! Round cones: the union of all balls between two balls whose centre and radius go linearly from one to the other.

use glam::DVec3;

use crate::rays::Ray;

/// A segment of a fibre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundCone {
    pub(crate) a: DVec3,
    pub(crate) radius_a: f64,
    pub(crate) b: DVec3,
    pub(crate) radius_b: f64,
}

/// Where a ray enters and leaves a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) enter: f64,
    pub(crate) exit: f64,
}

impl Interval {
    /// The smallest interval that holds both.
    fn with(self, s: f64) -> Self {
        Self { enter: self.enter.min(s), exit: self.exit.max(s) }
    }
}

/// The part of a ray within a ball.
///
/// Segments that share a vertex get the same bits for its ball, so that their intervals meet.
fn ball(ray: &Ray, center: DVec3, radius: f64) -> Option<Interval> {
    let square = ray.direction.length_squared();
    let nearest = (center - ray.origin).dot(ray.direction) / square;
    let depth = radius * radius - ray.at(nearest).distance_squared(center);
    let half = (depth / square).sqrt();
    (depth > 0.0).then_some(Interval { enter: nearest - half, exit: nearest + half })
}

impl RoundCone {
    /// The part of a ray within the solid: one interval, as the solid is convex. Rays that only touch it miss it.
    ///
    /// Its ends lie on one of the two balls or on the flank, and no point of either is outside. So they are the first and the
    /// last of all points where the ray meets these.
    pub(crate) fn interval(&self, ray: &Ray) -> Option<Interval> {
        let balls = [ball(ray, self.a, self.radius_a), ball(ray, self.b, self.radius_b)];
        let ends = balls.into_iter().flatten().flat_map(|ball| [ball.enter, ball.exit]);
        let points = ends.chain(self.flank(ray).into_iter().flatten());
        let found = points.fold(None, |found: Option<Interval>, s| {
            Some(found.map_or(Interval { enter: s, exit: s }, |found| found.with(s)))
        });
        found.filter(|found| found.enter < found.exit)
    }

    /// Where a ray crosses the cone that touches all balls, between the two circles where it touches the balls at the ends.
    ///
    /// A point `p` is on it where the minimum over `t` of `|p - c(t)|^2 - r(t)^2` is 0: a quadratic equation for the parameter
    /// of the ray. It is written in cross products and from the point of the ray beside the middle of the segment, so that
    /// nothing large cancels for fibres that are thin, far, or seen end-on.
    fn flank(&self, ray: &Ray) -> [Option<f64>; 2] {
        let (axis, slope) = (self.b - self.a, self.radius_b - self.radius_a);
        let stretch = axis.length_squared() - slope * slope;
        if stretch <= 0.0 {
            return [None; 2];
        }
        let direction = ray.direction;
        let middle = (self.a.midpoint(self.b) - ray.origin).dot(direction) / direction.length_squared();
        let from = ray.at(middle) - self.a;
        let (turn, moment) = (direction.cross(axis), from.cross(axis));
        let (along, reach) = (direction.dot(axis), from.dot(axis));
        let square = turn.length_squared() - slope * slope * direction.length_squared();
        let half = moment.dot(turn) - slope * (slope * from.dot(direction) + self.radius_a * along);
        let constant = moment.length_squared()
            - slope * (slope * from.length_squared() + 2.0 * self.radius_a * reach)
            - self.radius_a * self.radius_a * axis.length_squared();
        let discriminant = half * half - square * constant;
        if discriminant.is_nan() || discriminant <= 0.0 {
            return [None; 2];
        }
        let sum = -(half + discriminant.sqrt().copysign(half));
        let on_segment = |s: f64| (0.0..=1.0).contains(&((reach + s * along + self.radius_a * slope) / stretch));
        [sum / square, constant / sum].map(|s| on_segment(s).then_some(middle + s))
    }

    /// Where on the axis, 0 at `a` to 1 at `b`, the ball is that a point is deepest in (by its power, the square of the
    /// distance less that of the radius), and the power. For a point on the surface it is the ball that touches there.
    pub(crate) fn deepest(&self, point: DVec3) -> (f64, f64) {
        let (axis, slope) = (self.b - self.a, self.radius_b - self.radius_a);
        let stretch = axis.length_squared() - slope * slope;
        let from = point - self.a;
        let t = if stretch > 0.0 {
            ((from.dot(axis) + self.radius_a * slope) / stretch).clamp(0.0, 1.0)
        } else {
            // One ball is within the other.
            f64::from(u8::from(self.radius_b > self.radius_a))
        };
        let radius = self.radius_a + slope * t;
        (t, (from - axis * t).length_squared() - radius * radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in [0, 1) that are the same everywhere.
    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
        }
    }

    /// The least distance to a surface of the balls, by a search over many of them.
    fn distance(cone: &RoundCone, point: DVec3) -> f64 {
        let at =
            |t: f64| point.distance(cone.a.lerp(cone.b, t)) - (cone.radius_a + (cone.radius_b - cone.radius_a) * t);
        // The function of t is convex: a search by thirds.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..200 {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if at(left) < at(right) { high = right } else { low = left }
        }
        at(low).min(at(0.0)).min(at(1.0))
    }

    #[test]
    fn intervals_are_where_a_search_over_the_balls_finds_them() {
        let mut random = Random(5);
        let (mut hits, mut flanks) = (0, 0);
        for i in 0..20_000 {
            // From needles to nearly balls, some with one ball inside the other.
            let size = [1.0, 0.1, 1e-3][i % 3];
            let radius = [0.3, 0.01, 1e-4][i / 3 % 3];
            let (a, radius_a) = (random.vector(), radius * random.unit());
            let cone = RoundCone { a, radius_a, b: a + size * random.vector(), radius_b: radius * random.unit() };
            let through = cone.a.lerp(cone.b, 1.2 * random.unit() - 0.1) + 1.5 * radius * random.vector();
            let direction = (through - DVec3::new(0.0, 0.0, -3.0)).normalize() * (0.5 + random.unit());
            let origin = if i % 2 == 0 { DVec3::new(0.0, 0.0, -3.0) } else { through - 3.0 * direction };
            let ray = Ray { origin, direction };
            let scale = radius.max(1e-4);
            match cone.interval(&ray) {
                Some(Interval { enter, exit }) => {
                    hits += 1;
                    let [first, last] = [enter, exit].map(|s| distance(&cone, ray.at(s)));
                    assert!(first.abs() < 1e-8 * scale + 1e-13, "{i}: {first} at the entry of {cone:?}");
                    assert!(last.abs() < 1e-8 * scale + 1e-13, "{i}: {last} at the exit of {cone:?}");
                    assert!(distance(&cone, ray.at(0.5 * (enter + exit))) < 1e-13);
                    let (t, power) = cone.deepest(ray.at(enter));
                    flanks += u32::from(t > 0.0 && t < 1.0);
                    assert!(power.abs() < 1e-8 * scale, "{i}: {power}");
                }
                None => {
                    for step in 0..=200 {
                        let s = (through - ray.origin).dot(direction) / direction.length_squared();
                        let point = ray.at(s + (f64::from(step) - 100.0) * 0.02 * (size + radius));
                        assert!(distance(&cone, point) > -1e-9 * scale, "{i}: a ray that misses is inside {cone:?}");
                    }
                }
            }
        }
        assert!(hits > 5000 && flanks > 2000, "{hits} hits, {flanks} on flanks");
    }

    #[test]
    fn a_ray_along_the_axis_goes_from_end_to_end() {
        let cone = RoundCone { a: DVec3::Z, radius_a: 0.25, b: DVec3::Z * 3.0, radius_b: 0.25 };
        let ray = |x: f64| Ray { origin: DVec3::new(x, 0.0, 0.0), direction: DVec3::Z };
        assert_eq!(cone.interval(&ray(0.0)), Some(Interval { enter: 0.75, exit: 3.25 }));
        let beside = cone.interval(&ray(0.15)).unwrap();
        assert!((beside.enter - 0.8).abs() < 1e-15 && (beside.exit - 3.2).abs() < 1e-15, "{beside:?}");
        assert_eq!(cone.interval(&ray(0.26)), None);
    }

    #[test]
    fn without_a_radius_there_is_no_solid() {
        let cone =
            RoundCone { a: DVec3::new(-1.0, 0.0, 1.0), radius_a: 0.0, b: DVec3::new(1.0, 0.0, 1.0), radius_b: 0.0 };
        assert_eq!(cone.interval(&Ray { origin: DVec3::ZERO, direction: DVec3::Z }), None);
        let point = RoundCone { b: cone.a, ..cone };
        assert_eq!(point.interval(&Ray { origin: DVec3::new(-1.0, 0.0, 0.0), direction: DVec3::Z }), None);
        let ball = RoundCone { radius_a: 0.5, ..point };
        let ray = Ray { origin: DVec3::new(-1.0, 0.0, 0.0), direction: DVec3::Z };
        assert_eq!(ball.interval(&ray), Some(Interval { enter: 0.5, exit: 1.5 }));
    }
}
