//! The zero surface of a field as triangles, to be looked at.

use bytemuck::{Pod, Zeroable};
use tressfx_core::backend::{Backend, BufferDesc, Owner};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shader::Binding;
use tressfx_core::uniform_array::UniformArray;

use super::{FieldError, Fields};
use crate::buffers::storage;
use crate::kernel::surface_count::surface_count;
use crate::kernel::surface_emit::surface_emit;
use crate::kernel::surface_scan::surface_scan;
use crate::kernel::{GROUP, Kernels, Pass};

/// Where the size lies behind what a draw is told, in bytes.
const SIZE: u64 = 16;

gpu_struct! {
    /// What is the same whenever a surface is made.
    pub(crate) struct SurfaceBuild {
        /// The index of the field.
        pub field: u32,
        /// How many nodes it has.
        pub nodes: u32,
        /// Vertices that there is room for.
        pub vertex_room: u32,
        /// Triangles that there is room for.
        pub triangle_room: u32,
    }
}

/// How large a surface is, or how large it may be.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct SurfaceSize {
    /// Vertices.
    pub vertices: u32,
    /// Triangles.
    pub triangles: u32,
}

impl SurfaceSize {
    /// What the ticket of [`FieldSurface::record`] brought; `None` where there are too few bytes.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        bytes.get(..size_of::<Self>()).map(bytemuck::pod_read_unaligned)
    }

    fn is_in(self, room: Self) -> bool {
        self.vertices <= room.vertices && self.triangles <= room.triangles
    }
}

/// Where a surface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceBuffers {
    /// Two `vec4<f32>` a vertex: the position in the space of the mesh and 1, the normal and 0.
    pub vertices: BufferId,
    /// Three `u32` a triangle, counter-clockwise seen from outside.
    pub indices: BufferId,
    /// What an indirect draw is told, from byte 0 on: three a triangle, 1, 0, 0.
    pub draw: BufferId,
}

/// The zero surface of a field, by marching tetrahedra: counted, summed up, written. Where the field is not cut off by its box the surface is closed: each edge has two
/// triangles. The order of vertices and triangles is that of the nodes, in every run.
///
/// It is for looking at a field. Nothing that collides asks for it.
#[derive(Debug)]
pub struct FieldSurface {
    field: u32,
    fields: BufferId,
    nodes: u32,
    room: SurfaceSize,
    kernels: Kernels,
    build: UniformArray<SurfaceBuild>,
    /// `u32` a node.
    cells: BufferId,
    /// `vec2<u32>` a group of nodes.
    blocks: BufferId,
    buffers: SurfaceBuffers,
    passes: [Pass; 3],
    /// Of everything.
    owner: Owner,
}

/// What it takes to make the passes of a surface.
pub(crate) struct SurfaceMaker<'a> {
    pub(crate) backend: &'a mut dyn Backend,
    pub(crate) kernels: &'a mut Kernels,
    pub(crate) build: Binding,
    pub(crate) fields: BufferId,
    pub(crate) nodes: u32,
    pub(crate) cells: BufferId,
    pub(crate) blocks: BufferId,
    pub(crate) size: BufferId,
}

