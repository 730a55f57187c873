//! The kernels of tiles: `hair.render.tile_depth`, `tile_points`, `tile_bin`, `tile_alloc`, `tile_blend` and `tile_reopen`.

use std::hash::Hash;

use tressfx_core::backend::Backend;
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, Groups, PassList};
use tressfx_core::shader::{Module, Specialization};

use super::TilesDesc;
use super::layout::points_grid;
use super::memory::Memory;
use crate::bound::Pass;
use crate::output::Output;
use crate::places::at_places;
use crate::resolved::tile_count;
use crate::shaders::{FRONT, GROUP, compute, with_shared};
use crate::strands::SectionDraw;
use crate::views::BoundView;

const LIBRARY: &[Module] = &with_shared::<12, 30>([
    ("blocks", include_str!("../../shaders/tiles/blocks.wgsl")),
    ("cuts", include_str!("../../shaders/tiles/cuts.wgsl")),
    ("entries", include_str!("../../shaders/tiles/entries.wgsl")),
    FRONT,
    ("hidden", include_str!("../../shaders/tiles/hidden.wgsl")),
    ("joined", include_str!("../../shaders/tiles/joined.wgsl")),
    ("mean", include_str!("../../shaders/tiles/mean.wgsl")),
    ("quarter", include_str!("../../shaders/tiles/quarter.wgsl")),
    ("segments", include_str!("../../shaders/tiles/segments.wgsl")),
    ("tiles", include_str!("../../shaders/tiles/tiles.wgsl")),
    ("turns", include_str!("../../shaders/tiles/turns.wgsl")),
    ("unit", include_str!("../../shaders/tiles/unit.wgsl")),
]);

/// Places that a lane of `tile_blend` blends, unless there are too many.
const PLACES_OF_A_LANE: u32 = 4;

/// Pixels that a group blends.
const PIXELS_OF_A_QUARTER: u32 = 16;

/// Lanes of a pixel at most: so many for each of 16 pixels are not more than the group has.
const MOST_LANES_OF_A_PIXEL: u32 = 8;

/// References of a pixel with hair up to which the fewest lanes are best, and up to which more are. (Hair of 8,192, 16,384, 32,768 and 65,536 strands in a picture of
/// 1920x1080 has 3.4, 6.4, 13 and 25; measured on an H200, with 64 slices of depth.)
const MOST_REFERENCES: [f64; 2] = [4.7, 18.0];

/// Lanes of a group of `tile_blend` at most, where a pixel has more than one place.
const MOST_LANES_WITH_PLACES: u32 = 160;

/// Lanes of a group of `tile_blend` on a CPU.
const LANES_ON_A_CPU: u32 = 160;

/// How many lanes a group of `tile_blend` may have, at so many places of a pixel: not fewer than those of it that blend, and not more than there is group memory for where a
/// fragment takes more of it.
fn lanes(desc: &TilesDesc, is_cpu: bool) -> Result<Vec<u32>> {
    let least = PIXELS_OF_A_QUARTER * lanes_of_a_pixel(desc.places);
    let most = if desc.places == 1 { u32::MAX } else { MOST_LANES_WITH_PLACES };
    let can_be: Vec<_> = TilesDesc::LANES.into_iter().filter(|lanes| (least..=most).contains(lanes)).collect();
    match desc.lanes {
        None if is_cpu => Ok(vec![LANES_ON_A_CPU]),
        None => Ok(can_be),
        Some(lanes) if can_be.contains(&lanes) => Ok(vec![lanes]),
        Some(lanes) => {
            let can_be = can_be.iter().map(u32::to_string).collect::<Vec<_>>().join(" or ");
            let what =
                format!("{lanes} lanes of a group with {} places in a pixel, there can be {can_be}", desc.places);
            Err(Error::rule("hair.render.tiles", what))
        }
    }
}

/// Which of these numbers of lanes is best for so many references a pixel with hair.
fn best(lanes: &[u32], references: f64) -> usize {
    let best = TilesDesc::LANES[MOST_REFERENCES.iter().filter(|most| references > **most).count()];
    lanes.iter().position(|lanes| *lanes >= best).unwrap_or(lanes.len() - 1)
}

/// Lanes that share the places of a pixel.
fn lanes_of_a_pixel(places: u32) -> u32 {
    (places / PLACES_OF_A_LANE).clamp(1, MOST_LANES_OF_A_PIXEL)
}

/// Lanes that share a tile: a row of pixels each in `tile_depth`, a part of the slices in `tile_alloc`.
const LANES_OF_A_TILE: u32 = 8;

/// A kernel of tiles, by view and by what else its bindings may differ in.
fn pass<K: Eq + Hash>(
    backend: &mut dyn Backend,
    label: Label,
    root: Module,
    specialization: &Specialization,
) -> Result<Pass<(usize, K)>> {
    compute(backend, label, root, LIBRARY, specialization).map(Pass::new)
}

