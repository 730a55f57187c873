//! The kernels of shadows: `hair.render.shadow_bounds`, `shadow_splat`, `shadow_sum`, `shadow_sky`, `shadow_light` and
//! `shadow_opaque`.

use tressfx_core::backend::Backend;
use tressfx_core::error::{Label, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Binding, Kernel, Module};

use super::{Memory, ShadowDesc};
use crate::bound::Bound;
use crate::output::walk;
use crate::shaders::{GROUP, compute, with_shared};
use crate::strands::SectionDraw;

const LIBRARY: &[Module] = &with_shared::<4, 22>([
    ("frames", include_str!("../../shaders/shadow/frames.wgsl")),
    ("grids", include_str!("../../shaders/shadow/grids.wgsl")),
    ("hair_shadow", include_str!("../../shaders/shadow/hair_shadow.wgsl")),
    ("shares", include_str!("../../shaders/shadow/shares.wgsl")),
]);

/// What the shader of a surface imports to ask `hair_light` and `hair_sky` of the module `hair_shadow` what hair leaves of the light there. It binds
/// [`HairRenderer::shadow_bindings`](crate::HairRenderer::shadow_bindings).
pub const SHADOW_MODULES: [Module; 3] = [LIBRARY[0], LIBRARY[1], LIBRARY[2]];

/// The set of shadows or its light, the section, and the scene.
type Key = (usize, Option<BufferId>, Option<TextureId>);

/// A kernel and its bindings.
#[derive(Debug)]
struct Pass {
    kernel: Kernel,
    bound: Bound<Key>,
}

impl Pass {
    fn new(backend: &mut dyn Backend, label: Label, root: Module, copies: bool) -> Result<Self> {
        let kernel = compute(backend, label, root, LIBRARY, &walk(copies))?;
        Ok(Self { kernel, bound: Bound::new() })
    }

    fn record(&mut self, list: &mut PassList, key: Key, grid: Grid, resources: &[(&str, Binding)]) -> Result<()> {
        let bindings = self.bound.get(key, || self.kernel.bind(resources))?;
        list.compute(&self.kernel, &bindings, grid);
        Ok(())
    }
}

/// The kernels in the order in which they run.
#[derive(Debug)]
pub(super) struct Kernels {
    bounds: Pass,
    splat: Pass,
    sum: Pass,
    sky: Pass,
    light: Pass,
    opaque: Pass,
}

/// Vertices of a strand that a thread of `shadow_bounds` looks at.
const PIECE: u32 = 8;
/// Threads of `shadow_sky` for a cell.
const LANES_OF_A_CELL: u32 = 32;

/// Strands of a section that are counted.
fn samples(draw: &SectionDraw, desc: &ShadowDesc) -> u32 {
    draw.shadow_strands().min(desc.samples)
}

impl Kernels {
    pub(super) fn new(backend: &mut dyn Backend, copies: bool) -> Result<Self> {
        let bounds = ("shadow_bounds", include_str!("../../shaders/shadow/shadow_bounds.wgsl"));
        let splat = ("shadow_splat", include_str!("../../shaders/shadow/shadow_splat.wgsl"));
        let sum = ("shadow_sum", include_str!("../../shaders/shadow/shadow_sum.wgsl"));
        let sky = ("shadow_sky", include_str!("../../shaders/shadow/shadow_sky.wgsl"));
        let light = ("shadow_light", include_str!("../../shaders/shadow/shadow_light.wgsl"));
        let opaque = ("shadow_opaque", include_str!("../../shaders/shadow/shadow_opaque.wgsl"));
        Ok(Self {
            bounds: Pass::new(backend, "hair.render.shadow_bounds", bounds, copies)?,
            splat: Pass::new(backend, "hair.render.shadow_splat", splat, copies)?,
            sum: Pass::new(backend, "hair.render.shadow_sum", sum, false)?,
            sky: Pass::new(backend, "hair.render.shadow_sky", sky, false)?,
            light: Pass::new(backend, "hair.render.shadow_light", light, false)?,
            opaque: Pass::new(backend, "hair.render.shadow_opaque", opaque, false)?,
        })
    }

