//! Triangles between the roots of guides.
//!
//! There need be no mesh: of each root the neighbourhood is laid into the plane that fits it best, and triangulated there (Delaunay). What two of its corners find is a triangle. So
//! grooms of several parts, and of parts that are open, have triangles where they have guides.

use std::collections::HashMap;

use delaunator::{Point, triangulate};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Neighbours that are asked for.
const NEIGHBOURS: usize = 18;
/// Of those so many say how far roots are from each other.
const NEAR: usize = 6;
/// Edges are no longer than so many times that distance: across a gap there is no hair.
const LONGEST: f64 = 2.5;
/// Rounds of the iteration for the normal; each takes at least a third of what is wrong from a patch that is about as long as wide.
const ROUNDS: usize = 48;

/// The corners of a triangle, in ascending order.
pub(super) type Corners = [u32; 3];

/// The triangles between roots that grow in a like direction.
pub(super) fn triangles(roots: &[DVec3], directions: &[DVec3]) -> Vec<Corners> {
    let entries = roots.iter().enumerate().map(|(guide, root)| GeomWithData::new(root.to_array(), guide));
    let tree = RTree::bulk_load(entries.collect());
    let near = |guide: usize| {
        let by_distance = tree.nearest_neighbor_iter(roots[guide].to_array()).map(|entry| entry.data);
        // On the other side of an ear hair grows the other way.
        let of_this_side =
            by_distance.filter(|&other| other != guide && directions[guide].dot(directions[other]) > 0.0);
        of_this_side.take(NEIGHBOURS).collect::<Vec<usize>>()
    };
    let near: Vec<Vec<usize>> = (0..roots.len()).into_par_iter().map(near).collect();
    let spacing = |guide: usize| {
        let nearest = near[guide].iter().take(NEAR).map(|&other| roots[other].distance(roots[guide]));
        nearest.sum::<f64>() / near[guide].len().clamp(1, NEAR) as f64
    };
    let spacing: Vec<f64> = (0..roots.len()).map(spacing).collect();
    let stars: Vec<Vec<Corners>> =
        (0..roots.len()).into_par_iter().map(|guide| star(roots, guide, &near[guide], directions[guide])).collect();
    let mut found: HashMap<Corners, u32> = HashMap::new();
    stars.into_iter().flatten().for_each(|corners| *found.entry(corners).or_default() += 1);
    let is_short = |corners: &Corners| {
        let longest = LONGEST * corners.iter().map(|&corner| spacing[corner as usize]).fold(0.0, f64::max);
        let edges =
            [(0, 1), (1, 2), (2, 0)].map(|(a, b)| [corners[a], corners[b]].map(|corner| roots[corner as usize]));
        edges.iter().all(|[a, b]| a.distance(*b) <= longest)
    };
    let agreed = found.into_iter().filter(|(_, times)| *times > 1).map(|(corners, _)| corners);
    let mut triangles: Vec<Corners> = agreed.filter(is_short).collect();
    triangles.sort_unstable();
    triangles
}

/// The triangles at a root, in its own neighbourhood.
fn star(roots: &[DVec3], guide: usize, near: &[usize], direction: DVec3) -> Vec<Corners> {
    let offsets: Vec<DVec3> = near.iter().map(|&other| roots[other] - roots[guide]).collect();
    let (x, y) = normal(&offsets, direction).any_orthonormal_pair();
    let plane = |offset: &DVec3| DVec2::new(offset.dot(x), offset.dot(y));
    // By the largest distance, so that numbers are of one size whatever the unit.
    let size = offsets.iter().map(|offset| offset.length()).fold(0.0, f64::max);
    if size <= 0.0 {
        return Vec::new();
    }
    let points: Vec<Point> = [DVec2::ZERO]
        .into_iter()
        .chain(offsets.iter().map(plane))
        .map(|point| Point { x: point.x / size, y: point.y / size })
        .collect();
    let global = |corner: usize| if corner == 0 { guide as u32 } else { near[corner - 1] as u32 };
    let triangulated = triangulate(&points).triangles;
    let of_guide = triangulated.as_chunks::<3>().0.iter().filter(|corners| corners.contains(&0));
    let sorted = |corners: &[usize; 3]| {
        let mut corners = corners.map(global);
        corners.sort_unstable();
        corners
    };
    of_guide.map(sorted).collect()
}

/// The normal of the plane through the origin that fits points best: the direction in which they are spread least.
fn normal(points: &[DVec3], start: DVec3) -> DVec3 {
    let outer = |point: &DVec3| DMat3::from_cols(*point * point.x, *point * point.y, *point * point.z);
    let spread: DMat3 = points.iter().map(outer).fold(DMat3::ZERO, |sum, one| sum + one);
    let trace = spread.x_axis.x + spread.y_axis.y + spread.z_axis.z;
    let most = DMat3::from_diagonal(DVec3::splat(trace)) - spread;
    (0..ROUNDS).fold(start, |direction, _| (most * direction).normalize_or(start))
}
