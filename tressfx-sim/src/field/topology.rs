//! The edges of a mesh that no other triangle closes.

use std::collections::HashMap;

use glam::Vec3;

/// An edge of the boundary of a mesh: from vertex to vertex, how often, 0.
pub(crate) type OpenEdge = [i32; 4];

/// Vertices nearer to each other than this share of the longest side of the mesh are at the same place.
const SAME_PLACE: f32 = 1e-5;

/// The boundary of a mesh as a chain: each edge as often as triangles go along it more than against it. Vertices at the same place are one, since seams
/// of textures are no holes. None where the mesh is closed. Positions are finite, and indices are those of positions, below 2^31.
pub(crate) fn open_edges(positions: &[Vec3], indices: &[u32]) -> Vec<OpenEdge> {
    let welded = welded(positions, indices);
    let mut edges = Vec::with_capacity(indices.len());
    for triangle in indices.as_chunks::<3>().0 {
        let corners = triangle.map(|index| welded[index as usize]);
        for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(from, to)| (corners[from], corners[to])) {
            if from != to {
                edges.push((from.min(to), from.max(to), if from < to { 1 } else { -1 }));
            }
        }
    }
    edges.sort_unstable();
    let same = |one: &(u32, u32, i32), other: &(u32, u32, i32)| (one.0, one.1) == (other.0, other.1);
    let of_edge = |run: &[(u32, u32, i32)]| {
        let times: i32 = run.iter().map(|edge| edge.2).sum();
        (times != 0).then_some([run[0].0 as i32, run[0].1 as i32, times, 0])
    };
    edges.chunk_by(same).filter_map(of_edge).collect()
}

/// For each vertex the first one at its place. Places are those of a grid: two vertices on either side of its lines stay two, and leave a slit.
fn welded(positions: &[Vec3], indices: &[u32]) -> Vec<u32> {
    let used = || indices.iter().map(|&index| positions[index as usize]);
    let (least, most) = (used().fold(Vec3::INFINITY, Vec3::min), used().fold(Vec3::NEG_INFINITY, Vec3::max));
    let size = (SAME_PLACE * (most - least).max_element()).max(f32::MIN_POSITIVE);
    let place = |position: Vec3| ((position - least) / size).round().as_ivec3();
    let mut first_at = HashMap::with_capacity(positions.len());
    let first = |(index, &position): (usize, &Vec3)| *first_at.entry(place(position)).or_insert(index as u32);
    positions.iter().enumerate().map(first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    const CLOSED: [u32; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];

    #[test]
    fn a_closed_mesh_has_none_whatever_its_seams() {
        assert_eq!(open_edges(&CORNERS, &CLOSED), [[0; 4]; 0]);
        let seam: Vec<Vec3> = CORNERS.into_iter().chain([Vec3::new(-0.0, 1e-7, -0.0)]).collect();
        let mut indices = CLOSED;
        (indices[3], indices[6]) = (4, 4);
        assert_eq!(open_edges(&seam, &indices), [[0; 4]; 0]);
    }

    #[test]
    fn a_hole_has_its_rim_and_a_flipped_triangle_has_it_twice() {
        assert_eq!(open_edges(&CORNERS, &CLOSED[3..]), [[0, 1, 1, 0], [0, 2, -1, 0], [1, 2, 1, 0]]);
        let mut flipped = CLOSED;
        flipped.swap(1, 2);
        assert_eq!(open_edges(&CORNERS, &flipped), [[0, 1, 2, 0], [0, 2, -2, 0], [1, 2, 2, 0]]);
    }

    #[test]
    fn triangles_without_an_area_have_none() {
        assert_eq!(open_edges(&CORNERS, &[0, 0, 1, 2, 2, 2]), [[0; 4]; 0]);
    }
}