    pub(super) fn begin_frame(&mut self) {
        let Self { bounds, splat, sum, sky, light, opaque } = self;
        [bounds, splat, sum, sky, light, opaque].into_iter().for_each(|pass| pass.bound.begin_frame());
    }

    #[cfg(test)]
    pub(super) fn shaders(&self) -> [&tressfx_core::shader::Shader; 6] {
        let Self { bounds, splat, sum, sky, light, opaque } = self;
        [bounds, splat, sum, sky, light, opaque].map(|pass| &*pass.kernel.shader)
    }

    /// The box of a section in each frame.
    pub(super) fn bounds(
        &mut self,
        list: &mut PassList,
        set: usize,
        draw: &SectionDraw,
        memory: &Memory,
        desc: &ShadowDesc,
    ) -> Result<()> {
        let strands = draw.strands;
        let resources = [
            ("shadow", memory.uniforms.binding(set)),
            ("section", strands.uniform.into()),
            ("positions", strands.buffers.positions.into()),
            ("bounds", memory.bounds.into()),
        ];
        let pieces = draw.lod_uniform().vertices.div_ceil(PIECE);
        let grid = Grid::for_threads(samples(draw, desc) * pieces, GROUP);
        self.bounds.record(list, (set, Some(strands.arriving), None), grid, &resources)
    }

    /// What a section takes in each cell.
    pub(super) fn splat(
        &mut self,
        list: &mut PassList,
        set: usize,
        draw: &SectionDraw,
        memory: &Memory,
        desc: &ShadowDesc,
    ) -> Result<()> {
        let strands = draw.strands;
        let resources = [
            ("shadow", memory.uniforms.binding(set)),
            ("bounds", memory.bounds.into()),
            ("section", strands.uniform.into()),
            ("positions", strands.buffers.positions.into()),
            ("thickness", strands.thickness().into()),
            ("cells", memory.cells.into()),
        ];
        let segments = samples(draw, desc) * (draw.lod_uniform().vertices - 1);
        let grid = Grid::for_threads(segments, GROUP);
        self.splat.record(list, (set, Some(strands.arriving), None), grid, &resources)
    }

    /// What is taken up to the end of each cell.
    pub(super) fn sum(&mut self, list: &mut PassList, set: usize, memory: &Memory, grid: Grid) -> Result<()> {
        let resources = [("shadow", memory.uniforms.binding(set)), ("cells", memory.cells.into())];
        self.sum.record(list, (set, None, None), grid, &resources)
    }

    /// What arrives in each cell from everywhere.
    pub(super) fn sky(&mut self, list: &mut PassList, set: usize, memory: &Memory, cells: u32) -> Result<()> {
        let resources =
            [("shadow", memory.uniforms.binding(set)), ("cells", memory.cells.into()), ("sky", memory.sky.into())];
        let grid = Grid::for_threads(LANES_OF_A_CELL * cells.pow(3), GROUP);
        self.sky.record(list, (set, None, None), grid, &resources)
    }

    /// What arrives at each vertex of a section.
    pub(super) fn light(&mut self, list: &mut PassList, set: usize, draw: &SectionDraw, memory: &Memory) -> Result<()> {
        let strands = draw.strands;
        let own = [
            ("section", strands.uniform.into()),
            ("positions", strands.buffers.positions.into()),
            ("arriving", strands.arriving.into()),
        ];
        let resources = [&memory.bindings(set)[..], &own].concat();
        self.light.record(list, (set, Some(strands.arriving), None), draw.shaded_grid(), &resources)
    }

    /// What the opaque scene leaves of some lights at each vertex of a section; `scenes` is an [`OpaqueScenesUniform`](super::OpaqueScenesUniform).
    pub(super) fn opaque(
        &mut self,
        list: &mut PassList,
        scenes: (usize, Binding),
        depth: TextureId,
        draw: &SectionDraw,
    ) -> Result<()> {
        let strands = draw.strands;
        let resources = [
            ("opaque_scenes", scenes.1),
            ("depth", depth.into()),
            ("section", strands.uniform.into()),
            ("positions", strands.buffers.positions.into()),
            ("arriving", strands.arriving.into()),
        ];
        self.opaque.record(list, (scenes.0, Some(strands.arriving), Some(depth)), draw.shaded_grid(), &resources)
    }
}