/// The kernels in the order in which they run; `bin` runs before and behind `alloc`, and behind `reopen` they run again.
#[derive(Debug)]
pub(crate) struct Kernels {
    /// By the scene.
    depth: Pass<(usize, TextureId)>,
    /// By section.
    points: Pass<(usize, BufferId)>,
    /// By the round that it stores, or none.
    bin: Pass<(usize, Option<u32>)>,
    alloc: Pass<(usize, ())>,
    /// By the scene and the round: those with fewer lanes first.
    blend: Vec<Pass<(usize, (TextureId, u32))>>,
    /// Lanes of a group of each of them, and which of them runs.
    lanes: Vec<u32>,
    chosen: usize,
    reopen: Pass<(usize, ())>,
}

/// The groups of `tile_bin` where there are at most so many vertices.
pub(crate) fn bin_grid(vertices: u32) -> Grid {
    Grid::for_threads(vertices, GROUP)
}

/// The groups of `tile_alloc`, and of `tile_depth`.
pub(crate) fn alloc_grid(size: [u32; 2]) -> Grid {
    Grid::for_threads(tile_count(size) * LANES_OF_A_TILE, GROUP)
}

impl Kernels {
    /// At how many places of a pixel light passes for itself is known to `blend` alone, as is what drivers of CPUs do to loops (`turns.wgsl`).
    pub(crate) fn new(backend: &mut dyn Backend, output: Output, desc: &TilesDesc) -> Result<Self> {
        let is_cpu = backend.caps().is_cpu;
        let blended = output.specialization().feature("few_turns", is_cpu);
        let blended = at_places(blended, desc.places, lanes_of_a_pixel(desc.places));
        let points = ("tile_points", include_str!("../../shaders/tiles/tile_points.wgsl"));
        let depth = ("tile_depth", include_str!("../../shaders/tiles/tile_depth.wgsl"));
        let bin = ("tile_bin", include_str!("../../shaders/tiles/tile_bin.wgsl"));
        let alloc = ("tile_alloc", include_str!("../../shaders/tiles/tile_alloc.wgsl"));
        let blend = ("tile_blend", include_str!("../../shaders/tiles/tile_blend.wgsl"));
        let reopen = ("tile_reopen", include_str!("../../shaders/tiles/tile_reopen.wgsl"));
        let plain = Specialization::new();
        let lanes = lanes(desc, is_cpu)?;
        let blend = lanes
            .iter()
            .map(|&lanes| pass(backend, "hair.render.tile_blend", blend, &blended.clone().constant("LANES", lanes)));
        let blend = blend.collect::<Result<_>>()?;
        Ok(Self {
            blend,
            chosen: lanes.len() / 2,
            lanes,
            points: pass(backend, "hair.render.tile_points", points, &output.walk())?,
            depth: pass(backend, "hair.render.tile_depth", depth, &plain)?,
            bin: pass(backend, "hair.render.tile_bin", bin, &plain)?,
            alloc: pass(backend, "hair.render.tile_alloc", alloc, &plain)?,
            reopen: pass(backend, "hair.render.tile_reopen", reopen, &plain)?,
        })
    }

    /// From now on groups have as many lanes as are best for so many references a pixel with hair.
    pub(crate) fn choose(&mut self, references: f64) {
        self.chosen = best(&self.lanes, references);
    }

    pub(crate) fn begin_frame(&mut self) {
        self.points.begin_frame();
        self.depth.begin_frame();
        self.bin.begin_frame();
        self.alloc.begin_frame();
        self.blend.iter_mut().for_each(|blend| blend.begin_frame());
        self.reopen.begin_frame();
    }

