//! What is no body.

/// Why no field can be made of a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// Indices are no triangles.
    #[error("field {field}: {indices} indices are no triangles: there are three a triangle, and at least one triangle")]
    NoTriangles {
        /// The index of the field.
        field: usize,
        /// How many indices there are.
        indices: usize,
    },
    /// More triangles than a field can name.
    #[error("field {field}: {triangles} triangles, there may be {most}")]
    TooManyTriangles {
        /// The index of the field.
        field: usize,
        /// How many there are.
        triangles: usize,
        /// How many there may be.
        most: usize,
    },
    /// An index beyond the vertices.
    #[error("field {field}: triangle {triangle} has the vertex {vertex} of {vertices}")]
    NoVertex {
        /// The index of the field.
        field: usize,
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A vertex of a triangle is no place.
    #[error("field {field}: vertex {vertex} is not finite, or further than 1e15 from the origin")]
    NotFinite {
        /// The index of the field.
        field: usize,
        /// The vertex.
        vertex: u32,
    },
    /// The mesh is no solid.
    #[error("field {field}: {open} edges are open, there may be {most}: the mesh is no body")]
    TooOpen {
        /// The index of the field.
        field: usize,
        /// How many there are.
        open: usize,
        /// How many there may be.
        most: usize,
    },
    /// A number of nodes that there cannot be.
    #[error("field {field}: {nodes} nodes along the longest side, there may be 16 to 256")]
    Nodes {
        /// The index of the field.
        field: usize,
        /// How many were asked for.
        nodes: u32,
    },
    /// A margin that is none.
    #[error("field {field}: a margin of {margin} is negative or not finite")]
    Margin {
        /// The index of the field.
        field: usize,
        /// What was asked for.
        margin: f32,
    },
    /// Vertices in a buffer that would overlap.
    #[error("field {field}: vertices are {stride} floats apart, they take 3")]
    Stride {
        /// The index of the field.
        field: usize,
        /// Floats from vertex to vertex.
        stride: u32,
    },
    /// There is no such field.
    #[error("field {index} of {count}")]
    NoField {
        /// What was asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Positions do not fit the mesh.
    #[error("field {field}: {given} positions for {expected} vertices")]
    PositionCount {
        /// The index of the field.
        field: usize,
        /// How many were given.
        given: usize,
        /// How many the mesh has; 0 where its vertices are in a buffer of the caller.
        expected: usize,
    },
    /// The backend could not make something.
    #[error(transparent)]
    Backend(#[from] tressfx_core::Error),
}
