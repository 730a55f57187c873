//! Bodies that move under the hair: skinning, and roots that follow it.
//!
//! [`Skinning`] moves a [`SkinnedMesh`](tressfx_core::body::SkinnedMesh) by its joints and morph targets on the GPU. [`Binding`] finds the triangle that each root
//! grows on, once; [`TriangleRoots`] then writes where the skinned mesh, ours or the engine's own, takes the roots of a section. [`BoneRoots`] does it without a
//! mesh, by four bones a strand. Both write [`HairSim::root_transforms`](crate::HairSim::root_transforms).
//!
//! All of it is in the space of the head: what moves the character as a whole through the world is best left to the pose of the head, so that numbers stay small.

mod bind;
mod bone_roots;
mod nearest;
mod palette;
mod roots_pass;
mod skinning;
mod triangle_roots;

pub use bind::{BindError, BindReport, Binding, BoundRoot};
pub use bone_roots::{BoneRoot, BoneRoots};
pub use palette::JointPalette;
pub use roots_pass::RootSource;
pub use skinning::{BoundVertex, Skinning};
pub use triangle_roots::{MeshVertices, TriangleRoot, TriangleRoots};
