//! Characters: skinned meshes with joints, morph targets and animations, from glTF 2.0 (`.glb`, `.gltf`).
//!
//! All meshes of a file become one, so that hair can be bound to it as a whole. A mesh without a skin gets its node as its only joint. What is
//! kept are positions, normals, triangles, the first texture coordinates where all of it has them, up to four joints a vertex, morph targets of positions and normals, and
//! animations; materials, textures, cameras and lights are passed over.
//!
//! The bind pose is that of the file: vertices as they are stored, and those of a mesh without a skin as their node places them at rest. Where a skeleton has
//! another scale than the mesh (an exporter that writes centimetres below a node that scales them to metres), vertices are brought into the space of its
//! first joint at rest, so that hair is bound to the body in the size in which it is shown.

mod accessor;
mod animation;
mod buffers;
mod gltf;
mod instance;
mod nodes;

use glam::{Affine3A, DAffine3};
use tressfx_core::body::{MeshPose, SkinnedMesh};

pub use animation::Animation;
pub(crate) use gltf::is_like;
pub use gltf::read_bytes;

use crate::{FileError, FileErrorKind};
use animation::Moved;
use nodes::Nodes;

/// A body that moves.
#[derive(Clone, Debug, Default)]
pub struct Character {
    /// The mesh in its bind pose.
    pub mesh: SkinnedMesh,
    /// How it can move.
    pub animations: Vec<Animation>,
    /// Vertices whose weights in the file sum to something else than 1, by more than 1e-3.
    pub normalised: usize,
    /// Vertices with more than four joints, of which the four with the most weight are kept.
    pub reduced: usize,
    nodes: Nodes,
    joints: Vec<Joint>,
    morphs: Vec<MorphWeights>,
}

/// A joint of the mesh.
#[derive(Clone, Copy, Debug)]
struct Joint {
    node: usize,
    /// From the bind pose of the mesh to the space of the node.
    inverse_bind: DAffine3,
}

/// The morph targets of a node, and what they are at rest.
#[derive(Clone, Debug)]
struct MorphWeights {
    node: usize,
    rest: Vec<f64>,
}

impl From<SkinnedMesh> for Character {
    /// One without animations, whose joints stay where they are.
    fn from(mesh: SkinnedMesh) -> Self {
        let nodes = Nodes::apart(mesh.joints.len().max(1));
        let joint = |node| Joint { node, inverse_bind: DAffine3::IDENTITY };
        let joints = (0..mesh.joints.len()).map(joint).collect();
        let morphs = vec![MorphWeights { node: 0, rest: vec![0.0; mesh.morphs.len()] }];
        Self { mesh, nodes, joints, morphs, ..Self::default() }
    }
}

impl Character {
    /// Reads a character; buffers in other files are found beside it.
    ///
    /// # Errors
    /// Those of [`read_bytes`], and if a file cannot be read.
    pub fn read(path: impl AsRef<std::path::Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|error| FileError::new(&name, "file", FileErrorKind::Io(error)))?;
        let folder = path.parent().map(std::path::Path::to_owned).unwrap_or_default();
        read_bytes(&name, &bytes, Some(&folder))
    }

    /// The animation of a name.
    pub fn animation(&self, name: &str) -> Option<&Animation> {
        self.animations.iter().find(|animation| animation.name == name)
    }

    /// Where its joints and morph targets are at a time in seconds from the beginning of an animation, before which and after the end of which it
    /// stands still; without one, at rest. All of it is computed in f64. A sub-step can ask for its own time.
    pub fn pose(&self, animation: Option<&Animation>, seconds: f64) -> MeshPose {
        let mut moved = Moved::new(&self.nodes);
        if let Some(animation) = animation {
            animation.apply(seconds, &mut moved);
        }
        let places = self.nodes.places(&moved.nodes);
        let joint = |joint: &Joint| {
            let matrix = places[joint.node] * joint.inverse_bind;
            Affine3A { matrix3: matrix.matrix3.as_mat3().into(), translation: matrix.translation.as_vec3a() }
        };
        let weights = |morphs: &MorphWeights| {
            let moved = moved.weights.get(&morphs.node).filter(|moved| moved.len() == morphs.rest.len());
            moved.unwrap_or(&morphs.rest).iter().map(|&weight| weight as f32).collect::<Vec<_>>()
        };
        MeshPose {
            joints: self.joints.iter().map(joint).collect(),
            morphs: self.morphs.iter().flat_map(weights).collect(),
        }
    }
}
