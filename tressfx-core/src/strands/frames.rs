//! Directions, frames and thickness along a strand. All computed in f64 from the f32 vertices.

use glam::{DMat3, DQuat, DVec3, Quat, Vec4};

/// Below this squared sine the root's direction counts as parallel to x, and y is crossed instead.
const PARALLEL: f64 = 1e-4;

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
            let turn = DQuat::from_rotation_arc(directions[vertex - 1], directions[vertex]);
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

fn root_frame(direction: DVec3) -> DQuat {
    let by_x = direction.cross(DVec3::X);
    let z = if by_x.length_squared() < PARALLEL { direction.cross(DVec3::Y) } else { by_x }.normalize();
    DQuat::from_mat3(&DMat3::from_cols(direction, z.cross(direction), z))
}

fn edges(strand: &[Vec4]) -> impl Iterator<Item = DVec3> + '_ {
    strand.windows(2).map(|pair| pair[1].truncate().as_dvec3() - pair[0].truncate().as_dvec3())
}
