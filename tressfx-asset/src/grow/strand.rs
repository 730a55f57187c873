//! The line of a strand, before anything changes it: from the skin to where it is combed.

use glam::{DVec3, Vec3};
use rand::{Rng, RngExt};

use super::skin::{Skin, Tangents};
use super::{Direction, Growth, SkinPlace};

/// Where strands of a growth go.
pub(super) struct Ways<'a> {
    growth: &'a Growth,
    skin: &'a Skin<'a>,
    /// For a map of directions alone.
    tangents: Option<Tangents>,
}

impl<'a> Ways<'a> {
    pub(super) fn new(growth: &'a Growth, skin: &'a Skin<'a>) -> Self {
        let tangents = matches!(growth.direction, Direction::Map(_)).then(|| Tangents::new(skin.mesh));
        Self { growth, skin, tangents }
    }

    /// A strand that leaves the skin along its normal and bends to where it is combed, behind those that are there.
    pub(super) fn strand(&self, place: &SkinPlace, random: &mut impl Rng, points: &mut Vec<DVec3>) {
        let growth = self.growth;
        let mut signed = || random.random::<f64>() * 2.0 - 1.0;
        let shake = DVec3::new(signed(), signed(), signed()) * f64::from(growth.noise);
        let shorter = 0.5 + 0.5 * signed();
        let normal = (place.normal + 0.5 * shake).normalize_or(place.normal);
        let (way, share) = self.combed(place, normal);
        let along = (way + shake.reject_from_normalized(normal)).normalize_or_zero();
        let map = growth.length_map.as_ref().map_or(1.0, |map| map.at::<1>(self.skin.uv(place))[0]);
        let length = f64::from(growth.length) * map * (1.0 - f64::from(growth.variation) * shorter);
        let edges = f64::from(growth.vertices - 1);
        let mut point = place.position;
        points.push(point);
        for edge in 0..growth.vertices - 1 {
            let way = (f64::from(edge) + 0.5) / edges;
            // Most of the bend is near the root, as hair leaves its follicle.
            let down = f64::from(growth.lie) * share * (1.0 - (1.0 - way) * (1.0 - way));
            point += (normal * (1.0 - down) + along * down).normalize_or(normal) * (length / edges);
            points.push(point);
        }
    }

    /// The direction at the tip of a strand, and what share of the way to it the strand is bent.
    fn combed(&self, place: &SkinPlace, normal: DVec3) -> (DVec3, f64) {
        match &self.growth.direction {
            Direction::Normal => (DVec3::ZERO, 0.0),
            Direction::Comb(comb) => (comb.as_dvec3().reject_from_normalized(normal).normalize_or_zero(), 1.0),
            Direction::Map(map) => {
                let [along_u, along_v] = self.tangents.as_ref().map_or([DVec3::ZERO; 2], |of| of.at(self.skin, place));
                let [u, v, up] = map.at::<3>(self.skin.uv(place)).map(|part| 2.0 * part - 1.0);
                let way = along_u * u + along_v * v + normal * up;
                (way.normalize_or_zero(), way.length().min(1.0))
            }
        }
    }
}

/// Sets the edges of a strand to one length, from the root on; each keeps its direction.
pub(super) fn set_edges(points: &mut [DVec3], edge: f64) {
    let Some(mut before) = points.first().copied() else { return };
    let mut way = Vec3::Y.as_dvec3();
    let mut last = before;
    for point in &mut points[1..] {
        way = (*point - before).normalize_or(way);
        before = *point;
        *point = last + way * edge;
        last = *point;
    }
}