    pub(crate) fn forget_bindings(&mut self) {
        self.points.forget_bindings();
        self.depth.forget_bindings();
        self.bin.forget_bindings();
        self.alloc.forget_bindings();
        self.blend.iter_mut().for_each(|blend| blend.forget_bindings());
        self.reopen.forget_bindings();
    }

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 6] {
        let Self { points, depth, bin, alloc, blend, reopen, .. } = self;
        let kernels = [&points.kernel, &depth.kernel, &bin.kernel, &alloc.kernel, &blend[0].kernel, &reopen.kernel];
        kernels.map(|kernel| &*kernel.shader)
    }

    /// What may be seen of a section, behind what there is of others.
    pub(crate) fn points(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draw: &SectionDraw,
        memory: &Memory,
    ) -> Result<()> {
        let strands = draw.strands;
        let resources = [
            ("view", view.uniform),
            ("section", strands.uniform.into()),
            ("positions", strands.buffers.positions.into()),
            ("colors", strands.colors.into()),
            ("thickness", strands.thickness().into()),
            ("tiles", memory.uniform(view.index, None)),
            ("vertices", memory.vertices.points.into()),
            ("paints", memory.vertices.paints.into()),
            ("state", memory.counters.of(view.index).into()),
            ("infos", memory.screen.infos.into()),
        ];
        self.points.record(list, (view.index, strands.colors), Groups::Grid(points_grid(draw)), &resources)
    }

    /// The farthest that the scene shows in each tile.
    pub(crate) fn depth(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        memory: &Memory,
        scene_depth: TextureId,
    ) -> Result<()> {
        let resources = [
            ("view", view.uniform),
            ("tiles", memory.uniform(view.index, None)),
            ("state", memory.counters.of(view.index).into()),
            ("scene_depth", scene_depth.into()),
            ("infos", memory.screen.infos.into()),
        ];
        self.depth.record(list, (view.index, scene_depth), Groups::Grid(alloc_grid(view.size)), &resources)
    }

    /// The references of each bin: counted, or stored in a round.
    pub(crate) fn bin(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        memory: &Memory,
        round: Option<u32>,
        groups: Groups,
    ) -> Result<()> {
        let resources = [
            ("view", view.uniform),
            ("tiles", memory.uniform(view.index, round)),
            ("vertices", memory.vertices.points.into()),
            ("state", memory.counters.of(view.index).into()),
            ("infos", memory.screen.infos.into()),
            ("bins", memory.screen.bins.into()),
            ("references", memory.references.buffer.into()),
            ("blocks", memory.screen.blocks.into()),
        ];
        self.bin.record(list, (view.index, round), groups, &resources)
    }

    /// Places for the references, and the queue of tiles.
    pub(crate) fn alloc(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        memory: &Memory,
        groups: Groups,
    ) -> Result<()> {
        let resources = [
            ("view", view.uniform),
            ("tiles", memory.uniform(view.index, None)),
            ("state", memory.counters.of(view.index).into()),
            ("bins", memory.screen.bins.into()),
            ("queue", memory.screen.queue.into()),
            ("hairy", memory.screen.resolved.tiles.into()),
            ("tile_vertices", memory.screen.resolved.draw.into()),
            ("grids", memory.grids.into()),
            ("infos", memory.screen.infos.into()),
        ];
        self.alloc.record(list, (view.index, ()), groups, &resources)
    }

    /// Tiles in which too much was left out are empty again.
    pub(crate) fn reopen(&mut self, list: &mut PassList, view: &BoundView, memory: &Memory) -> Result<()> {
        let resources = [
            ("view", view.uniform),
            ("tiles", memory.uniform(view.index, None)),
            ("state", memory.counters.of(view.index).into()),
            ("infos", memory.screen.infos.into()),
            ("bins", memory.screen.bins.into()),
            ("grids_again", memory.grids_again.into()),
            ("blocks", memory.screen.blocks.into()),
        ];
        let grid = Grid::for_threads(tile_count(view.size), GROUP);
        self.reopen.record(list, (view.index, ()), Groups::Grid(grid), &resources)
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
            ("vertices", memory.vertices.points.into()),
            ("paints", memory.vertices.paints.into()),
            ("state", memory.counters.of(view.index).into()),
            ("scene_depth", scene_depth.into()),
            ("bins", memory.screen.bins.into()),
            ("queue", memory.screen.queue.into()),
            ("references", memory.references.buffer.into()),
            ("resolved", memory.screen.resolved.colors.into()),
            ("infos", memory.screen.infos.into()),
        ];
        self.blend[self.chosen].record(list, (view.index, (scene_depth, round)), memory.blend_groups(), &resources)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_denser_hair_is_the_more_lanes() {
        let all = lanes(&TilesDesc::default(), false).unwrap();
        let chosen: Vec<_> =
            [0.0, 3.4, 6.4, 13.0, 25.0, 1e9].iter().map(|references| all[best(&all, *references)]).collect();
        assert_eq!(chosen, [96, 96, 160, 160, 224, 224]);
        let some = lanes(&TilesDesc::default().places(64), false).unwrap();
        assert_eq!(some, [160], "fewer do not blend 64 places, more have no room for them");
        let some = lanes(&TilesDesc::default().places(4), false).unwrap();
        let chosen: Vec<_> = [0.0, 6.4, 25.0].iter().map(|references| some[best(&some, *references)]).collect();
        assert_eq!(chosen, [96, 160, 160]);
        let one = lanes(&TilesDesc::default().lanes(96), false).unwrap();
        assert_eq!(one[best(&one, 25.0)], 96, "what is asked for");
        assert_eq!(lanes(&TilesDesc::default(), true).unwrap(), [160], "on a CPU");
    }
}
