//! A frame as plain data: commands that name resources by id.

mod list;

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::Label;
use crate::id::{BufferId, TextureId};
use crate::shader::{Bindings, Kernel, RasterPipeline};

pub use list::PassList;

/// Names one read-back; unique in the process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ticket(u64);

impl Ticket {
    fn next() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// Groups along x, y and z of a compute pass; at most [`Grid::MAX_GROUPS`] each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid(pub [u32; 3]);

impl Grid {
    /// Groups that every device takes along one dimension.
    pub const MAX_GROUPS: u32 = 65_535;

    /// Groups of `group` threads for `threads` threads in a row, folded into two dimensions where one does not hold them.
    /// The kernel finds its index with `package::grid::thread_index` and must ignore indices beyond `threads`.
    pub fn for_threads(threads: u32, group: u32) -> Self {
        let groups = threads.div_ceil(group);
        let rows = groups.div_ceil(Self::MAX_GROUPS).max(1);
        Self([groups.div_ceil(rows), rows, 1])
    }

    /// The same for each of so many planes: the kernel finds its own in `z` of its group, without a division.
    pub fn planes(self, planes: u32) -> Self {
        let Self([x, y, z]) = self;
        Self([x, y, z * planes])
    }

    /// Groups of `group` x `group` threads for every texel of an image.
    pub fn for_image(size: [u32; 2], group: u32) -> Self {
        Self([size[0].div_ceil(group), size[1].div_ceil(group), 1])
    }

    /// Whether it runs nothing.
    pub fn is_empty(self) -> bool {
        self.0.contains(&0)
    }
}

/// How many groups of a compute pass run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// So many.
    Grid(Grid),
    /// As many as a buffer says once its turn has come: three `u32` for x, y and z, each at most [`Grid::MAX_GROUPS`].
    Indirect {
        /// A buffer with [`BufferUses::INDIRECT`](crate::backend::BufferUses::INDIRECT).
        buffer: BufferId,
        /// Where in it; a multiple of 4.
        offset: u64,
    },
}

/// How much a draw draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// So much.
    Direct {
        /// Vertices of each instance, three to a triangle.
        vertices: u32,
        /// Instances.
        instances: u32,
    },
    /// As much as a buffer says once its turn has come: four `u32` for vertices, instances, 0 and 0.
    Indirect {
        /// A buffer with [`BufferUses::INDIRECT`](crate::backend::BufferUses::INDIRECT).
        buffer: BufferId,
        /// Where in it; a multiple of 4.
        offset: u64,
    },
}

/// How a render target begins a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load<T> {
    /// With what it holds.
    Keep,
    /// Filled with a value.
    Clear(T),
}

/// A compute pass.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ComputePass {
    /// What runs.
    pub kernel: Kernel,
    /// What it reads and writes.
    pub bindings: Bindings,
    /// How often it runs.
    pub groups: Groups,
    /// Whose pass it is: see [`PassList::scope`].
    pub scope: Option<Arc<str>>,
}

impl ComputePass {
    /// A pass of nobody in particular.
    pub fn new(kernel: Kernel, bindings: Bindings, groups: Groups) -> Self {
        Self { kernel, bindings, groups, scope: None }
    }
}

/// One draw of a raster pass.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Draw {
    /// What runs.
    pub pipeline: RasterPipeline,
    /// What it reads and writes.
    pub bindings: Bindings,
    /// How much.
    pub count: Count,
}

impl Draw {
    /// So many vertices of so many instances.
    pub fn new(pipeline: &RasterPipeline, bindings: &Bindings, vertices: u32, instances: u32) -> Self {
        let count = Count::Direct { vertices, instances };
        Self { pipeline: pipeline.clone(), bindings: bindings.clone(), count }
    }

    /// As much as `buffer` says from byte `offset` on.
    pub fn indirect(pipeline: &RasterPipeline, bindings: &Bindings, buffer: BufferId, offset: u64) -> Self {
        let count = Count::Indirect { buffer, offset };
        Self { pipeline: pipeline.clone(), bindings: bindings.clone(), count }
    }
}

/// A part of the targets, in pixels from their upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Viewport {
    /// The upper left corner.
    pub origin: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

/// Draws into the same targets, which are all of one size. Without draws it only clears.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RasterPass {
    /// Its name.
    pub label: Label,
    /// Colour targets and how they begin, linear RGBA.
    pub colors: Vec<(TextureId, Load<[f32; 4]>)>,
    /// The depth target and how it begins.
    pub depth: Option<(TextureId, Load<f32>)>,
    /// Where clip space lies, and beyond which nothing is drawn; `None`: the whole targets. Targets are cleared whole.
    pub viewport: Option<Viewport>,
    /// What is drawn, in order, by pipelines that were made for the formats of the targets.
    pub draws: Vec<Draw>,
    /// Whose pass it is: see [`PassList::scope`].
    pub scope: Option<Arc<str>>,
}

impl RasterPass {
    /// A pass without targets and draws.
    pub fn new(label: Label) -> Self {
        Self { label, colors: Vec::new(), depth: None, viewport: None, draws: Vec::new(), scope: None }
    }

