//! `hair.sim.field_bounds` in f64.

use glam::{DVec3, Vec3};

/// The least and the largest corner of the box around the triangles of a mesh; none where it has no triangle. Triangles with a vertex that is no place do not count.
pub fn field_bounds(positions: &[Vec3], indices: &[u32]) -> Option<[DVec3; 2]> {
    let is_near = |point: &Vec3| point.is_finite() && point.abs().max_element() < 1e15;
    let triangles = indices.as_chunks::<3>().0.iter().map(|triangle| triangle.map(|index| positions[index as usize]));
    let points = triangles.filter(|corners| corners.iter().all(is_near)).flatten().map(|point| point.as_dvec3());
    points.map(|point| [point, point]).reduce(|[least, most], [point, _]| [least.min(point), most.max(point)])
}
