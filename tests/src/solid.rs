//! Meshes as solids, in f64: how far a point is from the surface, and how often the surface goes around it. What signed distance fields are held against; it
//! shares no code and no method with them.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

/// Triangles of a leaf.
const LEAF: usize = 4;
/// A part of the mesh that is further away than so many of its radii is taken as a dipole.
const FAR: f64 = 4.0;
/// Where what dipoles give is nearer to a half than this, all triangles are summed up.
const UNSURE: f64 = 0.25;

/// A mesh in a tree of boxes.
pub struct Solid {
    triangles: Vec<[DVec3; 3]>,
    parts: Vec<Part>,
}

/// Triangles beside each other; those of a part that is no leaf are those of its two children.
struct Part {
    range: std::ops::Range<usize>,
    least: DVec3,
    most: DVec3,
    /// The sum of their areas, as vectors, and where they are in the mean.
    area: DVec3,
    center: DVec3,
    radius: f64,
    /// The index of the second child; the first is the next part.
    second: Option<usize>,
}

impl Solid {
    /// A mesh of at least one triangle, three indices each.
    pub fn new(positions: &[Vec3], indices: &[u32]) -> Self {
        let corner = |index: &u32| positions[*index as usize].as_dvec3();
        let triangles = indices.as_chunks::<3>().0.iter().map(|triangle| triangle.each_ref().map(corner)).collect();
        let mut solid = Self { triangles, parts: Vec::new() };
        solid.divide(0..solid.triangles.len());
        solid
    }

    fn divide(&mut self, range: std::ops::Range<usize>) {
        let of_part = &mut self.triangles[range.clone()];
        let corners = || of_part.iter().flatten();
        let (least, most) = corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(least, most), corner| {
            (least.min(*corner), most.max(*corner))
        });
        let area_of = |[a, b, c]: &[DVec3; 3]| 0.5 * (*b - *a).cross(*c - *a);
        let size: f64 = of_part.iter().map(|triangle| area_of(triangle).length()).sum();
        let middle = |[a, b, c]: &[DVec3; 3]| (*a + *b + *c) / 3.0;
        let weighted: DVec3 = of_part.iter().map(|triangle| area_of(triangle).length() * middle(triangle)).sum();
        let center = if size > 0.0 { weighted / size } else { 0.5 * (least + most) };
        let radius = corners().map(|corner| corner.distance(center)).fold(0.0, f64::max);
        let area = of_part.iter().map(area_of).sum();
        let place = self.parts.len();
        let is_leaf = range.len() <= LEAF;
        if !is_leaf {
            let extent = most - least;
            let axis = if extent.x >= extent.y.max(extent.z) { 0 } else { if extent.y >= extent.z { 1 } else { 2 } };
            let half = of_part.len() / 2;
            of_part.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        }
        self.parts.push(Part { range: range.clone(), least, most, area, center, radius, second: None });
        if !is_leaf {
            let half = range.start + range.len() / 2;
            self.divide(range.start..half);
            self.parts[place].second = Some(self.parts.len());
            self.divide(half..range.end);
        }
    }

    /// The distance from the nearest triangle, negative where the winding number is more than a half.
    pub fn distance(&self, point: DVec3) -> f64 {
        let away = self.away(point);
        if self.winding(point) > 0.5 { -away } else { away }
    }

    /// The distance from the nearest triangle.
    pub fn away(&self, point: DVec3) -> f64 {
        let mut least = f64::INFINITY;
        self.visit_near(0, point, &mut least);
        least.sqrt()
    }

    fn visit_near(&self, place: usize, point: DVec3, least: &mut f64) {
        let part = &self.parts[place];
        if part.squared_distance(point) >= *least {
            return;
        }
        let Some(second) = part.second else {
            let near = |triangle: &[DVec3; 3]| squared_distance(triangle, point);
            *least = self.triangles[part.range.clone()].iter().map(near).fold(*least, f64::min);
            return;
        };
        let children = [place + 1, second];
        let [one, other] = children.map(|child| self.parts[child].squared_distance(point));
        let order = if one <= other { children } else { [second, place + 1] };
        order.into_iter().for_each(|child| self.visit_near(child, point, least));
    }

    /// The generalised winding number (Jacobson et al. 2013): the solid angle of all triangles, in whole spheres. Exact where it is near a half, else to about a tenth.
    pub fn winding(&self, point: DVec3) -> f64 {
        let rough = self.turns(0, point) / (4.0 * PI);
        if (rough - 0.5).abs() > UNSURE { rough } else { self.exact_winding(point) }
    }

    /// The same without dipoles.
    pub fn exact_winding(&self, point: DVec3) -> f64 {
        self.triangles.iter().map(|triangle| solid_angle(triangle, point)).sum::<f64>() / (4.0 * PI)
    }

    fn turns(&self, place: usize, point: DVec3) -> f64 {
        let part = &self.parts[place];
        let to_part = part.center - point;
        let distance = to_part.length();
        if distance > FAR * part.radius {
            return part.area.dot(to_part) / distance.powi(3);
        }
        match part.second {
            None => self.triangles[part.range.clone()].iter().map(|triangle| solid_angle(triangle, point)).sum(),
            Some(second) => self.turns(place + 1, point) + self.turns(second, point),
        }
    }
}

impl Part {
    fn squared_distance(&self, point: DVec3) -> f64 {
        point.clamp(self.least, self.most).distance_squared(point)
    }
}

/// Of a triangle, by the region of the plane that the point is over: inside, or nearest to an edge.
fn squared_distance(&[a, b, c]: &[DVec3; 3], point: DVec3) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (bb, bc, cc) = (ab.length_squared(), ab.dot(ac), ac.length_squared());
    let (pb, pc) = (ap.dot(ab), ap.dot(ac));
    let under = bb * cc - bc * bc;
    let (v, w) = ((cc * pb - bc * pc) / under, (bb * pc - bc * pb) / under);
    if under > 1e-12 * bb * cc && v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return ap.distance_squared(v * ab + w * ac);
    }
    let to_edge = |from: DVec3, to: DVec3| {
        let edge = to - from;
        let share = ((point - from).dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        point.distance_squared(from + share * edge)
    };
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}

/// Van Oosterom, Strackee 1983.
fn solid_angle(corners: &[DVec3; 3], point: DVec3) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - point);
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let under = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(under)
}
