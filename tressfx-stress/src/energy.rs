//! The energy of strands, as far as places alone tell it.

use glam::{DVec3, Quat, Vec3, Vec4};
use tressfx_core::strands::Strands;
use tressfx_sim::SimParams;

use crate::case::SolverName;

/// Roundings of a coordinate that a distance may be off by.
pub const ROUNDINGS: f64 = 16.0;

/// Energies of guides, and what they began with. Strands that begin in the pose of their file with joints that want this pose have no
/// energy but that of their place: what moves and what is lifted may never have more, since what is bent has no less than nothing.
#[derive(Clone, Debug)]
pub struct Ledger<'a> {
    strands: &'a Strands,
    gravity: Vec3,
    /// The share of the edges' own inertia that the solver takes off what it has at the vertices.
    correction: f64,
    /// At the beginning, of each guide.
    start: Vec<f64>,
}

impl<'a> Ledger<'a> {
    /// Of strands in the pose of their file on a head with this rotation.
    pub fn new(strands: &'a Strands, params: &SimParams, solver: SolverName, rotation: Quat, center: Vec3) -> Self {
        let correction = match (solver, strands.vertices) {
            (SolverName::Tressfx, _) => 0.0,
            (SolverName::Direct, 2) => 1.0 / 6.0,
            (SolverName::Direct, _) => 5.0 / 36.0,
        };
        let gravity = params.gravity / strands.metres_per_unit;
        let mut ledger = Self { strands, gravity, correction, start: Vec::new() };
        let pose: Vec<Vec4> = strands.rest.iter().map(|p| (rotation * (p.truncate() - center)).extend(p.w)).collect();
        let places: Vec<_> = pose.iter().map(|place| place.truncate().as_dvec3()).collect();
        ledger.start = ledger.guides().map(|guide| ledger.height(guide, &places[ledger.range(guide)])).collect();
        ledger
    }

    fn guides(&self) -> std::ops::Range<usize> {
        0..self.strands.guides as usize
    }

    /// The most that a guide has gained in the sub-step between two poses, as a share of what it would gain if it fell by its
    /// length.
    pub fn most_gained(&self, before: &[Vec4], after: &[Vec4], sub_step: f64) -> f64 {
        self.guides().map(|guide| self.gained(guide, before, after, sub_step)).fold(0.0, f64::max)
    }

    fn gained(&self, guide: usize, before: &[Vec4], after: &[Vec4], sub_step: f64) -> f64 {
        let range = self.range(guide);
        let length: f64 = self.strands.rest_lengths[range.clone()].iter().map(|&length| f64::from(length)).sum();
        let mass = length;
        let farthest =
            after[range.clone()].iter().map(|place| place.truncate().abs().max_element()).fold(0.0, f32::max);
        let noise = ROUNDINGS * f64::from(f32::EPSILON) * f64::from(farthest);
        let fall = mass * f64::from(self.gravity.length()) * length;
        // What rounding makes of places, speeds and heights.
        let rounding = mass * ((noise / sub_step).powi(2) + f64::from(self.gravity.length()) * noise);
        let (places, velocities) = middle(&before[range.clone()], &after[range.clone()], sub_step);
        let end: Vec<_> = after[range].iter().map(|place| place.truncate().as_dvec3()).collect();
        // The speed of a sub-step is that of its middle; a formula of first order, which every strand begins with, means it at the end. What
        // neither of them has was not gained.
        let height = self.height(guide, &places).min(self.height(guide, &end));
        let energy = self.motion(guide, &velocities) + height;
        let gained = energy - self.start[guide] - rounding;
        // Without gravity nothing has to move at all: then by the speed of a fall in a thousandth of that of the Earth.
        let scale = fall.max(1e-2 / f64::from(self.strands.metres_per_unit) * mass * length);
        if gained > 0.0 { gained / scale } else { 0.0 }
    }

    fn range(&self, guide: usize) -> std::ops::Range<usize> {
        let vertices = self.strands.vertices as usize;
        guide * vertices..(guide + 1) * vertices
    }

    /// The masses of the vertices: half of the lengths beside them.
    fn mass(&self, vertex: usize) -> f64 {
        let vertices = self.strands.vertices as usize;
        let before = if vertex.is_multiple_of(vertices) { 0.0 } else { self.strands.rest_lengths[vertex - 1] };
        f64::from(before + self.strands.rest_lengths[vertex]) / 2.0
    }

