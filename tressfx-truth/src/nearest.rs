//! What comes through strands by the nearest fibre that a light sees, for comparison: the approximation of deep shadows of TressFX 4.1.
//!
//! A map holds the distance of the nearest fibre. Behind it, light is taken to have passed as many fibres as fit into the distance from there,
//! at least one, and each takes `shadow_alpha`. The mean of 5 x 5 texels is taken of the light, not of the distances. Two errors of the original
//! are left out: distances are linear for directional lights too, and they are not filtered.

use glam::{DMat3, DVec2, DVec3};

use crate::cone::RoundCone;
use crate::fibres::Fibres;

/// Texels of a map, each way: a quarter of the original's atlas.
const TEXELS: usize = 2048;

/// Texels that are filtered on either side.
const REACH: isize = 2;

/// Texels by which fibres are drawn wider, so that thin ones are not lost.
const WIDER: f64 = 0.5;

/// The widest view of a point light: the tangent of half its angle.
const WIDEST: f64 = 4.0;

/// From where a light shines.
#[derive(Clone, Copy, Debug)]
pub(crate) enum From {
    /// Along a direction of length 1.
    Way(DVec3),
    Point(DVec3),
}

/// What a light sees of the strands.
#[derive(Debug)]
pub(crate) struct DepthMap {
    from: From,
    /// To the axes of the light, the third of which is its way.
    axes: DMat3,
    /// The corner of the map, and the side of a texel.
    low: DVec2,
    texel: f64,
    /// Of the nearest fibre, row by row; infinite where there is none.
    distances: Vec<f32>,
    /// From one fibre to the next one behind it.
    spacing: f64,
    /// Fibres that are no farther behind the nearest are in its light.
    bias: f64,
}

