//! `hair.sim.interpolate` in f64.

use glam::{DVec2, DVec3};
use tressfx_core::hash::hash;

use super::vector::{across, direction_or};
use crate::interpolate::{BetweenGuides, InterpolationUniform};

/// A strand between three guides, the nearest first, all of which have the vertices that the uniform says.
pub fn interpolate(
    uniform: &InterpolationUniform,
    strand: &BetweenGuides,
    index: u32,
    guides: [&[DVec3]; 3],
) -> Vec<DVec3> {
    let curve = mean(uniform, strand, guides);
    let last = f64::from(uniform.vertices - 1);
    let step = f64::from(strand.length) * (curve.len() - 1) as f64 / last;
    let is_spline = uniform.vertices != uniform.guide_vertices || strand.length < 1.0;
    let at = |vertex: u32| if is_spline { spline(&curve, f64::from(vertex) * step) } else { curve[vertex as usize] };
    let plain: Vec<DVec3> = (0..uniform.vertices).map(at).collect();
    if uniform.noise > 0.0 { shaken(uniform, index, &plain, guides[1][0] - guides[0][0]) } else { plain }
}

/// At the vertices of the guides.
fn mean(uniform: &InterpolationUniform, strand: &BetweenGuides, guides: [&[DVec3]; 3]) -> Vec<DVec3> {
    let three = |two: glam::Vec2| {
        let two = two.as_dvec2();
        DVec3::new(1.0 - two.x - two.y, two.x, two.y)
    };
    let sum = |shares: DVec3, of: [DVec3; 3]| of[0] * shares.x + of[1] * shares.y + of[2] * shares.z;
    let root = sum(three(strand.root_shares), guides.map(|guide| guide[0]));
    let shares = three(strand.edge_shares);
    let (mut mean, mut clumped, mut point, mut direction) = (root, root, root, DVec3::Y);
    let mut points = vec![root];
    for vertex in 1..guides[0].len() {
        let edges = guides.map(|guide| guide[vertex] - guide[vertex - 1]);
        let length = shares.dot(DVec3::from(edges.map(DVec3::length)));
        direction = direction_or(sum(shares, edges), direction_or(edges[0], direction));
        mean += direction * length;
        let share = vertex as f64 / (guides[0].len() - 1) as f64;
        let next = mean.lerp(guides[0][vertex], f64::from(uniform.clump) * share.powf(uniform.clump_falloff.into()));
        point += direction_or(next - clumped, direction) * length;
        clumped = next;
        points.push(point);
    }
    points
}

/// The curve of Catmull and Rom (1974) through points; `at` counts them. It goes straight on at both ends.
fn spline(points: &[DVec3], at: f64) -> DVec3 {
    let last = points.len() - 1;
    let number = (at.floor() as usize).min(last - 1);
    let [start, end] = [points[number], points[number + 1]];
    let before = if number > 0 { points[number - 1] } else { start * 2.0 - end };
    let after = if number + 2 <= last { points[number + 2] } else { end * 2.0 - start };
    let t = at - number as f64;
    let tangents = [(end - before) * 0.5, (after - start) * 0.5];
    // As Hermite's curve with these tangents.
    let (square, cube) = (t * t, t * t * t);
    start * (2.0 * cube - 3.0 * square + 1.0)
        + tangents[0] * (cube - 2.0 * square + t)
        + end * (3.0 * square - 2.0 * cube)
        + tangents[1] * (cube - square)
}

/// Moved aside by smooth noise, across the strand.
fn shaken(uniform: &InterpolationUniform, index: u32, plain: &[DVec3], mut side: DVec3) -> Vec<DVec3> {
    let last = (plain.len() - 1) as f64;
    let (mut gone, mut along, mut points) = (0.0, DVec3::Y, vec![plain[0]]);
    let mut before = plain[0];
    for (vertex, pair) in plain.windows(2).enumerate() {
        let edge = pair[1] - pair[0];
        gone += edge.length();
        let direction = direction_or(edge, along);
        side = direction_or(side - direction * direction.dot(side), across(direction));
        let wave = f64::from(uniform.noise_waves) * (vertex + 1) as f64 / last;
        let aside = noise(index, wave) * f64::from(uniform.noise) * gone;
        let point = pair[1] + side * aside.x + direction.cross(side) * aside.y;
        along = direction_or(point - before, along);
        before = point;
        points.push(point);
    }
    points
}

fn noise(index: u32, at: f64) -> DVec2 {
    let random = |wave: u32| {
        let seed = index.wrapping_mul(512).wrapping_add(wave * 2);
        DVec2::new(hash(seed), hash(seed.wrapping_add(1))) * 2.0 - 1.0
    };
    let (wave, share) = (at.floor(), at - at.floor());
    random(wave as u32).lerp(random(wave as u32 + 1), share * share * (3.0 - 2.0 * share))
}
