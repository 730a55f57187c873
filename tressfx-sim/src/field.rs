//! Signed distance fields of meshes, made on the GPU: bodies that hair cannot enter.
//!
//! A field is a grid of distances from the surface of a mesh, negative inside. At its nodes distances are those to the nearest triangle, near the surface
//! and far from it; between them they are interpolated. The sign is that of the generalised winding number (Jacobson et al. 2013), so meshes
//! may have holes, and triangles that are flipped or have no area: a point is inside where the winding number is more than a half.
//!
//! A field is made anew where its mesh has changed, and only there. All sums are of integers: the field is the same in every run.

pub(crate) mod build;
mod error;
pub(crate) mod surface;
mod topology;

use glam::{UVec3, Vec3};
use tressfx_core::backend::{Backend, BufferDesc, Owner};
use tressfx_core::id::BufferId;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::strands::Bounds;
use tressfx_core::uniform_array::UniformArray;

use crate::buffers::storage;
use crate::collider::ColliderShape;
use crate::kernel::Kernels;
use build::{Body, FieldBuffers, FieldMaker, FieldPasses, HEADER};

pub use error::FieldError;
pub use surface::{FieldSurface, SurfaceBuffers, SurfaceSize};

/// The most triangles of a mesh: their distances and indices share an integer.
const MOST_TRIANGLES: usize = 1 << 22;
/// The most open edges: each node looks at all of them.
const MOST_OPEN_EDGES: usize = 4096;
/// Nodes along the longest side.
const NODES: std::ops::RangeInclusive<u32> = 16..=256;
/// The fewest along any side.
const FEWEST_NODES: u32 = 8;
/// Cells around the mesh, on both sides together.
const PADDING: u32 = 6;
/// Vertices further away than this are no places.
const FARTHEST: f32 = 1e15;

/// Vertices in a buffer that somebody else fills, such as the skinning of an engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexBuffer {
    /// The buffer. Positions are three `f32` each.
    pub buffer: BufferId,
    /// Where the first one is, in floats.
    pub first: u32,
    /// From one to the next, in floats: 3 or more.
    pub stride: u32,
}

/// A mesh to make a field of.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct FieldDesc<'a> {
    /// Vertices in the space that the collider's motion takes to the world, such as that of the rest pose. They say which edges are open and how many nodes each side
    /// gets; without [`FieldDesc::vertices`] the field is made of them.
    pub positions: &'a [Vec3],
    /// Three a triangle, counter-clockwise seen from outside.
    pub indices: &'a [u32],
    /// Nodes along the longest side of the box of the mesh and 3 cells around it, 16 to 256. The other sides have as many as cells as long as wide take.
    pub nodes: u32,
    /// The distance from the surface that hair is kept at, in the unit of the mesh.
    pub margin: f32,
    /// Where the vertices are, as many as [`FieldDesc::positions`], if somebody else writes them.
    pub vertices: Option<VertexBuffer>,
}

impl<'a> FieldDesc<'a> {
    /// A mesh that stays as it is, with 64 nodes and no margin.
    pub fn new(positions: &'a [Vec3], indices: &'a [u32]) -> Self {
        Self { positions, indices, nodes: 64, margin: 0.0, vertices: None }
    }

    /// The same with another number of nodes along the longest side.
    #[must_use]
    pub fn with_nodes(self, nodes: u32) -> Self {
        Self { nodes, ..self }
    }

    /// The same with a margin.
    #[must_use]
    pub fn with_margin(self, margin: f32) -> Self {
        Self { margin, ..self }
    }

    /// The same with vertices that are read from a buffer.
    #[must_use]
    pub fn with_vertices(self, vertices: VertexBuffer) -> Self {
        Self { vertices: Some(vertices), ..self }
    }