impl FieldSurface {
    /// The surface of one of the fields, without room yet: what is [recorded](Self::record) first says how much it takes. The fields have to outlive it.
    ///
    /// # Errors
    /// No such field, or what the backend says.
    pub fn new(backend: &mut dyn Backend, fields: &Fields, index: usize) -> Result<Self, FieldError> {
        let state = fields.bodies.get(index).ok_or(FieldError::NoField { index, count: fields.len() })?;
        let (nodes, fields) = (state.body.node_count(), fields.buffer());
        let (made, owner) = Owner::build(backend, |backend| {
            let build = UniformArray::new(backend, "hair.surface_build", 1)?;
            let cells = storage(backend, "hair.surface_cells", 4, nodes)?;
            let blocks = storage(backend, "hair.surface_blocks", 8, nodes.div_ceil(GROUP))?;
            let draw = backend.create_buffer(&BufferDesc::indirect("hair.surface_draw", SIZE + 8))?;
            let [vertices, indices] = room_for(backend, SurfaceSize::default())?;
            let buffers = SurfaceBuffers { vertices, indices, draw };
            let mut kernels = Kernels::default();
            let maker = &mut SurfaceMaker {
                backend,
                kernels: &mut kernels,
                build: build.binding(0),
                fields,
                nodes,
                cells,
                blocks,
                size: draw,
            };
            let passes = [surface_count(maker)?, surface_scan(maker)?, surface_emit(maker, &buffers)?];
            Ok::<_, tressfx_core::Error>((build, cells, blocks, buffers, kernels, passes))
        })?;
        let (build, cells, blocks, buffers, kernels, passes) = made;
        let (field, room) = (index as u32, SurfaceSize::default());
        Ok(Self { field, fields, nodes, room, kernels, build, cells, blocks, buffers, passes, owner })
    }

    /// Records the passes that make the surface of what the field is then. The ticket brings its [`SurfaceSize`]. Where there is no room for all of it, nothing of it is
    /// written, and the draw is empty.
    pub fn record(&self, list: &mut PassList) -> Ticket {
        let Self { field, nodes, room, .. } = *self;
        let build = SurfaceBuild { field, nodes, vertex_room: room.vertices, triangle_room: room.triangles };
        self.build.upload(list, 0, &[build]);
        self.passes.iter().for_each(|pass| pass.record(list, 0));
        list.read_buffer(self.buffers.draw, SIZE, size_of::<SurfaceSize>() as u64)
    }

    /// Makes room for a surface of this size and some more, if there is too little: the next [`Self::record`] writes it. Says whether it did; then
    /// [`Self::buffers`] are others.
    ///
    /// # Errors
    /// What the backend says when it cannot make buffers of that size; then the room is as before.
    pub fn make_room(&mut self, backend: &mut dyn Backend, size: SurfaceSize) -> Result<bool, FieldError> {
        if size.is_in(self.room) {
            return Ok(false);
        }
        // A body that moves is not as large in each frame.
        let more = |count: u32, room: u32| room.max(count.saturating_add(count / 8));
        let vertices = more(size.vertices, self.room.vertices);
        let room = SurfaceSize { vertices, triangles: more(size.triangles, self.room.triangles) };
        let Self { fields, nodes, cells, blocks, buffers: old, ref build, ref mut kernels, .. } = *self;
        let (buffers, pass) = self.owner.change(backend, |backend| {
            let [vertices, indices] = room_for(backend, room)?;
            let buffers = SurfaceBuffers { vertices, indices, ..old };
            let (build, size) = (build.binding(0), old.draw);
            let pass = surface_emit(
                &mut SurfaceMaker { backend, kernels, build, fields, nodes, cells, blocks, size },
                &buffers,
            )?;
            [old.vertices, old.indices].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
            Ok::<_, tressfx_core::Error>((buffers, pass))
        })?;
        (self.room, self.buffers, self.passes[2]) = (room, buffers, pass);
        Ok(true)
    }

    /// Where it is.
    pub fn buffers(&self) -> SurfaceBuffers {
        self.buffers
    }

    /// How large it may be.
    pub fn room(&self) -> SurfaceSize {
        self.room
    }

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }
}

/// Buffers of vertices and of indices.
fn room_for(backend: &mut dyn Backend, room: SurfaceSize) -> tressfx_core::Result<[BufferId; 2]> {
    let bytes = |each: u64, count: u32| (each * u64::from(count)).max(32);
    let mut buffer = |label, bytes| backend.create_buffer(&BufferDesc::storage(label, bytes));
    Ok([
        buffer("hair.surface_vertices", bytes(32, room.vertices))?,
        buffer("hair.surface_indices", bytes(12, room.triangles))?,
    ])
}
