//! Which triangle of a mesh each root grows on.

use glam::{DMat3, DQuat, DVec2, DVec3, Vec3};
use rayon::prelude::*;
use tressfx_core::body::{BodyError, SkinnedMesh};
use tressfx_core::strands::Strands;

use super::nearest::{Nearest, Tree};

/// A triangle whose sine between two edges is smaller than this is degenerate.
const FLAT: f64 = 1e-6;

/// Why roots cannot be bound to a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BindError {
    /// The mesh is not sound.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// All triangles are degenerate.
    #[error("{mesh}: none of {triangles} triangles has an area")]
    NoArea {
        /// The mesh.
        mesh: String,
        /// How many triangles it has.
        triangles: usize,
    },
    /// A root that is no point.
    #[error("root of strand {strand} is not finite")]
    NotFinite {
        /// The strand, as the caller counts them.
        strand: usize,
    },
    /// A root that is further from the mesh than it may be.
    #[error("root of strand {strand} is {distance} away from {mesh}, more than {most}")]
    TooFar {
        /// The mesh.
        mesh: String,
        /// The strand, as the caller counts them.
        strand: usize,
        /// How far, in the unit of the mesh.
        distance: f64,
        /// How far it may be.
        most: f64,
    },
}

/// A root on a triangle, in the bind pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundRoot {
    /// The triangle of the mesh.
    pub triangle: usize,
    /// Its vertices.
    pub corners: [u32; 3],
    /// Where on it: along the edges from the first corner to the second and to the third; the barycentric coordinates of these corners.
    pub place: DVec2,
    /// From there to the root, in the frame.
    pub offset: DVec3,
    /// The tangent and the bitangent, each as a sum of these two edges.
    pub edges: [DVec2; 2],
    /// The frame: takes x to the tangent, y to the bitangent, z to the normal.
    pub frame: DQuat,
    /// Where the root is.
    pub root: DVec3,
}

/// The triangles of all roots of a section.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Binding {
    /// In the order of the roots.
    pub roots: Vec<BoundRoot>,
    /// What to know about it.
    pub report: BindReport,
}

/// How far roots are from the mesh that they are bound to, in its unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BindReport {
    /// Roots.
    pub roots: usize,
    /// Half of them are nearer than this.
    pub median: f64,
    /// 99 of 100 are nearer than this.
    pub most: f64,
    /// The distance of the furthest.
    pub largest: f64,
    /// Which root that is.
    pub furthest: usize,
    /// Triangles without an area, which nothing is bound to.
    pub degenerate: usize,
}

impl Binding {
    /// Binds the guides of a section; the binding is in their order. `most` is how far a root may be from the mesh, in its unit.
    ///
    /// # Errors
    /// As [`Binding::of_roots`]; strands are counted as in their file.
    pub fn of_guides(strands: &Strands, mesh: &SkinnedMesh, most: f64) -> Result<Self, BindError> {
        let roots: Vec<Vec3> =
            strands.rest.iter().step_by(strands.vertices as usize).map(|root| root.truncate()).collect();
        let in_file = |guide: usize| strands.order.get(guide).map_or(guide, |&strand| strand as usize);
        Self::of_roots(&roots, mesh, most).map_err(|error| match error {
            BindError::NotFinite { strand } => BindError::NotFinite { strand: in_file(strand) },
            BindError::TooFar { mesh, strand, distance, most } => {
                BindError::TooFar { mesh, strand: in_file(strand), distance, most }
            }
            other => other,
        })
    }

    /// Binds each root to the nearest triangle of a mesh in its bind pose; triangles without an area are left out.
    ///
    /// # Errors
    /// A mesh that is not sound or has no triangle with an area, a root that is not finite, or one that is further away than `most`.
    pub fn of_roots(roots: &[Vec3], mesh: &SkinnedMesh, most: f64) -> Result<Self, BindError> {
        mesh.check()?;
        let corner = |corner: u32| mesh.positions[corner as usize].as_dvec3();
        let triangles: Vec<[DVec3; 3]> = mesh.triangles.iter().map(|corners| corners.map(corner)).collect();
        let sound: Vec<usize> = (0..triangles.len()).filter(|&triangle| has_area(&triangles[triangle])).collect();
        let degenerate = triangles.len() - sound.len();
        if sound.is_empty() {
            return Err(BindError::NoArea { mesh: mesh.name.clone(), triangles: triangles.len() });
        }
        if let Some(strand) = roots.iter().position(|root| !root.is_finite()) {
            return Err(BindError::NotFinite { strand });
        }
        let tree = Tree::new(&triangles, sound);
        let found: Vec<_> = roots.par_iter().map(|root| tree.nearest(root.as_dvec3())).collect();
        let found: Vec<Nearest> = found.into_iter().flatten().collect();
        let bound = roots.iter().zip(&found).map(|(root, found)| {
            let corners = mesh.triangles[found.triangle];
            BoundRoot::new(found.triangle, corners, triangles[found.triangle], found.point, root.as_dvec3())
        });
        let roots: Vec<_> = bound.collect();
        let report = BindReport::new(found.iter().map(|found| found.squared.sqrt()).collect(), degenerate);
        if report.largest > most {
            let (mesh, strand, distance) = (mesh.name.clone(), report.furthest, report.largest);
            return Err(BindError::TooFar { mesh, strand, distance, most });
        }
        Ok(Self { roots, report })
    }
}

impl BoundRoot {
    /// A root that belongs to a point of a triangle.
    fn new(triangle: usize, corners: [u32; 3], [a, b, c]: [DVec3; 3], point: DVec3, root: DVec3) -> Self {
        let (one, other) = (b - a, c - a);
        let normal = one.cross(other).normalize();
        let tangent = one.normalize();
        let bitangent = normal.cross(tangent);
        // A vector of the plane as a sum of the two edges.
        let along = [tangent, bitangent].map(|axis| DVec2::new(one.dot(axis), other.dot(axis)));
        let determinant = along[0].x * along[1].y - along[0].y * along[1].x;
        let in_edges = |vector: DVec3| {
            let (x, y) = (vector.dot(tangent), vector.dot(bitangent));
            DVec2::new(x * along[1].y - y * along[0].y, y * along[0].x - x * along[1].x) / determinant
        };
        let frame = DQuat::from_mat3(&DMat3::from_cols(tangent, bitangent, normal)).normalize();
        Self {
            triangle,
            corners,
            place: in_edges(point - a),
            offset: frame.inverse() * (root - point),
            edges: [in_edges(tangent), in_edges(bitangent)],
            frame,
            root,
        }
    }
}

impl BindReport {
    fn new(distances: Vec<f64>, degenerate: usize) -> Self {
        let furthest = (0..distances.len()).max_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap_or(0);
        let mut sorted = distances;
        sorted.sort_by(f64::total_cmp);
        let at = |share: usize| sorted.get((sorted.len() * share / 100).min(sorted.len().saturating_sub(1)));
        let [median, most, largest] = [50, 99, 100].map(|share| at(share).copied().unwrap_or(0.0));
        Self { roots: sorted.len(), median, most, largest, furthest, degenerate }
    }
}

fn has_area([a, b, c]: &[DVec3; 3]) -> bool {
    let (one, other) = (*b - *a, *c - *a);
    one.cross(other).length() > FLAT * one.length() * other.length()
}