    /// What its weight has in these places.
    fn height(&self, guide: usize, places: &[DVec3]) -> f64 {
        let gravity = self.gravity.as_dvec3();
        self.range(guide).zip(places).map(|(i, place)| -self.mass(i) * gravity.dot(*place)).sum()
    }

    /// What its masses have at these velocities.
    fn motion(&self, guide: usize, velocities: &[DVec3]) -> f64 {
        let range = self.range(guide);
        let of_vertices: f64 = range.clone().zip(velocities).map(|(i, v)| self.mass(i) * v.length_squared()).sum();
        let of_edge =
            |(i, v): (usize, &[DVec3])| f64::from(self.strands.rest_lengths[i]) * (v[1] - v[0]).length_squared();
        let of_edges: f64 = range.zip(velocities.windows(2)).map(of_edge).sum();
        0.5 * (of_vertices - self.correction * of_edges)
    }
}

/// Places and velocities in the middle of a sub-step between these poses, if each edge turns evenly from the one to the other. The mean of
/// two poses has edges that are too short where they turn, and is too high where a strand falls: by half a percent of the length of an edge
/// that turns by 0.2 rad.
fn middle(before: &[Vec4], after: &[Vec4], sub_step: f64) -> (Vec<DVec3>, Vec<DVec3>) {
    let at = |pose: &[Vec4], i: usize| pose[i].truncate().as_dvec3();
    let mut place = (at(before, 0) + at(after, 0)) / 2.0;
    let mut velocity = (at(after, 0) - at(before, 0)) / sub_step;
    let (mut places, mut velocities) = (vec![place], vec![velocity]);
    for i in 1..before.len() {
        let (from, to) = (at(before, i) - at(before, i - 1), at(after, i) - at(after, i - 1));
        let half = from.angle_between(to) / 2.0;
        // An edge that turns by half a turn has no middle.
        let turns = half.is_finite() && (1e-4..1.5).contains(&half);
        place += (from + to) / 2.0 / if turns { half.cos() } else { 1.0 };
        velocity += (to - from) / sub_step * if turns { half / half.sin() } else { 1.0 };
        places.push(place);
        velocities.push(velocity);
    }
    (places, velocities)
}

#[cfg(test)]
mod tests {
    use tressfx_core::asset::{AssetFormat, HairAsset};
    use tressfx_core::strands::StrandOptions;

    use super::*;

    /// A rigid rod of one edge, 10 cm long, in centimetres.
    fn rod() -> Strands {
        let points = vec![[0.0; 3], [10.0, 0.0, 0.0]];
        let asset = HairAsset::new("rod", AssetFormat::Builtin, points, vec![2]);
        let options = StrandOptions { metres_per_unit: Some(0.01), ..StrandOptions::default() };
        Strands::new(&asset, &options).unwrap()
    }

    /// A rod that falls from the horizontal has the speed `sqrt(3 g sin(a) / l)` (`a` below the horizontal).
    fn falling(speed: f64, sub_step: f64) -> f64 {
        let (strands, params) = (rod(), SimParams::default());
        let ledger = Ledger::new(&strands, &params, SolverName::Direct, Quat::IDENTITY, Vec3::ZERO);
        let angle = 1.0_f64;
        let turning = speed * (3.0 * 9.81 * angle.sin() / 0.1).sqrt();
        let at =
            |angle: f64| vec![Vec4::ZERO, Vec4::new(10.0 * angle.cos() as f32, -10.0 * angle.sin() as f32, 0.0, 1.0)];
        let (before, after) = (at(angle - 0.5 * turning * sub_step), at(angle + 0.5 * turning * sub_step));
        ledger.most_gained(&before, &after, sub_step)
    }

    #[test]
    fn a_rod_that_falls_gains_nothing_and_one_that_is_too_fast_is_found() {
        assert_eq!(falling(0.99, 1e-3), 0.0);
        for sub_step in [1e-3, 1e-2, 0.03] {
            assert!(falling(1.0, sub_step) < 1e-4, "{sub_step}: {}", falling(1.0, sub_step));
        }
        // Half of sin(1) has been gained by falling: 10 % of speed are 21 % of it.
        let expected = 0.21 * 0.5 * 1.0_f64.sin();
        assert!((falling(1.1, 1e-4) / expected - 1.0).abs() < 0.01, "{} {expected}", falling(1.1, 1e-4));
    }
}
