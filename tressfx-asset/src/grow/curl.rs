//! What bends a strand beside its way: curls around it, and wandering.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rand::{Rng, RngExt};

use super::Growth;
use super::strand::set_edges;

/// Directions to which a strand wanders, one after the other on its way.
const TURNS: usize = 5;
/// Halvings of the interval in which the next vertex of a curl is looked for.
const HALVINGS: u32 = 26;

/// Lets a strand wander, more the further from its root. Edges keep their lengths.
pub(super) fn wander(frizz: f64, points: &mut [DVec3], random: &mut impl Rng) {
    let mut signed = || random.random::<f64>() * 2.0 - 1.0;
    let turns: [DVec3; TURNS] = std::array::from_fn(|_| DVec3::new(signed(), signed(), signed()));
    let edge = points[0].distance(points[1]);
    let edges = points.len() - 1;
    let mut aside = DVec3::ZERO;
    for (before, point) in points[1..].iter_mut().enumerate() {
        let way = (before as f64 + 0.5) / edges as f64;
        let at = way * (TURNS - 1) as f64;
        let turn = at.floor().min((TURNS - 2) as f64);
        let mixed = 0.5 - 0.5 * (PI * (at - turn)).cos();
        aside += turns[turn as usize].lerp(turns[turn as usize + 1], mixed) * (frizz * way * edge);
        *point += aside;
    }
    set_edges(points, edge);
}

/// Winds a strand around its own way: a helix whose radius grows evenly from 0 at the root to `curl_radius` at the full length of the growth, with a
/// turn every `curl_length` of the way. Edges keep their lengths, so a curled strand reaches less far. Strands that turn together have one `phase`, in
/// turns, and one direction `towards`, from which it is counted.
pub(super) fn curl(growth: &Growth, points: &mut [DVec3], phase: f64, towards: DVec3) {
    let edge = points[0].distance(points[1]);
    let steeper = f64::from(growth.curl_radius) / f64::from(growth.length);
    let way = Way::new(points);
    let (mut axis, mut gone, mut across) = (points[0], 0.0, towards);
    for vertex in 1..points.len() {
        let along = way.direction(gone / edge);
        across = across.reject_from_normalized(along).normalize_or(along.any_orthonormal_vector());
        let aside = along.cross(across);
        let radius = steeper * edge * vertex as f64;
        let at = |step: f64| {
            let (sine, cosine) = (TAU * (phase + (gone + step) / f64::from(growth.curl_length))).sin_cos();
            axis + along * step + (across * cosine + aside * sine) * radius
        };
        // How far to go along the axis for an edge of the length that it had. Nothing less than a whole edge takes it away from all of a curl.
        let (mut near, mut far) = (0.0, 2.0 * edge);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            let is_short = at(middle).distance(points[vertex - 1]) < edge;
            (near, far) = if is_short { (middle, far) } else { (near, middle) };
        }
        let step = 0.5 * (near + far);
        let next = (at(step) - points[vertex - 1]).normalize_or(along);
        points[vertex] = points[vertex - 1] + next * edge;
        axis += along * step;
        gone += step;
    }
}

/// The directions of a strand as it was.
struct Way(Vec<DVec3>);

impl Way {
    fn new(points: &[DVec3]) -> Self {
        Self(points.windows(2).map(|edge| (edge[1] - edge[0]).normalize_or(DVec3::Y)).collect())
    }

    /// After so many edges, between the middles of edges mixed.
    fn direction(&self, edges: f64) -> DVec3 {
        let last = self.0.len() - 1;
        let at = (edges - 0.5).clamp(0.0, last as f64);
        let from = self.0[at as usize];
        let to = self.0[(at as usize + 1).min(last)];
        from.lerp(to, at.fract()).normalize_or(from)
    }
}