    /// The box around its triangles.
    fn validate(&self, field: usize) -> Result<Bounds, FieldError> {
        let (indices, nodes, margin) = (self.indices.len(), self.nodes, self.margin);
        if indices == 0 || !indices.is_multiple_of(3) {
            return Err(FieldError::NoTriangles { field, indices });
        }
        if indices / 3 > MOST_TRIANGLES {
            return Err(FieldError::TooManyTriangles { field, triangles: indices / 3, most: MOST_TRIANGLES });
        }
        if !NODES.contains(&nodes) {
            return Err(FieldError::Nodes { field, nodes });
        }
        if !margin.is_finite() || margin < 0.0 {
            return Err(FieldError::Margin { field, margin });
        }
        if let Some(VertexBuffer { stride, .. }) = self.vertices.filter(|vertices| vertices.stride < 3) {
            return Err(FieldError::Stride { field, stride });
        }
        let mut bounds = Bounds { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
        for (place, &vertex) in self.indices.iter().enumerate() {
            let Some(&position) = self.positions.get(vertex as usize) else {
                let vertices = self.positions.len();
                return Err(FieldError::NoVertex { field, triangle: place / 3, vertex, vertices });
            };
            if !is_near(position) {
                return Err(FieldError::NotFinite { field, vertex });
            }
            bounds = Bounds { min: bounds.min.min(position), max: bounds.max.max(position) };
        }
        Ok(bounds)
    }

    /// Nodes along each side of the box of the mesh.
    fn nodes_of(&self, bounds: &Bounds) -> UVec3 {
        let extent = bounds.max - bounds.min;
        let cell = extent.max_element() / (self.nodes - 1 - PADDING) as f32;
        let share = if cell > 0.0 { extent / cell } else { Vec3::ZERO };
        // What rounding adds to a whole number of cells is no cell.
        let nodes = (share - 1e-3).ceil().max(Vec3::ZERO).as_uvec3() + 1 + PADDING;
        nodes.clamp(UVec3::splat(FEWEST_NODES), UVec3::splat(self.nodes))
    }
}

fn is_near(position: Vec3) -> bool {
    position.is_finite() && position.abs().max_element() < FARTHEST
}

/// Signed distance fields that a simulation collides with ([`HairSim::with_fields`](crate::HairSim::with_fields)).
///
/// It makes buffers and pipelines once; after that it only writes passes into a [`PassList`], and none where no mesh has changed.
#[derive(Debug)]
pub struct Fields {
    bodies: Vec<FieldState>,
    buffers: FieldBuffers,
    /// Of everything.
    owner: Owner,
}

#[derive(Debug)]
struct FieldState {
    body: Body,
    passes: FieldPasses,
    /// Vertices that [`Fields::set_positions`] may write.
    own_vertices: usize,
    has_changed: bool,
    version: u32,
}

impl Fields {
    /// Makes everything that fields of these meshes need, and uploads the meshes; the next [`Fields::record`] makes the fields.
    ///
    /// # Errors
    /// A mesh that is no body, which says the field and the vertex or triangle; or what the backend says.
    pub fn new(backend: &mut dyn Backend, list: &mut PassList, descs: &[FieldDesc]) -> Result<Self, FieldError> {
        let bounds =
            descs.iter().enumerate().map(|(field, desc)| desc.validate(field)).collect::<Result<Vec<_>, _>>()?;
        let nodes: Vec<UVec3> = descs.iter().zip(&bounds).map(|(desc, bounds)| desc.nodes_of(bounds)).collect();
        let mut open_edges = Vec::with_capacity(descs.len());
        for (field, desc) in descs.iter().enumerate() {
            let edges = topology::open_edges(desc.positions, desc.indices);
            if edges.len() > MOST_OPEN_EDGES {
                return Err(FieldError::TooOpen { field, open: edges.len(), most: MOST_OPEN_EDGES });
            }
            open_edges.push(edges);
        }
        let mut uploads = PassList::new();
        let ((bodies, buffers), owner) = Owner::build(backend, |backend| {
            let buffers = FieldBuffers::new(backend, &nodes)?;
            let (mut kernels, mut first_word) = (Kernels::default(), HEADER * descs.len() as u32);
            let mut bodies = Vec::with_capacity(descs.len());
            for ((desc, &nodes), edges) in descs.iter().zip(&nodes).zip(&open_edges) {
                let header = HEADER * bodies.len() as u32;
                let body = Body::new(backend, &mut uploads, desc, nodes, edges, [header, first_word])?;
                uploads.upload(buffers.fields, 4 * u64::from(header), &body.header_words(desc.margin));
                first_word += body.node_count();
                let maker = &mut FieldMaker { backend, kernels: &mut kernels, body: &body, buffers: &buffers };
                let passes = FieldPasses::new(maker)?;
                let own_vertices = if desc.vertices.is_some() { 0 } else { desc.positions.len() };
                bodies.push(FieldState { body, passes, own_vertices, has_changed: true, version: 0 });
            }
            Ok::<_, tressfx_core::Error>((bodies, buffers))
        })?;
        list.append(&uploads);
        Ok(Self { bodies, buffers, owner })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Uploads the vertices of a mesh that has moved in its own space; the next [`Fields::record`] makes its field.
    ///
    /// # Errors
    /// No such field, another number of positions than the mesh has vertices, positions that are not finite, and a mesh whose vertices are in a buffer of the caller.
    pub fn set_positions(&mut self, list: &mut PassList, index: usize, positions: &[Vec3]) -> Result<(), FieldError> {
        let state = self.state(index)?;
        let (field, given, expected) = (index, positions.len(), state.own_vertices);
        if given != expected {
            return Err(FieldError::PositionCount { field, given, expected });
        }
        if let Some(vertex) = positions.iter().position(|position| !is_near(*position)) {
            return Err(FieldError::NotFinite { field, vertex: vertex as u32 });
        }
        list.upload(state.body.vertices.buffer, 0, positions);
        state.has_changed = true;
        Ok(())
    }

    /// Says that somebody else has written the vertices of a mesh; the next [`Fields::record`] makes its field.
    ///
    /// # Errors
    /// No such field.
    pub fn mark_changed(&mut self, index: usize) -> Result<(), FieldError> {
        self.state(index)?.has_changed = true;
        Ok(())
    }

    /// Records the passes that make the fields of meshes that have changed, behind what writes their vertices and before the simulation. Records nothing
    /// where none has.
    pub fn record(&mut self, list: &mut PassList) {
        for state in self.bodies.iter_mut().filter(|state| state.has_changed) {
            state.passes.record(list, &self.buffers, state.body.node_count());
            state.has_changed = false;
            state.version += 1;
        }
    }

    /// What a collider names. It changes whenever the field is made anew, so that hair that sleeps wakes: ask for it in each frame, behind
    /// [`Fields::record`].
    ///
    /// # Errors
    /// No such field.
    pub fn shape(&self, index: usize) -> Result<ColliderShape, FieldError> {
        let state = self.bodies.get(index).ok_or(FieldError::NoField { index, count: self.bodies.len() })?;
        Ok(ColliderShape::Field { index: index as u32, version: state.version })
    }

    /// Brings a field back: its header of 16 words, which begins with the place of the first node (3 `f32`), the size of a cell, the nodes along x, y and z (`u32`)
    /// and the margin; and an `f32` a node, along x first: the distance, without the margin.
    ///
    /// # Errors
    /// No such field.
    pub fn read(&self, list: &mut PassList, index: usize) -> Result<[Ticket; 2], FieldError> {
        let body = &self.bodies.get(index).ok_or(FieldError::NoField { index, count: self.bodies.len() })?.body;
        let parts = [(body.header, HEADER), (body.first_word, body.node_count())];
        Ok(parts
            .map(|(first, words)| list.read_buffer(self.buffers.fields, 4 * u64::from(first), 4 * u64::from(words))))
    }

    /// Brings back what the passes of the field that was made last have left for each other, for tests of single kernels: the box, the nodes near the surface, the
    /// crossings, and the nearest points.
    ///
    /// # Errors
    /// No such field.
    pub fn read_steps(&self, list: &mut PassList, index: usize) -> Result<[Ticket; 4], FieldError> {
        let state = self.bodies.get(index).ok_or(FieldError::NoField { index, count: self.bodies.len() })?;
        let nodes = u64::from(state.body.node_count());
        let FieldBuffers { extremes, band, crossings, points, .. } = self.buffers;
        let points = points[state.body.floods().len() % 2];
        Ok([(extremes, 24), (band, 4 * nodes), (crossings, 4 * nodes), (points, 16 * nodes)]
            .map(|(buffer, bytes)| list.read_buffer(buffer, 0, bytes)))
    }

    /// All fields, as kernels bind them.
    pub(crate) fn buffer(&self) -> BufferId {
        self.buffers.fields
    }

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }

