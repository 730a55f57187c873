//! Meshes that hair grows on and that move: skinned by joints and changed by morph targets.
//!
//! A vertex is `p + sum(m_i * morph_i)`, then the sum of what the matrices of its joints make of that, each by its weight: linear blend skinning, as
//! glTF 2.0 has it. With the identity for every joint a mesh is in its bind pose, in which hair is bound to it.

use glam::{Affine3A, Vec2, Vec3, Vec4};
use thiserror::Error;

/// The joints that move a vertex or a strand, and by what share. Weights sum to 1; a joint without weight is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Influences {
    /// Joints, as the mesh or the file counts them.
    pub joints: [u32; 4],
    /// The share of each.
    pub weights: [f32; 4],
}

impl Influences {
    /// One joint alone.
    pub fn rigid(joint: u32) -> Self {
        Self { joints: [joint, 0, 0, 0], weights: [1.0, 0.0, 0.0, 0.0] }
    }

    /// Of any number of joints the four with the most weight, by weights that sum to 1 then. `None` where a weight is negative or not finite, or
    /// none is above 0.
    pub fn strongest(pairs: &[(u32, f32)]) -> Option<Self> {
        if pairs.iter().any(|&(_, weight)| !weight.is_finite() || weight < 0.0) {
            return None;
        }
        let mut pairs: Vec<_> = pairs.iter().copied().filter(|&(_, weight)| weight > 0.0).collect();
        pairs.sort_by(|one, other| other.1.total_cmp(&one.1));
        pairs.truncate(4);
        let sum: f64 = pairs.iter().map(|&(_, weight)| f64::from(weight)).sum();
        let mut strongest = Self::default();
        for (slot, &(joint, weight)) in pairs.iter().enumerate() {
            strongest.joints[slot] = joint;
            strongest.weights[slot] = (f64::from(weight) / sum) as f32;
        }
        (sum > 0.0).then_some(strongest)
    }
}

/// What a morph target moves a vertex by, at a weight of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MorphOffset {
    /// The vertex.
    pub vertex: u32,
    /// Added to its position.
    pub position: Vec3,
    /// Added to its normal.
    pub normal: Vec3,
}

/// A morph target: the vertices that it moves, no others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Morph {
    /// Its name, where it has one.
    pub name: String,
    /// By ascending vertices.
    pub offsets: Vec<MorphOffset>,
}

/// A mesh with joints and morph targets, in its bind pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinnedMesh {
    /// What messages call it.
    pub name: String,
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Unit normals, as many as positions.
    pub normals: Vec<Vec3>,
    /// Corners of triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Names of the joints, which are counted by them.
    pub joints: Vec<String>,
    /// One a vertex.
    pub influences: Vec<Influences>,
    /// Morph targets.
    pub morphs: Vec<Morph>,
    /// Texture coordinates, one a vertex, or none at all. (0, 0) is the upper left corner of a picture, (1, 1) the lower right one.
    pub uvs: Vec<Vec2>,
    /// Unit tangents, one a vertex, or none at all: the direction in which the first texture coordinate grows, and in the fourth number 1 or -1, by which the cross product of normal and
    /// tangent is the bitangent, as glTF has it.
    pub tangents: Vec<Vec4>,
}

/// A pose of a [`SkinnedMesh`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshPose {
    /// Of each joint, from the bind pose to where it is now.
    pub joints: Vec<Affine3A>,
    /// Of each morph target; 0 is the mesh without it.
    pub morphs: Vec<f32>,
}

