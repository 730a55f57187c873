//! What can go wrong in the simulation.

use tressfx_core::body::BodyError;

use crate::body::MeshVertices;
use crate::params::ParamError;

/// An error of the simulation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// A parameter is outside its range.
    #[error(transparent)]
    Param(#[from] ParamError),
    /// Something that a step was given is not a finite number.
    #[error("step: {name} is not finite")]
    NonFinite {
        /// What it is: `head`, `wind.velocity`...
        name: &'static str,
    },
    /// A quaternion that is no rotation: its length is not 1. A head, a root or a collider cannot be scaled.
    #[error("step: {name} is no rotation, its quaternion has the length {length}")]
    NoRotation {
        /// What it is.
        name: &'static str,
        /// The length of the quaternion.
        length: f32,
    },
    /// A capsule has a number that is not finite or a negative radius.
    #[error("step: collider {index} has a number that is not finite or a negative radius")]
    UnsoundCapsule {
        /// Its index.
        index: usize,
    },
    /// A collider is a field that the simulation was not made with.
    #[error("step: collider {index} is field {field} of {count}")]
    NoField {
        /// Its index.
        index: usize,
        /// The field.
        field: u32,
        /// How many fields the simulation was made with.
        count: usize,
    },
    /// More colliders than the simulation was made for.
    #[error("step: {given} colliders, the simulation was made for {most}")]
    TooManyColliders {
        /// How many were given.
        given: usize,
        /// How many there may be.
        most: usize,
    },
    /// The simulation was made without hair against hair.
    #[error("volume: the simulation was made without it")]
    NoVolume,
    /// There is no such section.
    #[error("section {index} of {count}")]
    NoSection {
        /// What was asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Root transforms do not fit the section.
    #[error("{given} root transforms for {expected} guides")]
    RootCount {
        /// How many were given.
        given: usize,
        /// How many the section takes: one a guide, or none.
        expected: usize,
    },
    /// A mesh or a pose of it is not sound.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// More joints than kernels can count.
    #[error("{given} joints, a body may have {most}")]
    TooManyJoints {
        /// How many were given.
        given: usize,
        /// How many there may be.
        most: usize,
    },
    /// Another number of joints than the palette has.
    #[error("{given} joints for a palette of {expected}")]
    JointCount {
        /// How many were given.
        given: usize,
        /// How many it has.
        expected: usize,
    },
    /// A strand has a joint that is not in the palette.
    #[error("joint {joint} of a palette of {count}")]
    NoJoint {
        /// The joint.
        joint: u32,
        /// How many there are.
        count: usize,
    },
    /// Vertices of an engine are not those that roots are bound to, or not laid out in whole numbers.
    #[error("roots are bound to vertex {last} and those before it, but the buffer is {mesh:?}")]
    MeshVertices {
        /// The last vertex that a root is bound to.
        last: u32,
        /// What was given.
        mesh: MeshVertices,
    },
    /// No render strands, or more vertices than a 32-bit index reaches.
    #[error("{strands} render strands of {vertices} vertices: there must be one or more, and fewer than 2^32 vertices")]
    RenderStrands {
        /// Strands that were asked for.
        strands: u32,
        /// Vertices of each.
        vertices: u32,
    },
    /// There is no triangle between guides, or the buffers hold other guides.
    #[error(
        "{name}: between {guides} guides there is no triangle: render strands lie between three guides that are near each other, or follow guides"
    )]
    NoTriangles {
        /// The groom.
        name: String,
        /// How many it has.
        guides: u32,
    },
    /// The backend could not make something.
    #[error(transparent)]
    Backend(#[from] tressfx_core::Error),
}
