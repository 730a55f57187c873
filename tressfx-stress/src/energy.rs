//! The energy of strands, as far as places alone tell it.

use glam::{Quat, Vec3, Vec4};
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
        ledger.start = ledger.guides().map(|guide| ledger.height(guide, &pose, &pose)).collect();
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
        let farthest = after[range].iter().map(|place| place.truncate().abs().max_element()).fold(0.0, f32::max);
        let noise = ROUNDINGS * f64::from(f32::EPSILON) * f64::from(farthest);
        let fall = mass * f64::from(self.gravity.length()) * length;
        // What rounding makes of places, speeds and heights.
        let rounding = mass * ((noise / sub_step).powi(2) + f64::from(self.gravity.length()) * noise);
        let energy = self.motion(guide, before, after, sub_step) + self.height(guide, before, after);
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

    /// Of the places in the middle of a sub-step, where the speeds are those of the sub-step.
    fn height(&self, guide: usize, before: &[Vec4], after: &[Vec4]) -> f64 {
        let gravity = self.gravity.as_dvec3();
        let of = |i: usize| {
            let middle = (before[i].truncate().as_dvec3() + after[i].truncate().as_dvec3()) / 2.0;
            -self.mass(i) * gravity.dot(middle)
        };
        self.range(guide).map(of).sum()
    }

    fn motion(&self, guide: usize, before: &[Vec4], after: &[Vec4], sub_step: f64) -> f64 {
        let velocity = |i: usize| (after[i].truncate().as_dvec3() - before[i].truncate().as_dvec3()) / sub_step;
        let range = self.range(guide);
        let of_vertices: f64 = range.clone().map(|i| self.mass(i) * velocity(i).length_squared()).sum();
        let of_edge =
            |i: usize| f64::from(self.strands.rest_lengths[i]) * (velocity(i + 1) - velocity(i)).length_squared();
        let of_edges: f64 = (range.start..range.end - 1).map(of_edge).sum();
        0.5 * (of_vertices - self.correction * of_edges)
    }
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
    fn falling(speed: f64) -> f64 {
        let (strands, params) = (rod(), SimParams::default());
        let ledger = Ledger::new(&strands, &params, SolverName::Direct, Quat::IDENTITY, Vec3::ZERO);
        let (angle, sub_step) = (1.0_f64, 1e-3);
        let turning = speed * (3.0 * 9.81 * angle.sin() / 0.1).sqrt();
        let at =
            |angle: f64| vec![Vec4::ZERO, Vec4::new(10.0 * angle.cos() as f32, -10.0 * angle.sin() as f32, 0.0, 1.0)];
        let (before, after) = (at(angle - 0.5 * turning * sub_step), at(angle + 0.5 * turning * sub_step));
        ledger.most_gained(&before, &after, sub_step)
    }

    #[test]
    fn a_rod_that_falls_gains_nothing_and_one_that_is_too_fast_is_found() {
        assert_eq!(falling(0.99), 0.0);
        assert!(falling(1.0) < 1e-4, "{}", falling(1.0));
        // Half of sin(1) has been gained by falling: 10 % of speed are 21 % of it.
        let expected = 0.21 * 0.5 * 1.0_f64.sin();
        assert!((falling(1.1) / expected - 1.0).abs() < 0.01, "{} {expected}", falling(1.1));
    }
}
