//! The kernels that find hidden hair, in the order in which they run; `occlusion_list` runs twice.

use tressfx_core::backend::Backend;
use tressfx_core::error::{Label, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, Groups, PassList};
use tressfx_core::shader::{Binding, Module, Specialization};

use super::STRIDE;
use super::memory::{Listed, Memory};
use crate::bound::Pass;
use crate::output::Output;
use crate::resolved::tile_count;
use crate::segments::walking;
use crate::shaders::{GROUP, compute, with_shared};
use crate::strands::SectionDraw;
use crate::views::BoundView;

const LIBRARY: &[Module] = &with_shared::<2, 20>([
    ("occlusion", include_str!("../../shaders/occlusion/occlusion.wgsl")),
    ("sink", include_str!("../../shaders/occlusion/occlusion_sink.wgsl")),
]);

/// Lanes of a group of `occlusion_list`.
const LIST_LANES: u32 = 256;

/// Segments of a strand that one of them looks at.
const SEGMENTS_OF_A_LANE: u32 = 4;

/// A section in a view before a scene.
type Key = (usize, BufferId, TextureId);

/// The same with the place of its list.
type ListKey = (Key, [u64; 2]);

/// The hair in which hidden hair is looked for, and where it is kept what is found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hair<'a> {
    pub(super) view: &'a BoundView<'a>,
    pub(super) draws: &'a [SectionDraw<'a>],
    /// Depth of the opaque scene.
    pub(super) scene: TextureId,
    pub(super) memory: &'a Memory,
    pub(super) lists: &'a [Listed],
}

impl Hair<'_> {
    fn key(&self, draw: &SectionDraw) -> Key {
        (self.view.index, draw.strands.colors, self.scene)
    }
}

#[derive(Debug)]
pub(super) struct Kernels {
    mass: Pass<Key>,
    guess: Pass<(usize, TextureId)>,
    list: Pass<ListKey>,
    sums: Pass<ListKey>,
    depth: Pass<(usize, TextureId)>,
}

impl Kernels {
    pub(super) fn new(backend: &mut dyn Backend, output: Output) -> Result<Self> {
        let make = |backend: &mut dyn Backend, label: Label, root: Module, specialization: &Specialization| {
            compute(backend, label, root, LIBRARY, specialization)
        };
        let (walk, plain) = (output.walk(), Specialization::new());
        let sums = walking(backend, &walk).feature("listed", true);
        let mass = ("occlusion_mass", include_str!("../../shaders/occlusion/occlusion_mass.wgsl"));
        let guess = ("occlusion_guess", include_str!("../../shaders/occlusion/occlusion_guess.wgsl"));
        let list = ("occlusion_list", include_str!("../../shaders/occlusion/occlusion_list.wgsl"));
        let sum = ("occlusion_sums", include_str!("../../shaders/occlusion/occlusion_sums.wgsl"));
        let depth = ("occlusion_depth", include_str!("../../shaders/occlusion/occlusion_depth.wgsl"));
        Ok(Self {
            mass: Pass::new(make(backend, "hair.render.occlusion_mass", mass, &walk)?),
            guess: Pass::new(make(backend, "hair.render.occlusion_guess", guess, &plain)?),
            list: Pass::new(make(backend, "hair.render.occlusion_list", list, &walk)?),
            sums: Pass::new(make(backend, "hair.render.occlusion_sums", sum, &sums)?),
            depth: Pass::new(make(backend, "hair.render.occlusion_depth", depth, &plain)?),
        })
    }

    pub(super) fn begin_frame(&mut self) {
        let Self { mass, guess, list, sums, depth } = self;
        mass.begin_frame();
        [list, sums].into_iter().for_each(Pass::begin_frame);
        [guess, depth].into_iter().for_each(Pass::begin_frame);
    }

    pub(super) fn forget_bindings(&mut self) {
        let Self { mass, guess, list, sums, depth } = self;
        mass.forget_bindings();
        [list, sums].into_iter().for_each(Pass::forget_bindings);
        [guess, depth].into_iter().for_each(Pass::forget_bindings);
    }

    /// Finds what is seen farthest in each pixel, and lists the segments that are not behind it.
    pub(super) fn find(&mut self, list: &mut PassList, of: &Hair) -> Result<()> {
        let &Hair { view, draws, scene, memory, lists } = of;
        let shared = [("view", view.uniform), ("occlusion", memory.uniforms.binding(view.index))];
        let [tiles, opticals] = [("tiles", memory.tiles.into()), ("opticals", memory.opticals.into())];
        let masses = ("masses", memory.masses.into());
        let depth: (&str, Binding) = ("scene_depth", scene.into());
        for draw in draws {
            let [strands @ .., _] = draw.strands.bindings(view, scene);
            let lod = draw.lod_uniform();
            let grid = Grid::for_threads(lod.strands.div_ceil(STRIDE) * (lod.vertices - 1), GROUP);
            self.mass.record(list, of.key(draw), Groups::Grid(grid), &[&strands[..], &[shared[1], masses]].concat())?;
        }
        let all = Groups::Grid(Grid::for_threads(tile_count(view.size), GROUP));
        self.guess.record(list, (view.index, scene), all, &[shared[0], shared[1], masses, tiles, depth])?;
        self.list(list, of)?;
        for (draw, listed) in draws.iter().zip(lists) {
            let strands = draw.strands.bindings(view, scene);
            let own = [shared[1], tiles, opticals, listed.binding()];
            let (buffer, offset) = listed.groups;
            let key = (of.key(draw), listed.place());
            self.sums.record(list, key, Groups::Indirect { buffer, offset }, &[&strands[..], &own].concat())?;
        }
        let own = [shared[0], shared[1], tiles, opticals, depth, ("occluded", memory.depth.into())];
        self.depth.record(list, (view.index, scene), Groups::Grid(view.region.grid()), &own)?;
        self.list(list, of)
    }

    /// Lists the segments that are not behind the farthest of their tiles.
    fn list(&mut self, list: &mut PassList, of: &Hair) -> Result<()> {
        for (draw, listed) in of.draws.iter().zip(of.lists) {
            of.memory.empty(list, listed);
            let [view, section, positions, _, thickness, _] = draw.strands.bindings(of.view, of.scene);
            let own = [("tiles", of.memory.tiles.into()), ("list", listed.segments), ("grid", listed.grid)];
            let lod = draw.lod_uniform();
            let threads = lod.strands * (lod.vertices - 1).div_ceil(SEGMENTS_OF_A_LANE);
            let grid = Grid::for_threads(threads, LIST_LANES);
            let all = [&[view, section, positions, thickness][..], &own].concat();
            self.list.record(list, (of.key(draw), listed.place()), Groups::Grid(grid), &all)?;
        }
        Ok(())
    }
}
