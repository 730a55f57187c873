//! A frame as plain data: commands that name resources by id.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use bytemuck::NoUninit;

use crate::backend::Kernel;
use crate::error::Label;
use crate::id::{BufferId, TextureId};
use crate::shader::Bindings;

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
        /// A buffer made with [`BufferUse::Indirect`](crate::backend::BufferUse::Indirect).
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
pub struct ComputePass {
    /// What runs.
    pub kernel: Kernel,
    /// What it reads and writes.
    pub bindings: Bindings,
    /// How often it runs.
    pub groups: Groups,
}

/// One draw of a raster pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// What runs.
    pub kernel: Kernel,
    /// What it reads and writes.
    pub bindings: Bindings,
    /// Vertices of each instance, three to a triangle.
    pub vertices: u32,
    /// Instances.
    pub instances: u32,
}

/// Draws into the same targets, which are all of one size. Without draws it only clears.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterPass {
    /// Its name.
    pub label: Label,
    /// Colour targets and how they begin, linear RGBA.
    pub colors: Vec<(TextureId, Load<[f32; 4]>)>,
    /// The depth target and how it begins.
    pub depth: Option<(TextureId, Load<f32>)>,
    /// What is drawn, in order, by pipelines that were made for the formats of the targets.
    pub draws: Vec<Draw>,
}

/// One command of a frame.
#[derive(Clone, Debug, PartialEq)]
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

/// The commands of a frame, in the order in which they take effect.
///
/// It can be printed, compared, stored and run again. Nothing happens until a backend runs it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PassList {
    /// The commands.
    pub commands: Vec<Command>,
    /// The bytes that the uploads name.
    pub bytes: Vec<u8>,
}

impl PassList {
    /// An empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets all commands and keeps the memory for the next frame.
    pub fn clear_commands(&mut self) {
        self.commands.clear();
        self.bytes.clear();
    }

    /// Writes `data` to `dst` from byte `offset` on. Its size must be a multiple of 4.
    pub fn upload<T: NoUninit>(&mut self, dst: BufferId, offset: u64, data: &[T]) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytemuck::cast_slice(data));
        self.commands.push(Command::Upload { dst, offset, data: start..self.bytes.len() });
    }

    /// Makes `bytes` bytes of `dst` zero.
    pub fn clear(&mut self, dst: BufferId, offset: u64, bytes: u64) {
        self.commands.push(Command::Clear { dst, offset, bytes });
    }

    /// Copies the first `bytes` bytes of `src` to the start of `dst`.
    pub fn copy(&mut self, src: BufferId, dst: BufferId, bytes: u64) {
        self.commands.push(Command::Copy { src, src_offset: 0, dst, dst_offset: 0, bytes });
    }

    /// Runs `kernel` over `grid`; an empty grid is left out.
    pub fn compute(&mut self, kernel: &Kernel, bindings: &Bindings, grid: Grid) {
        if !grid.is_empty() {
            let (kernel, bindings) = (kernel.clone(), bindings.clone());
            self.commands.push(Command::Compute(ComputePass { kernel, bindings, groups: Groups::Grid(grid) }));
        }
    }

    /// Runs `kernel` over as many groups as `buffer` says from byte `offset` on.
    pub fn compute_indirect(&mut self, kernel: &Kernel, bindings: &Bindings, buffer: BufferId, offset: u64) {
        let (kernel, bindings, groups) = (kernel.clone(), bindings.clone(), Groups::Indirect { buffer, offset });
        self.commands.push(Command::Compute(ComputePass { kernel, bindings, groups }));
    }

    /// Draws.
    pub fn raster(&mut self, pass: RasterPass) {
        self.commands.push(Command::Raster(pass));
    }

    /// Brings `bytes` bytes of `src` back.
    pub fn read_buffer(&mut self, src: BufferId, offset: u64, bytes: u64) -> Ticket {
        let ticket = Ticket::next();
        self.commands.push(Command::ReadBuffer { src, offset, bytes, ticket });
        ticket
    }

    /// Brings a texture back.
    pub fn read_texture(&mut self, src: TextureId) -> Ticket {
        let ticket = Ticket::next();
        self.commands.push(Command::ReadTexture { src, ticket });
        ticket
    }

    /// The compute and raster passes with their labels, in order.
    pub fn passes(&self) -> impl Iterator<Item = (Label, &Command)> {
        self.commands.iter().filter_map(|command| match command {
            Command::Compute(pass) => Some((pass.kernel.label(), command)),
            Command::Raster(pass) => Some((pass.label, command)),
            _ => None,
        })
    }

    /// Labels of the compute and raster passes, in order.
    pub fn labels(&self) -> impl Iterator<Item = Label> {
        self.passes().map(|(label, _)| label)
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
}