impl DepthMap {
    /// `spacing` is in radii of the thickest fibre. None for a point light in the middle of the strands, and where there are none.
    pub(crate) fn new(fibres: &Fibres, from: From, spacing: f64) -> Option<Self> {
        let cones = || (0..fibres.end()).filter_map(|segment| fibres.cone(segment));
        let ends = || cones().flat_map(|cone| [cone.a, cone.b]);
        let [low, high] =
            ends().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)]);
        let (middle, reach) = (0.5 * (low + high), 0.5 * (high - low).length());
        let radius = cones().map(|cone| cone.radius_a.max(cone.radius_b)).fold(0.0, f64::max);
        let (way, center, extent) = match from {
            From::Way(way) => (way, middle, reach),
            From::Point(point) => {
                let (way, distance) = (middle - point).normalize_and_length();
                let sine = (reach / distance).min(1.0);
                (way, point, (sine / (1.0 - sine * sine).sqrt()).min(WIDEST))
            }
        };
        let (right, up) = way.try_normalize()?.any_orthonormal_pair();
        let axes = DMat3::from_cols(right, up, way).transpose();
        let center = if let From::Point(_) = from { DVec2::ZERO } else { (axes * center).truncate() };
        let extent = 1.01 * extent.max(f64::MIN_POSITIVE) + 2.0 * if let From::Way(_) = from { radius } else { 0.0 };
        let texel = 2.0 * extent / TEXELS as f64;
        let (low, distances) = (center - extent, vec![f32::INFINITY; TEXELS * TEXELS]);
        let mut map = Self { from, axes, low, texel, distances, spacing: spacing * radius, bias: radius };
        cones().for_each(|cone| map.draw(&cone));
        Some(map)
    }

    /// The texel of a point, its distance along the way of the light, and texels of a unit length there. None behind a point light.
    fn place(&self, point: DVec3) -> Option<(DVec2, f64, f64)> {
        let (across, distance, scale) = match self.from {
            From::Way(_) => {
                let at = self.axes * point;
                (at.truncate(), at.z, 1.0)
            }
            From::Point(origin) => {
                let at = self.axes * (point - origin);
                (at.truncate() / at.z, at.z, 1.0 / at.z)
            }
        };
        let is_ahead = !matches!(self.from, From::Point(_)) || distance > 0.0;
        is_ahead.then(|| ((across - self.low) / self.texel, distance, scale / self.texel))
    }

    fn draw(&mut self, cone: &RoundCone) {
        let (Some(a), Some(b)) = (self.place(cone.a), self.place(cone.b)) else { return };
        let widths = [cone.radius_a * a.2 + WIDER, cone.radius_b * b.2 + WIDER];
        let widest = widths[0].max(widths[1]);
        let inside = |at: f64| at.clamp(0.0, TEXELS as f64) as usize;
        let [low, high] = [a.0.min(b.0) - widest, a.0.max(b.0) + widest];
        let way = b.0 - a.0;
        let square = way.length_squared().max(f64::MIN_POSITIVE);
        for y in inside(low.y)..inside(high.y.ceil()) {
            for x in inside(low.x)..inside(high.x.ceil()) {
                let off = DVec2::new(x as f64, y as f64) + 0.5 - a.0;
                let t = (off.dot(way) / square).clamp(0.0, 1.0);
                if off.distance(t * way) <= widths[0] + t * (widths[1] - widths[0]) {
                    let distance = &mut self.distances[y * TEXELS + x];
                    *distance = distance.min((a.1 + t * (b.1 - a.1)) as f32);
                }
            }
        }
    }

    /// The share of light that arrives at a point, where a fibre lets `through` through.
    pub(crate) fn light(&self, point: DVec3, through: f64) -> f64 {
        let Some((at, distance, _)) = self.place(point) else { return 1.0 };
        let texel = at.floor();
        let near = || -REACH..=REACH;
        let taps = near().flat_map(|y| near().map(move |x| [x, y].map(|step| step as f64)));
        let sum: f64 = taps.map(|step| self.light_behind(texel + DVec2::from_array(step), distance, through)).sum();
        sum / ((2 * REACH + 1) * (2 * REACH + 1)) as f64
    }

    fn light_behind(&self, texel: DVec2, distance: f64, through: f64) -> f64 {
        let is_in_map = texel.cmpge(DVec2::ZERO).all() && texel.max_element() < TEXELS as f64;
        let nearest =
            if is_in_map { self.distances[texel.y as usize * TEXELS + texel.x as usize].into() } else { f64::INFINITY };
        let behind = distance - nearest;
        if behind > self.bias { through.powf((behind / self.spacing).max(1.0)) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use tressfx_core::strand_buffers::StrandShape;
    use tressfx_core::view::{Camera, Pose};

    use crate::rays::Rays;
    use crate::section::Section;

    use super::*;

    /// Two fibres across the axis z of the eye, at the distances 3 and 3.5 from it.
    fn two() -> (Fibres, Rays) {
        let camera = Camera::around(&[glam::Vec3::ONE, glam::Vec3::NEG_ONE], [8, 8]);
        let rays = Rays::new(&camera.view([8, 8]).unwrap());
        let shape = StrandShape { guides: 2, follows: 0, vertices: 2 };
        let mut positions = vec![[0.0; 4]; 4];
        for (strand, z) in [(0, 0.25f32), (1, -0.25)] {
            for (vertex, x) in [(0, -1.0f32), (1, 1.0)] {
                positions[shape.index(strand, vertex) as usize] = [x, 0.0, z, 1.0];
            }
        }
        let section = Section {
            shape,
            pose: Pose::IDENTITY,
            positions: &positions,
            colors: &[[1.0; 4]; 4],
            thickness: &[1.0; 4],
            fibre_radius: 0.01,
            tip_width: 1.0,
        };
        (Fibres::new(&rays, &[section]).unwrap(), rays)
    }

    #[test]
    fn light_falls_with_the_distance_behind_the_nearest_fibre() {
        let (fibres, rays) = two();
        let at = |z: f64| rays.in_eye_space(DVec3::new(0.0, 0.0, z));
        let way = rays.turned(DVec3::NEG_Z);
        for from in [From::Way(way), From::Point(at(5.0))] {
            let light = |spacing: f64, z: f64| DepthMap::new(&fibres, from, spacing).unwrap().light(at(z), 0.7);
            assert_eq!(light(10.0, 0.25), 1.0, "the nearest one is lit");
            assert!((light(100.0, 0.2) - 0.7).abs() < 1e-9, "one fibre at least: {}", light(100.0, 0.2));
            // Half a unit behind, at a spacing of a tenth.
            assert!((light(10.0, -0.25) - 0.7f64.powi(5)).abs() < 1e-5, "{}", light(10.0, -0.25));
            assert!((light(25.0, -0.25) - 0.7f64.powi(2)).abs() < 1e-5);
            assert_eq!(DepthMap::new(&fibres, from, 1.0).unwrap().light(rays.in_eye_space(DVec3::Y), 0.7), 1.0);
        }
    }

    #[test]
    fn a_light_among_the_strands_and_no_strands_give_no_nan() {
        let (fibres, _) = two();
        for cone in [0, 1].map(|segment| fibres.cone(segment)).into_iter().flatten() {
            for point in [cone.a, cone.a.midpoint(cone.b), cone.a + DVec3::splat(1e30)] {
                let map = DepthMap::new(&fibres, From::Point(point), 1.0);
                let light = map.map_or(1.0, |map| map.light(cone.b, 0.5));
                assert!((0.0..=1.0).contains(&light), "{light}");
            }
        }
        let none = Fibres::default();
        let light = DepthMap::new(&none, From::Way(DVec3::X), 1.0).map_or(1.0, |map| map.light(DVec3::ZERO, 0.5));
        assert_eq!(light, 1.0);
    }
}
