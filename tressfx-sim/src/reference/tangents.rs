//! `hair.sim.tangents` in f64.

use glam::{DVec3, Vec4};

use super::roots::{GuideRoot, RootMotion};
use super::vector::{NO_LENGTH, direction_or, position, rotate};
use crate::step::Step;

/// The follow strand of a guide at an offset in the space of the rest pose. `root` is the guide's, if it has one of its own.
pub fn follow_strand(step: &Step, guide: &[DVec3], offset: Vec4, root: Option<&GuideRoot>) -> Vec<DVec3> {
    let offset = rotate(RootMotion::new(step, root).rotation, position(offset));
    let last = (guide.len() - 1) as f64;
    let spread = |i: usize| 1.0 + f64::from(step.tip_separation) * i as f64 / last;
    guide.iter().enumerate().map(|(i, &point)| point + spread(i) * offset).collect()
}

/// Unit tangents of a strand towards its tip.
pub fn tangents(strand: &[DVec3]) -> Vec<DVec3> {
    let edges: Vec<DVec3> = strand.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let direction = |edge: Option<&DVec3>| edge.map_or(DVec3::ZERO, |&edge| direction_or(edge, DVec3::ZERO));
    let tangent = |i: usize| {
        let before = i.checked_sub(1).and_then(|before| edges.get(before));
        let sum = direction(before) + direction(edges.get(i));
        if sum.length_squared() > NO_LENGTH { sum.normalize() } else { nearest_edge(&edges, i) }
    };
    (0..strand.len()).map(tangent).collect()
}

/// The direction of the nearest edge that has one, first towards the tip, then towards the root; up if none has.
fn nearest_edge(edges: &[DVec3], vertex: usize) -> DVec3 {
    let has_length = |edge: &&DVec3| edge.length_squared() > NO_LENGTH;
    let at = |distance: usize| {
        let after = edges.get(vertex + distance).filter(has_length);
        after.or_else(|| edges.get(vertex.checked_sub(distance + 1)?).filter(has_length))
    };
    (0..=edges.len()).find_map(at).map_or(DVec3::Y, |edge| edge.normalize())
}
