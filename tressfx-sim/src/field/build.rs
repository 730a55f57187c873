//! The passes that make a field.

use glam::UVec3;
use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Binding, ShaderSource, Specialization};
use tressfx_core::uniform_array::UniformArray;

use super::VertexBuffer;
use crate::kernel::field_bounds::field_bounds;
use crate::kernel::field_crossings::field_crossings;
use crate::kernel::field_flood::field_flood;
use crate::kernel::field_grid::field_grid;
use crate::kernel::field_seed::field_seed;
use crate::kernel::field_sign::field_sign;
use crate::kernel::field_splat::field_splat;
use crate::kernel::{Kernels, Pass};

/// Lanes that a triangle is given where many nodes are around it: `LANES` in WGSL.
pub(crate) const LANES: u32 = 16;
/// Words of the header of a field: `HEADER` in WGSL.
pub(crate) const HEADER: u32 = 16;
/// The places of a node across the lines of crossings are below this, in parts of a cell: products are below 2^31.
const PARTS: u32 = 1 << 14;

gpu_struct! {
    /// What is the same whenever a field is made.
    pub(crate) struct FieldBuild {
        /// Nodes along x, y and z.
        pub nodes: [u32; 3],
        /// Triangles of the mesh.
        pub triangles: u32,
        /// Where the first vertex is, in floats.
        pub first_float: u32,
        /// From vertex to vertex, floats.
        pub stride: u32,
        /// Where its header is among all fields, in words.
        pub header: u32,
        /// Where the distances are.
        pub first_word: u32,
        /// Edges that no other triangle closes.
        pub open_edges: u32,
        /// Bits of the index of a triangle.
        pub index_bits: u32,
        /// Parts of a cell that crossings are exact to.
        pub parts: i32,
        /// How far the flood looks in this pass, nodes.
        pub reach: u32,
    }
}

/// What the passes of all fields of a set share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldBuffers {
    /// All fields: a header of `HEADER` words each, then the distances of all, an `f32` a node.
    pub(crate) fields: BufferId,
    /// Six `u32`: the box of the mesh.
    pub(crate) extremes: BufferId,
    /// `Grid`.
    pub(crate) grid: BufferId,
    /// `u32` a node: the nearest triangle of those near the surface.
    pub(crate) band: BufferId,
    /// `i32` a node: how often the line through it is crossed behind it.
    pub(crate) crossings: BufferId,
    /// `vec4<u32>` a node: its nearest point. Two, which take turns.
    pub(crate) points: [BufferId; 2],
}

/// A mesh and its place among the fields.
#[derive(Debug)]
pub(crate) struct Body {
    pub(crate) nodes: UVec3,
    pub(crate) triangles: u32,
    /// Where its header is, in words.
    pub(crate) header: u32,
    /// Where its distances are.
    pub(crate) first_word: u32,
    pub(crate) vertices: VertexBuffer,
    pub(crate) indices: BufferId,
    /// How many, and where; none where the mesh is closed.
    pub(crate) open_edges: Option<BufferId>,
    pub(crate) open_edge_count: u32,
    pub(crate) build: UniformArray<FieldBuild>,
}

impl Body {
    pub(crate) fn node_count(&self) -> u32 {
        self.nodes.element_product()
    }

    /// The header, but for the grid, which a kernel finds: a cell of 1 stands there until then.
    pub(crate) fn header_words(&self, margin: f32) -> [u32; HEADER as usize] {
        let mut words = [0; HEADER as usize];
        words[3] = 1f32.to_bits();
        words[4..7].copy_from_slice(&self.nodes.to_array());
        (words[7], words[8]) = (margin.to_bits(), self.first_word);
        words
    }

    /// How far the passes of the flood look: half of the nodes at first and one at last, and one once more, since what the longer ones miss is
    /// mostly next to where it belongs.
    pub(crate) fn floods(&self) -> Vec<u32> {
        let half = self.nodes.max_element().next_power_of_two() / 2;
        (0..=half.ilog2()).rev().map(|power| 1 << power).chain([1]).collect()
    }

    /// What its passes are told, for each pass of the flood.
    pub(crate) fn builds(&self) -> Vec<FieldBuild> {
        let build = |reach| FieldBuild {
            nodes: self.nodes.to_array(),
            triangles: self.triangles,
            first_float: self.vertices.first,
            stride: self.vertices.stride,
            header: self.header,
            first_word: self.first_word,
            open_edges: self.open_edge_count,
            index_bits: self.triangles.next_power_of_two().ilog2().max(1),
            parts: (PARTS / self.nodes.max_element().next_power_of_two()) as i32,
            reach,
        };
        self.floods().into_iter().map(build).collect()
    }
}

/// The passes of a field, in order.
#[derive(Debug)]
pub(crate) struct FieldPasses {
    first: [Pass; 5],
    floods: Vec<Pass>,
    sign: Pass,
}

impl FieldPasses {
    pub(crate) fn new(maker: &mut FieldMaker) -> Result<Self> {
        let floods = maker.body.floods().len();
        Ok(Self {
            first: [
                field_bounds(maker)?,
                field_grid(maker)?,
                field_splat(maker)?,
                field_crossings(maker)?,
                field_seed(maker)?,
            ],
            floods: (0..floods).map(|index| field_flood(maker, index)).collect::<Result<_>>()?,
            sign: field_sign(maker)?,
        })
    }

    pub(crate) fn record(&self, list: &mut PassList, buffers: &FieldBuffers, nodes: u32) {
        let words = 4 * u64::from(nodes);
        list.clear(buffers.extremes, 0, 24);
        list.clear(buffers.band, 0, words);
        list.clear(buffers.crossings, 0, words);
        self.first.iter().chain(&self.floods).chain([&self.sign]).for_each(|pass| pass.record(list, 0));
    }
}

/// What a kernel reads of the mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Reads {
    /// What it names itself.
    Nothing,
    /// Triangles.
    InItsUnit,
    /// Triangles, in cells of the grid.
    InCells,
}

/// What it takes to make the passes of a field.
pub(crate) struct FieldMaker<'a> {
    pub(crate) backend: &'a mut dyn Backend,
    pub(crate) kernels: &'a mut Kernels,
    pub(crate) body: &'a Body,
    pub(crate) buffers: &'a FieldBuffers,
}

impl FieldMaker<'_> {
    pub(crate) fn pass(
        &mut self,
        source: &ShaderSource,
        specialization: &Specialization,
        reads: Reads,
        resources: &[(&str, Binding)],
        grid: Grid,
    ) -> Result<Pass> {
        self.pass_at(source, specialization, reads, resources, grid, 0)
    }

    /// The same of a pass of the flood.
    pub(crate) fn pass_at(
        &mut self,
        source: &ShaderSource,
        specialization: &Specialization,
        reads: Reads,
        resources: &[(&str, Binding)],
        grid: Grid,
        index: usize,
    ) -> Result<Pass> {
        let body = self.body;
        let mut all = vec![("build", body.build.binding(index))];
        if !matches!(reads, Reads::Nothing) {
            all.extend([("vertices", body.vertices.buffer.into()), ("indices", body.indices.into())]);
        }
        if matches!(reads, Reads::InCells) {
            all.push(("grid", self.buffers.grid.into()));
        }
        all.extend_from_slice(resources);
        self.kernels.pass_of(self.backend, source, specialization, &all, grid)
    }
}
