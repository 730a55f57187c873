//! The kernels of tiles: `hair.render.tile_points`, `tile_depth`, `tile_bin`, `tile_alloc` and `tile_blend`.

use tressfx_core::backend::Backend;
use tressfx_core::error::{Label, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Binding, Kernel, Module, Specialization};

use super::memory::Memory;
use crate::bound::Bound;
use crate::resolved::tile_count;
use crate::shaders::{GROUP, compute, with_shared};
use crate::strands::SectionDraw;
use crate::views::BoundView;

const LIBRARY: &[Module] = &with_shared::<7, 20>([
    ("entries", include_str!("../../shaders/tiles/entries.wgsl")),
    ("front", include_str!("../../shaders/tiles/front.wgsl")),
    ("mean", include_str!("../../shaders/tiles/mean.wgsl")),
    ("quarter", include_str!("../../shaders/tiles/quarter.wgsl")),
    ("segments", include_str!("../../shaders/tiles/segments.wgsl")),
    ("tiles", include_str!("../../shaders/tiles/tiles.wgsl")),
    ("unit", include_str!("../../shaders/tiles/unit.wgsl")),
]);

/// Lanes that share a tile: a row of pixels each in `tile_depth`, a part of the slices in `tile_alloc`.
const LANES_OF_A_TILE: u32 = 8;

/// A kernel and its bindings by view, and by what else it may differ in.
#[derive(Debug)]
struct Pass<K> {
    kernel: Kernel,
    bound: Bound<(usize, K)>,
}

impl<K: Eq + std::hash::Hash> Pass<K> {
    fn new(backend: &mut dyn Backend, label: Label, root: Module) -> Result<Self> {
        let kernel = compute(backend, label, root, LIBRARY, &Specialization::new())?;
        Ok(Self { kernel, bound: Bound::new() })
    }

    /// Runs over a grid.
    fn record(
        &mut self,
        list: &mut PassList,
        key: (usize, K),
        grid: Grid,
        resources: &[(&str, Binding)],
    ) -> Result<()> {
        let bindings = self.bound.get(key, || self.kernel.bind(resources))?;
        list.compute(&self.kernel, &bindings, grid);
        Ok(())
    }
}

/// The kernels in the order in which they run; `bin` runs before and behind `alloc`.
#[derive(Debug)]
pub(crate) struct Kernels {
    /// By section and its place.
    points: Pass<(BufferId, u32)>,
    /// By the scene.
    depth: Pass<TextureId>,
    /// By the round that it stores, or none.
    bin: Pass<Option<u32>>,
    alloc: Pass<()>,
    /// By the scene and the round.
    blend: Pass<(TextureId, u32)>,
}

impl Kernels {
    pub(crate) fn new(backend: &mut dyn Backend) -> Result<Self> {
        let points = ("tile_points", include_str!("../../shaders/tiles/tile_points.wgsl"));
        let depth = ("tile_depth", include_str!("../../shaders/tiles/tile_depth.wgsl"));
        let bin = ("tile_bin", include_str!("../../shaders/tiles/tile_bin.wgsl"));
        let alloc = ("tile_alloc", include_str!("../../shaders/tiles/tile_alloc.wgsl"));
        let blend = ("tile_blend", include_str!("../../shaders/tiles/tile_blend.wgsl"));
        Ok(Self {
            points: Pass::new(backend, "hair.render.tile_points", points)?,
            depth: Pass::new(backend, "hair.render.tile_depth", depth)?,
            bin: Pass::new(backend, "hair.render.tile_bin", bin)?,
            alloc: Pass::new(backend, "hair.render.tile_alloc", alloc)?,
            blend: Pass::new(backend, "hair.render.tile_blend", blend)?,
        })
    }

    pub(crate) fn begin_frame(&mut self) {
        self.points.bound.begin_frame();
        self.depth.bound.begin_frame();
        self.bin.bound.begin_frame();
        self.alloc.bound.begin_frame();
        self.blend.bound.begin_frame();
    }