    /// With one more colour target.
    #[must_use]
    pub fn color(mut self, target: TextureId, load: Load<[f32; 4]>) -> Self {
        self.colors.push((target, load));
        self
    }

    /// With a depth target.
    #[must_use]
    pub fn depth(self, target: TextureId, load: Load<f32>) -> Self {
        Self { depth: Some((target, load)), ..self }
    }

    /// Within a part of the targets.
    #[must_use]
    pub fn viewport(self, viewport: Viewport) -> Self {
        Self { viewport: Some(viewport), ..self }
    }

    /// With one more draw.
    #[must_use]
    pub fn draw(mut self, draw: Draw) -> Self {
        self.draws.push(draw);
        self
    }
}

/// One command of a frame. A backend that does not know a command answers with an error.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Command {
    /// Bytes of the list go into a buffer.
    Upload {
        /// The buffer.
        dst: BufferId,
        /// Where in it; a multiple of 4.
        offset: u64,
        /// Which of [`PassList::bytes`]; a multiple of 4 long.
        data: Range<usize>,
    },
    /// A part of a buffer becomes zero.
    Clear {
        /// The buffer.
        dst: BufferId,
        /// From this byte, a multiple of 4.
        offset: u64,
        /// So many bytes, a multiple of 4.
        bytes: u64,
    },
    /// A part of a buffer goes into another buffer.
    Copy {
        /// From this buffer,
        src: BufferId,
        /// from this byte, a multiple of 4,
        src_offset: u64,
        /// into this buffer,
        dst: BufferId,
        /// to this byte, a multiple of 4:
        dst_offset: u64,
        /// so many bytes, a multiple of 4.
        bytes: u64,
    },
    /// Rows of a buffer become the whole of a texture, which holds no depth.
    CopyToTexture {
        /// From this buffer,
        src: BufferId,
        /// from this byte, a multiple of 8,
        offset: u64,
        /// so many bytes from row to row, a multiple of [`ROW_ALIGNMENT`],
        row_bytes: u32,
        /// into this texture.
        dst: TextureId,
    },
    /// A kernel runs.
    Compute(ComputePass),
    /// Triangles are drawn.
    Raster(RasterPass),
    /// A part of a buffer comes back to the CPU.
    ReadBuffer {
        /// The buffer.
        src: BufferId,
        /// From this byte, a multiple of 4.
        offset: u64,
        /// So many bytes, a multiple of 4.
        bytes: u64,
        /// Names the read-back.
        ticket: Ticket,
    },
    /// A texture comes back to the CPU, rows tightly packed.
    ReadTexture {
        /// The texture.
        src: TextureId,
        /// Names the read-back.
        ticket: Ticket,
    },
}

/// What the distance of rows that are copied to a texture is a multiple of, in bytes.
pub const ROW_ALIGNMENT: u32 = 256;

impl Command {
    /// Its name: the label of a pass.
    pub fn name(&self) -> Label {
        match self {
            Self::Upload { .. } => "upload",
            Self::Clear { .. } => "clear",
            Self::Copy { .. } => "copy",
            Self::CopyToTexture { .. } => "copy to texture",
            Self::Compute(pass) => pass.kernel.label(),
            Self::Raster(pass) => pass.label,
            Self::ReadBuffer { .. } => "read buffer",
            Self::ReadTexture { .. } => "read texture",
        }
    }

    /// Whether it is a compute or raster pass: what is timed.
    pub fn is_pass(&self) -> bool {
        matches!(self, Self::Compute(_) | Self::Raster(_))
    }

    /// Whose pass it is.
    pub fn scope(&self) -> Option<&Arc<str>> {
        match self {
            Self::Compute(pass) => pass.scope.as_ref(),
            Self::Raster(pass) => pass.scope.as_ref(),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_covers_every_thread_within_the_limit_of_each_dimension() {
        for threads in [1, 63, 64, 65, 65_535 * 64, 65_535 * 64 + 1, 300_000_000, u32::MAX] {
            let grid = Grid::for_threads(threads, 64);
            assert!(grid.0.iter().all(|&groups| (1..=Grid::MAX_GROUPS).contains(&groups)), "{threads}: {grid:?}");
            let covered = u64::from(grid.0[0]) * u64::from(grid.0[1]) * 64;
            assert!(covered >= u64::from(threads), "{threads}: {grid:?} covers {covered}");
            assert!(covered < u64::from(threads) + 64 * u64::from(grid.0[1]) + 64, "{threads}: {grid:?} wastes");
        }
        assert!(Grid::for_threads(0, 64).is_empty());
    }

    #[test]
    fn each_plane_of_a_grid_has_the_groups_of_one() {
        let grid = Grid::for_threads(65_535 * 64 + 1, 64);
        let Grid([x, y, z]) = grid.planes(5);
        assert_eq!((Grid([x, y, 1]), z), (grid, 5));
        assert!(grid.planes(0).is_empty() && Grid::for_threads(0, 64).planes(5).is_empty());
    }
}