    fn state(&mut self, index: usize) -> Result<&mut FieldState, FieldError> {
        let count = self.bodies.len();
        self.bodies.get_mut(index).ok_or(FieldError::NoField { index, count })
    }
}

impl FieldBuffers {
    /// For fields of so many nodes; they are made one after the other.
    fn new(backend: &mut dyn Backend, nodes: &[UVec3]) -> tressfx_core::Result<Self> {
        let counts = nodes.iter().map(|nodes| nodes.element_product());
        let most = counts.clone().max().unwrap_or(0);
        let bytes: u64 = counts.map(|count| 4 * u64::from(HEADER + count)).sum();
        let mut points = || storage(backend, "hair.field_points", 16, most);
        let points = [points()?, points()?];
        Ok(Self {
            fields: backend.create_buffer(&BufferDesc::storage("hair.fields", bytes.max(16)))?,
            extremes: storage(backend, "hair.field_extremes", 4, 6)?,
            grid: storage(backend, "hair.field_grid", 16, 1)?,
            band: storage(backend, "hair.field_band", 4, most)?,
            crossings: storage(backend, "hair.field_crossings", 4, most)?,
            points,
        })
    }
}

impl Body {
    fn new(
        backend: &mut dyn Backend,
        uploads: &mut PassList,
        desc: &FieldDesc,
        nodes: UVec3,
        open_edges: &[topology::OpenEdge],
        [header, first_word]: [u32; 2],
    ) -> tressfx_core::Result<Self> {
        let vertices = match desc.vertices {
            Some(vertices) => vertices,
            None => {
                let buffer = storage(backend, "hair.field_vertices", 12, desc.positions.len() as u32)?;
                uploads.upload(buffer, 0, desc.positions);
                VertexBuffer { buffer, first: 0, stride: 3 }
            }
        };
        let indices = storage(backend, "hair.field_indices", 4, desc.indices.len() as u32)?;
        uploads.upload(indices, 0, desc.indices);
        let open_edge_count = open_edges.len() as u32;
        let open_edges = if open_edges.is_empty() {
            None
        } else {
            let buffer = storage(backend, "hair.field_open_edges", 16, open_edge_count)?;
            uploads.upload(buffer, 0, open_edges);
            Some(buffer)
        };
        let triangles = desc.indices.len() as u32 / 3;
        let floods = nodes.max_element().next_power_of_two().ilog2() as usize + 1;
        let build = UniformArray::new(backend, "hair.field_builds", floods)?;
        let body = Self { nodes, triangles, header, first_word, vertices, indices, open_edges, open_edge_count, build };
        body.build.upload(uploads, 0, &body.builds());
        Ok(body)
    }
}
