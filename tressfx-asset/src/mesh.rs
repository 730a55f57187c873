//! Triangle meshes: what stands in the scene beside the hair.

mod primitives;

use std::path::Path;

use glam::{Vec2, Vec3};
use thiserror::Error;

use tressfx_core::body::{BodyError, Influences, SkinnedMesh};
use tressfx_core::strands::Bounds;

/// A triangle mesh with a normal for every vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Unit normals, as many as positions.
    pub normals: Vec<Vec3>,
    /// Three per triangle, counter-clockwise seen from outside; each below the number of positions.
    pub indices: Vec<u32>,
}

/// Why a mesh cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The system could not read the file.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is not a Wavefront `.obj`, or breaks its rules.
    #[error("{file}: not a valid OBJ: {source}")]
    Obj {
        /// The file.
        file: String,
        /// What the parser says.
        source: tobj::LoadError,
    },
    /// The file holds no triangle.
    #[error("{file}: no faces")]
    Empty {
        /// The file.
        file: String,
    },
    /// A position is NaN or infinite.
    #[error("{file}: vertex {vertex} is not finite")]
    NotFinite {
        /// The file.
        file: String,
        /// The vertex, from 0.
        vertex: usize,
    },
    /// The file is no body that hair can grow on.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The file has more vertices than a 32-bit index reaches.
    #[error("{file}: more than 2^32 vertices")]
    TooLarge {
        /// The file.
        file: String,
    },
}

impl Mesh {
    /// Reads a Wavefront `.obj` file: all its objects as one mesh, triangulated, materials passed over. Normals that the
    /// file does not have are computed.
    ///
    /// # Errors
    /// Where the file cannot be read, breaks the format's rules, has no faces, or has a position that is not finite.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| MeshError::Io { file: file.clone(), source })?;
        Self::from_obj(&file, &bytes)
    }

    /// As [`Mesh::read`], from memory; `file` is what messages call it.
    ///
    /// # Errors
    /// As [`Mesh::read`].
    pub fn from_obj(file: &str, bytes: &[u8]) -> Result<Self, MeshError> {
        Ok(load(file, bytes)?.0)
    }

    /// Adds another mesh.
    pub fn append(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.indices.extend(other.indices.iter().map(|index| index + first));
    }

    /// The same as the skin of a body whose only joint is `root`.
    ///
    /// # Errors
    /// Arrays that do not fit each other.
    pub fn skinned(&self, name: &str) -> Result<SkinnedMesh, BodyError> {
        let mesh = SkinnedMesh {
            name: name.to_owned(),
            positions: self.positions.clone(),
            normals: self.normals.clone(),
            triangles: self.indices.as_chunks::<3>().0.to_vec(),
            joints: vec!["root".to_owned()],
            influences: vec![Influences::rigid(0); self.positions.len()],
            ..SkinnedMesh::default()
        };
        mesh.check()?;
        Ok(mesh)
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.positions.iter().copied())
    }

    fn from_model(model: &tobj::Mesh) -> Self {
        let vectors = |values: &[f32]| values.as_chunks::<3>().0.iter().map(|&v| Vec3::from(v)).collect::<Vec<_>>();
        let (positions, normals) = (vectors(&model.positions), vectors(&model.normals));
        let indices = model.indices.clone();
        let usable = normals.len() == positions.len() && normals.iter().all(|n| n.try_normalize().is_some());
        let normals = if usable {
            normals.into_iter().map(Vec3::normalize).collect()
        } else {
            vertex_normals(&positions, &indices)
        };
        Self { positions, normals, indices }
    }

    fn checked(self, file: &str) -> Result<Self, MeshError> {
        let file = file.to_owned();
        if self.indices.is_empty() {
            return Err(MeshError::Empty { file });
        }
        match self.positions.iter().position(|position| !position.is_finite()) {
            Some(vertex) => Err(MeshError::NotFinite { file, vertex }),
            None => Ok(self),
        }
    }
}

/// Reads a Wavefront `.obj` file as the skin of a body whose only joint is `root`, with its texture coordinates where all of it has them. A vertex with several
/// of them becomes several vertices.
///
/// # Errors
/// As [`Mesh::read`].
pub fn skinned_obj(file: &str, bytes: &[u8]) -> Result<SkinnedMesh, MeshError> {
    let (mesh, uvs) = load(file, bytes)?;
    let mesh = SkinnedMesh { uvs, ..mesh.skinned(file)? };
    mesh.check()?;
    Ok(mesh)
}

/// A mesh, and its texture coordinates from the upper left corner down; none where a part of it has none.
fn load(file: &str, mut bytes: &[u8]) -> Result<(Mesh, Vec<Vec2>), MeshError> {
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let (models, _) = tobj::load_obj_buf(&mut bytes, &options, |_| Err(tobj::LoadError::OpenFileFailed))
        .map_err(|source| MeshError::Obj { file: file.to_owned(), source })?;
    let (mut mesh, mut uvs) = (Mesh::default(), Vec::new());
    for model in &models {
        u32::try_from(mesh.positions.len() + model.mesh.positions.len())
            .map_err(|_| MeshError::TooLarge { file: file.to_owned() })?;
        mesh.append(&Mesh::from_model(&model.mesh));
        uvs.extend(model.mesh.texcoords.as_chunks::<2>().0.iter().map(|&[u, v]| Vec2::new(u, 1.0 - v)));
    }
    if uvs.len() != mesh.positions.len() {
        uvs.clear();
    }
    Ok((mesh.checked(file)?, uvs))
}

/// Normals of vertices from the faces around them, weighted by area; up where a vertex has no face with an area.
pub(crate) fn vertex_normals(positions: &[Vec3], indices: &[u32]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in indices.as_chunks::<3>().0 {
        let corners = triangle.map(|index| positions[index as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        triangle.iter().for_each(|&index| normals[index as usize] += normal);
    }
    normals.into_iter().map(|normal| normal.normalize_or(Vec3::Y)).collect()
}