    pub(crate) fn forget_bindings(&mut self) {
        self.points.bound.clear();
        self.depth.bound.clear();
        self.bin.bound.clear();
        self.alloc.bound.clear();
        self.blend.bound.clear();
    }

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 5] {
        let Self { points, depth, bin, alloc, blend } = self;
        [&points.kernel.shader, &depth.kernel.shader, &bin.kernel.shader, &alloc.kernel.shader, &blend.kernel.shader]
    }

    /// The vertices of a section on the screen, from the place `first` on.
    pub(crate) fn points(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draw: &SectionDraw,
        memory: &Memory,
        first: u32,
    ) -> Result<()> {
        let (strands, vertices) = (draw.strands, u64::from(draw.strands.buffers.shape.strand_vertices()));
        let first_vertex = u64::from(first);
        let resources = [
            ("view", view.uniform),
            ("section", strands.uniform.into()),
            ("positions", strands.buffers.positions.into()),
            ("colors", strands.colors.into()),
            ("thickness", strands.buffers.thickness.into()),
            ("points", memory.vertices.points.range(16 * first_vertex, 16 * vertices)),
            ("paints", memory.vertices.paints.range(8 * first_vertex, 8 * vertices)),
            ("nearests", memory.screen.nearests.into()),
        ];
        let grid = Grid::for_threads(strands.buffers.shape.strand_vertices(), GROUP);
        self.points.record(list, (view.index, (strands.colors, first)), grid, &resources)
    }

    /// The farthest that the scene shows in each tile.
    pub(crate) fn depth(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        memory: &Memory,
        scene_depth: TextureId,
    ) -> Result<()> {
        let resources =
            [("view", view.uniform), ("scene_depth", scene_depth.into()), ("depths", memory.screen.depths.into())];
        let grid = Grid::for_threads(tile_count(view.size) * LANES_OF_A_TILE, GROUP);
        self.depth.record(list, (view.index, scene_depth), grid, &resources)
    }

    /// The references of each bin: counted, or stored in a round.
    pub(crate) fn bin(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        memory: &Memory,
        segments: u32,
        round: Option<u32>,
    ) -> Result<()> {
        let resources = [
            ("view", view.uniform),
            ("tiles", memory.uniform(view.index, round)),
            ("points", memory.vertices.points.into()),
            ("depths", memory.screen.depths.into()),
            ("bins", memory.screen.bins.into()),
            ("references", memory.references.buffer.into()),
            ("nearests", memory.screen.nearests.into()),
            ("firsts", memory.screen.firsts.into()),
        ];
        self.bin.record(list, (view.index, round), Grid::for_threads(segments, GROUP), &resources)
    }

    /// Places for the references, and the queue of tiles.
    pub(crate) fn alloc(&mut self, list: &mut PassList, view: &BoundView, memory: &Memory) -> Result<()> {
        let resources = [
            ("view", view.uniform),
            ("bins", memory.screen.bins.into()),
            ("queue", memory.screen.queue.into()),
            ("hairy", memory.screen.resolved.tiles.into()),
            ("tile_vertices", memory.screen.resolved.draw.into()),
            ("groups_of_tiles", memory.groups.into()),
            ("firsts", memory.screen.firsts.into()),
            ("nearests", memory.screen.nearests.into()),
        ];
        let grid = Grid::for_threads(tile_count(view.size) * LANES_OF_A_TILE, GROUP);
        self.alloc.record(list, (view.index, ()), grid, &resources)
    }

    /// The pixels of the tiles of a round.
    pub(crate) fn blend(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        memory: &Memory,
        scene_depth: TextureId,
        round: u32,
    ) -> Result<()> {
        let resources = [
            ("view", view.uniform),
            ("tiles", memory.uniform(view.index, Some(round))),
            ("points", memory.vertices.points.into()),
            ("paints", memory.vertices.paints.into()),
            ("counters", memory.counters.of(view.index).into()),
            ("scene_depth", scene_depth.into()),
            ("bins", memory.screen.bins.into()),
            ("queue", memory.screen.queue.into()),
            ("references", memory.references.buffer.into()),
            ("resolved", memory.screen.resolved.colors.into()),
        ];
        let bindings =
            self.blend.bound.get((view.index, (scene_depth, round)), || self.blend.kernel.bind(&resources))?;
        list.compute_indirect(&self.blend.kernel, &bindings, memory.groups, 0);
        Ok(())
    }
}
