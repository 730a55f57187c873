//! Directions, frames and thickness along a strand. All computed in f64 from the f32 vertices.

use glam::{DMat3, DQuat, DVec3, Quat, Vec4};

/// Below this squared sine the root's direction counts as parallel to x, and y is crossed instead.
const PARALLEL: f64 = 1e-4;
/// Where the dot product of two directions is nearer to -1 than this, they count as opposite.
const OPPOSITE: f64 = 1e-8;

/// Distances from each vertex to the next; the last vertex has 0.
pub(super) fn rest_lengths(strand: &[Vec4]) -> impl Iterator<Item = f32> + '_ {
    edges(strand).map(|edge| edge.length() as f32).chain([0.0])
}

/// The unit direction of each edge. An edge of no length takes the direction of the edge before it, those before the first
/// edge that has a length take that one's, and a strand of no length points up (+y).
pub(super) fn directions(strand: &[Vec4]) -> Vec<DVec3> {
    let first = edges(strand).find_map(DVec3::try_normalize).unwrap_or(DVec3::Y);
    let follow = |last: &mut DVec3, edge: DVec3| {
        *last = edge.try_normalize().unwrap_or(*last);
        Some(*last)
    };
    edges(strand).scan(first, follow).collect()
}

/// The tangent at each vertex: the mean direction of the two edges that meet there, in `xyz`; `w` is 0.
pub(super) fn tangents(directions: &[DVec3]) -> impl Iterator<Item = Vec4> + '_ {
    (0..=directions.len()).map(|vertex| {
        let after = directions[vertex.min(directions.len() - 1)];
        let before = directions[vertex.saturating_sub(1)];
        (before + after).try_normalize().unwrap_or(after).as_vec3().extend(0.0)
    })
}

/// The frame at each vertex: its x axis is the direction of the edge that leaves the vertex (the tip keeps the last one).
///
/// The root's other axes are chosen as TressFX 3 does; from edge to edge the frame is turned by the smallest rotation
/// (parallel transport, Bishop 1975, as in Bergou et al. 2008, "Discrete Elastic Rods"), which also defines what happens at
/// an edge that turns back on itself.
pub(super) fn rest_frames(directions: &[DVec3]) -> impl Iterator<Item = Quat> + '_ {
    let mut frame = root_frame(directions[0]);
    (0..=directions.len()).map(move |vertex| {
        if (1..directions.len()).contains(&vertex) {
            let turn = shortest_turn(directions[vertex - 1], directions[vertex]);
            frame = (turn * frame).normalize();
        }
        frame.as_quat()
    })
}

/// Thickness at each vertex, from 1 at the root to 0 at the tip along a quarter of an ellipse: sqrt(1 - s^2), where s is
/// the fraction of the arc length (or of the vertices, where the strand has no length).
pub(super) fn thickness(rest_lengths: &[f32]) -> impl Iterator<Item = f32> + '_ {
    let total: f64 = rest_lengths.iter().map(|&length| f64::from(length)).sum();
    let last = (rest_lengths.len() - 1) as f64;
    let mut arc = 0.0;
    rest_lengths.iter().enumerate().map(move |(vertex, &length)| {
        let s: f64 = if total > 0.0 { arc / total } else { vertex as f64 / last };
        arc += f64::from(length);
        (1.0 - s * s).max(0.0).sqrt() as f32
    })
}

/// The smallest rotation that takes a unit vector to another. Opposite ones are joined by a half turn about any axis across, followed by
/// the small turn that is left: what is left of their sum is rounding, and an angle that followed from it would be anything.
pub fn shortest_turn(from: DVec3, to: DVec3) -> DQuat {
    // glam's takes what is less than 2e-8 apart for the same.
    let arc = |from: DVec3| DQuat::from_vec4(from.cross(to).extend(1.0 + from.dot(to))).normalize();
    if from.dot(to) > OPPOSITE - 1.0 {
        return arc(from);
    }
    arc(-from) * DQuat::from_vec4(from.any_orthonormal_vector().extend(0.0))
}

fn root_frame(direction: DVec3) -> DQuat {
    let by_x = direction.cross(DVec3::X);
    let z = if by_x.length_squared() < PARALLEL { direction.cross(DVec3::Y) } else { by_x }.normalize();
    DQuat::from_mat3(&DMat3::from_cols(direction, z.cross(direction), z))
}

fn edges(strand: &[Vec4]) -> impl Iterator<Item = DVec3> + '_ {
    strand.windows(2).map(|pair| pair[1].truncate().as_dvec3() - pair[0].truncate().as_dvec3())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_turn_takes_opposite_vectors_to_each_other() {
        let from = DVec3::new(0.81, 0.56, 0.17).normalize();
        for apart in [0.0, 1e-16, 1e-15, 1e-12, 1e-8, 1e-6, 1e-3, 1.0, 3.0] {
            let to = (from.any_orthonormal_vector() * apart - from).normalize();
            let turn = shortest_turn(from, to);
            let error = (turn * from).distance(to);
            assert!(error < 1e-11, "{apart:e} apart: {error:e}");
            assert!((turn.length() - 1.0).abs() < 1e-12, "{turn}");
        }
    }
}