/// What does not fit in a mesh or a pose of it.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BodyError {
    /// There are no triangles, or no vertices.
    #[error("{mesh}: no {what}")]
    Empty {
        /// The mesh.
        mesh: String,
        /// What there is none of.
        what: &'static str,
    },
    /// An array has another number of entries than it must.
    #[error("{mesh}: {found} {what}, but must be {expected}")]
    Count {
        /// The mesh.
        mesh: String,
        /// The array.
        what: &'static str,
        /// Its entries.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// An index that names nothing.
    #[error("{mesh}: {what} {place} names {index} of {count}")]
    Index {
        /// The mesh.
        mesh: String,
        /// What has the index.
        what: &'static str,
        /// Which of them.
        place: usize,
        /// The index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A value that is not finite, or weights that do not sum to 1.
    #[error("{mesh}: {what} {place} is not finite, or its weights do not sum to 1")]
    Value {
        /// The mesh.
        mesh: String,
        /// What has the value.
        what: &'static str,
        /// Which of them.
        place: usize,
    },
}

impl SkinnedMesh {
    /// The pose in which every joint and every morph target leaves the mesh as it is.
    pub fn bind_pose(&self) -> MeshPose {
        MeshPose { joints: vec![Affine3A::IDENTITY; self.joints.len()], morphs: vec![0.0; self.morphs.len()] }
    }

    /// Whether its arrays fit each other.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<(), BodyError> {
        let mesh = || self.name.clone();
        let vertices = self.positions.len();
        for (what, count) in
            [("vertices", vertices), ("triangles", self.triangles.len()), ("joints", self.joints.len())]
        {
            if count == 0 {
                return Err(BodyError::Empty { mesh: mesh(), what });
            }
        }
        for (what, found) in [("normals", self.normals.len()), ("influences", self.influences.len())] {
            if found != vertices {
                return Err(BodyError::Count { mesh: mesh(), what, found, expected: vertices });
            }
        }
        for (what, found) in [("texture coordinates", self.uvs.len()), ("tangents", self.tangents.len())] {
            if found != 0 && found != vertices {
                return Err(BodyError::Count { mesh: mesh(), what, found, expected: vertices });
            }
        }
        let corners = self.triangles.iter().enumerate();
        let corners = corners.flat_map(|(place, corners)| corners.map(|index| ("triangle", place, index, vertices)));
        let joints = self.influences.iter().enumerate();
        let joints = joints
            .flat_map(|(place, of)| of.joints.map(|index| ("influence of vertex", place, index, self.joints.len())));
        let moved = self.morphs.iter().flat_map(|morph| morph.offsets.iter().enumerate());
        let moved = moved.map(|(place, offset)| ("morph offset", place, offset.vertex, vertices));
        for (what, place, index, count) in corners.chain(joints).chain(moved) {
            if index as usize >= count {
                return Err(BodyError::Index { mesh: mesh(), what, place, index, count });
            }
        }
        self.check_values()
    }

    fn check_values(&self) -> Result<(), BodyError> {
        let value = |what, place| Err(BodyError::Value { mesh: self.name.clone(), what, place });
        if let Some(place) = self.positions.iter().position(|position| !position.is_finite()) {
            return value("position", place);
        }
        if let Some(place) = self.normals.iter().position(|normal| !normal.is_finite()) {
            return value("normal", place);
        }
        if let Some(place) = self.uvs.iter().position(|uv| !uv.is_finite()) {
            return value("texture coordinate", place);
        }
        if let Some(place) = self.tangents.iter().position(|tangent| !tangent.is_finite()) {
            return value("tangent", place);
        }
        let sums_to_1 = |of: &Influences| (of.weights.iter().sum::<f32>() - 1.0).abs() < 1e-3;
        if let Some(place) = self.influences.iter().position(|of| !sums_to_1(of)) {
            return value("influence", place);
        }
        let mut offsets = self.morphs.iter().flat_map(|morph| &morph.offsets);
        match offsets.position(|offset| !(offset.position.is_finite() && offset.normal.is_finite())) {
            Some(place) => value("morph offset", place),
            None => Ok(()),
        }
    }

    /// Whether a pose is one of this mesh.
    ///
    /// # Errors
    /// Another number of joints or morph targets, and values that are not finite.
    pub fn check_pose(&self, pose: &MeshPose) -> Result<(), BodyError> {
        let mesh = || self.name.clone();
        let counts = [
            ("joints in a pose", pose.joints.len(), self.joints.len()),
            ("morph weights in a pose", pose.morphs.len(), self.morphs.len()),
        ];
        for (what, found, expected) in counts {
            if found != expected {
                return Err(BodyError::Count { mesh: mesh(), what, found, expected });
            }
        }
        if let Some(place) = pose.joints.iter().position(|joint| !joint.is_finite()) {
            return Err(BodyError::Value { mesh: mesh(), what: "joint", place });
        }
        match pose.morphs.iter().position(|weight| !weight.is_finite()) {
            Some(place) => Err(BodyError::Value { mesh: mesh(), what: "morph weight", place }),
            None => Ok(()),
        }
    }
}
