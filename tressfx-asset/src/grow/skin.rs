//! The surface that hair grows on: places on it by area, and what is smooth across the edges of its triangles.

use std::collections::HashMap;

use glam::{DVec2, DVec3, Vec3};
use tressfx_core::body::SkinnedMesh;

use super::SkinPlace;

/// A mesh with what is looked up at its places.
pub(super) struct Skin<'a> {
    pub(super) mesh: &'a SkinnedMesh,
    /// The area up to and with each triangle.
    areas: Vec<f64>,
    normals: Vec<Vec3>,
}

/// Directions along the skin in which the texture coordinates of vertices grow, of unit length; zero where they do not grow at all.
pub(super) struct Tangents(Vec<[DVec3; 2]>);

impl<'a> Skin<'a> {
    pub(super) fn new(mesh: &'a SkinnedMesh) -> Self {
        let mut area = 0.0;
        let until = |triangle: &[u32; 3]| {
            let [a, b, c] = corners(mesh, triangle);
            area += 0.5 * (b - a).cross(c - a).length();
            area
        };
        Self { mesh, areas: mesh.triangles.iter().map(until).collect(), normals: smooth_normals(mesh) }
    }

    pub(super) fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    /// The place behind so much of the area; two numbers from 0 to 1 say where in its triangle.
    pub(super) fn place(&self, at: f64, [one, other]: [f64; 2]) -> SkinPlace {
        let triangle = self.areas.partition_point(|&until| until <= at).min(self.areas.len() - 1);
        let one = one.sqrt();
        let barycentric = [1.0 - one, one * (1.0 - other), one * other];
        let sum = |of: &[Vec3]| {
            let corners = self.mesh.triangles[triangle].iter().zip(barycentric);
            corners.map(|(&corner, share)| of[corner as usize].as_dvec3() * share).sum::<DVec3>()
        };
        let normal = sum(&self.normals).normalize_or(DVec3::Y);
        SkinPlace { triangle, barycentric, position: sum(&self.mesh.positions), normal }
    }

    /// The texture coordinates of a place, on a mesh that has them.
    pub(super) fn uv(&self, place: &SkinPlace) -> [f64; 2] {
        let corners = self.mesh.triangles[place.triangle].iter().zip(place.barycentric);
        corners.map(|(&corner, share)| self.mesh.uvs[corner as usize].as_dvec2() * share).sum::<DVec2>().to_array()
    }
}

impl Tangents {
    /// From all triangles at a vertex that continue each other in the picture, by their area.
    pub(super) fn new(mesh: &SkinnedMesh) -> Self {
        let mut sums: HashMap<[u32; 5], [DVec3; 2]> = HashMap::new();
        let vertex = |corner: u32| {
            let ([x, y, z], [u, v]) = (place(mesh, corner), mesh.uvs[corner as usize].to_array());
            [x, y, z, (u + 0.0).to_bits(), (v + 0.0).to_bits()]
        };
        for triangle in &mesh.triangles {
            let [a, b, c] = corners(mesh, triangle);
            let [uv_a, uv_b, uv_c] = triangle.map(|corner| mesh.uvs[corner as usize].as_dvec2());
            let ([p, q], [s, t]) = ([b - a, c - a], [uv_b - uv_a, uv_c - uv_a]);
            let area = p.cross(q).length();
            // Not divided by the determinant, which is small where the picture is stretched: its sign is enough for directions.
            let sign = s.perp_dot(t).signum() * f64::from(s.perp_dot(t) != 0.0);
            let growing = [p * t.y - q * s.y, q * s.x - p * t.x].map(|way| way.normalize_or_zero() * (area * sign));
            for &corner in triangle {
                let [u, v] = sums.entry(vertex(corner)).or_default();
                (*u, *v) = (*u + growing[0], *v + growing[1]);
            }
        }
        let of = |corner| sums.get(&vertex(corner)).copied().unwrap_or_default().map(DVec3::normalize_or_zero);
        Self((0..mesh.positions.len() as u32).map(of).collect())
    }

    /// At a place, across its normal.
    pub(super) fn at(&self, skin: &Skin<'_>, place: &SkinPlace) -> [DVec3; 2] {
        [0, 1].map(|axis| {
            let corners = skin.mesh.triangles[place.triangle].iter().zip(place.barycentric);
            let sum: DVec3 = corners.map(|(&corner, share)| self.0[corner as usize][axis] * share).sum();
            sum.reject_from_normalized(place.normal).normalize_or_zero()
        })
    }
}

fn corners(mesh: &SkinnedMesh, triangle: &[u32; 3]) -> [DVec3; 3] {
    triangle.map(|corner| mesh.positions[corner as usize].as_dvec3())
}

/// Where a vertex is, as bits that can be compared; 0 and -0 are one.
fn place(mesh: &SkinnedMesh, corner: u32) -> [u32; 3] {
    (mesh.positions[corner as usize] + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// Normals of vertices from all triangles at their place, by area. Vertices are often there several times, each with the normal of its own triangle,
/// and hair would part along every edge. A place where two sides meet with opposite normals keeps those of the mesh.
fn smooth_normals(mesh: &SkinnedMesh) -> Vec<Vec3> {
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&corner| *sums.entry(place(mesh, corner)).or_default() += normal);
    }
    let smooth = |(corner, &own): (usize, &Vec3)| {
        let sum = sums.get(&place(mesh, corner as u32)).copied().unwrap_or_default().normalize_or_zero();
        if sum.dot(own) > 0.0 { sum } else { own }
    };
    mesh.normals.iter().enumerate().map(smooth).collect()
}
