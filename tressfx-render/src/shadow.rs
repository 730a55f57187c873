//! Shadows of hair on hair, made anew in each frame: how much of the sky and of each light arrives at each strand vertex.
//!
//! Each light that casts has a box of cells around the hair, as the light sees it. What fibres take in each cell is counted, and summed up
//! along the way of the light: opacity shadow maps (Kim and Neumann 2001). The sky has a box in the axes of the world, through which light is followed from
//! 26 directions. A light that has no box, because there are more than [`ShadowDesc::lights`] or because it stands among the hair, is taken
//! from what arrives from everywhere, in its direction. Skin is where roots are, if hair grows on any: light does not pass behind them.
//!
//! A fibre takes the share [`Material::shadow_alpha`](crate::Material::shadow_alpha) of the light that meets it.

mod frames;
mod kernels;
mod opaque;

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::Binding;
use tressfx_core::uniform_array::UniformArray;

use crate::lights::{Lights, OpaqueDepth, STORED_LIGHTS};
use crate::shaders::GROUP;
use crate::strands::SectionDraw;
use crate::views::MAX_VIEWS;
use frames::cells_of_all;
pub use frames::{ShadowFrameUniform, ShadowUniform};
use kernels::Kernels;
pub use kernels::SHADOW_MODULES;
pub use opaque::{OpaqueScenesUniform, OpaqueUniform};

const LABEL: Label = "hair.render.shadow";

/// How shadows are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ShadowDesc {
    /// Cells across what a light sees, each way: 8 to 1024.
    pub texels: u32,
    /// Cells along the way of a light: 8 to 1024.
    pub layers: u32,
    /// Cells of the sky's box along each axis: 8 to 256.
    pub cells: u32,
    /// How many lights can have a box of their own in a frame: 0 to 8. Each takes `4 * texels * texels * layers` bytes.
    pub lights: u32,
    /// Strands of a section that are counted at most; of more an even sample stands for all. At least 1.
    pub samples: u32,
    /// Whether hair grows on skin that light does not pass. Where the opaque scene is not known, as in the light of the sky, skin is then taken
    /// to be behind the roots of strands.
    pub skin: bool,
}

/// Cells that are left however small a groom is seen.
const LEAST_CELLS: u32 = 8;

impl Default for ShadowDesc {
    /// Three lights with 192 x 192 x 48 cells, 21 MB, 32 cells along the longest side of the groom, and skin behind roots.
    fn default() -> Self {
        Self { texels: 192, layers: 48, cells: 32, lights: 3, samples: 32_768, skin: true }
    }
}

impl ShadowDesc {
    /// The same with another number of cells across and along the way of a light.
    #[must_use]
    pub fn texels(self, texels: u32, layers: u32) -> Self {
        Self { texels, layers, ..self }
    }

    /// The same with another number of cells along each axis of the sky's box.
    #[must_use]
    pub fn cells(self, cells: u32) -> Self {
        Self { cells, ..self }
    }

    /// The same with boxes for so many lights.
    #[must_use]
    pub fn lights(self, lights: u32) -> Self {
        Self { lights, ..self }
    }

    /// The same with another number of strands that are counted.
    #[must_use]
    pub fn samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// The same with skin behind the roots of strands, or with nothing that hair grows on.
    #[must_use]
    pub fn skin(self, skin: bool) -> Self {
        Self { skin, ..self }
    }

    /// The cells for what is drawn of these: where fewer strands are, since they are seen from further away, the sky's are larger. Their number falls in
    /// steps of the fourth root of two, so that it seldom changes. Those of lights stay: what shines between locks would be lost, a tenth of the light.
    pub(crate) fn coarser(&self, draws: &[SectionDraw]) -> Self {
        let share = draws.iter().map(|draw| draw.lod.share).fold(f32::MIN_POSITIVE, f32::max);
        let scale = (-0.25 * (-share.log2()).floor()).exp2();
        let cells = (self.cells as f32 * scale).round() as u32;
        Self { cells: cells.max(LEAST_CELLS.min(self.cells)), ..*self }
    }

    fn check(&self) -> Result<()> {
        let checks = [
            ("texels", self.texels, 8..=1024),
            ("layers", self.layers, 8..=1024),
            ("cells", self.cells, 8..=256),
            ("lights", self.lights, 0..=STORED_LIGHTS as u32),
            ("samples", self.samples, 1..=1 << 20),
        ];
        if u32::try_from(cells_of_all(self)).is_err() {
            return Err(Error::rule(LABEL, format!("{} cells, there can be {}", cells_of_all(self), u32::MAX)));
        }
        match checks.into_iter().find(|(_, value, range)| !range.contains(value)) {
            None => Ok(()),
            Some((name, value, range)) => {
                let message = format!("{name} is {value}, it must be from {} to {}", range.start(), range.end());
                Err(Error::rule(LABEL, message))
            }
        }
    }
}

/// What shadows keep.
#[derive(Debug)]
pub(crate) struct Memory {
    pub(crate) uniforms: UniformArray<ShadowUniform>,
    /// [`OpaqueScenesUniform`] of each texture of each set.
    scenes: UniformArray<OpaqueScenesUniform>,
    /// Six whole numbers a frame: see `grids.wgsl`.
    pub(crate) bounds: BufferId,
    /// `u32` a cell of all frames.
    pub(crate) cells: BufferId,
    /// `vec2<u32>` a cell of the sky.
    pub(crate) sky: BufferId,
    cell_count: u64,
}

/// Shadows are made at most so many times in a frame: once for the caller's surfaces, and for each view in another light.
const SETS: usize = 1 + MAX_VIEWS;

/// Bytes of the boxes of all frames.
const BOUNDS_BYTES: u64 = 24 * (1 + STORED_LIGHTS as u64);

impl Memory {
    fn new(backend: &mut dyn Backend, desc: &ShadowDesc) -> Result<Self> {
        let cell_count = cells_of_all(desc);
        let sky = 8 * u64::from(desc.cells).pow(3);
        let mut storage = |label, bytes| backend.create_buffer(&BufferDesc::storage(label, bytes));
        Ok(Self {
            bounds: storage("hair.render.shadow_bounds", BOUNDS_BYTES)?,
            cells: storage("hair.render.shadow_cells", 4 * cell_count)?,
            sky: storage("hair.render.shadow_sky", sky)?,
            uniforms: UniformArray::new(backend, "hair.render.shadows", SETS)?,
            scenes: UniformArray::new(backend, "hair.render.opaque_scenes", SETS * STORED_LIGHTS)?,
            cell_count,
        })
    }

    /// What the module `hair_shadow` of the shaders binds.
    pub(crate) fn bindings(&self, set: usize) -> [(&'static str, Binding); 4] {
        [
            ("shadow", self.uniforms.binding(set)),
            ("bounds", self.bounds.into()),
            ("cells", self.cells.into()),
            ("sky", self.sky.into()),
        ]
    }
}

/// Shadows at work.
#[derive(Debug)]
pub(crate) struct Shadows {
    desc: ShadowDesc,
    kernels: Kernels,
    memory: Memory,
}

impl Shadows {
    pub(crate) fn new(backend: &mut dyn Backend, desc: &ShadowDesc, copies: bool) -> Result<Self> {
        desc.check()?;
        Ok(Self { desc: *desc, kernels: Kernels::new(backend, copies)?, memory: Memory::new(backend, desc)? })
    }

    pub(crate) fn begin(&mut self) {
        self.kernels.begin_frame();
    }

    /// Bytes of its buffers.
    pub(crate) fn bytes(&self) -> u64 {
        let Memory { uniforms, scenes, cell_count, .. } = &self.memory;
        BOUNDS_BYTES + 4 * cell_count + 8 * u64::from(self.desc.cells).pow(3) + uniforms.bytes() + scenes.bytes()
    }

    /// What the module `hair_shadow` of the shaders binds for the first set of a frame.
    pub(crate) fn bindings(&self) -> [(&'static str, Binding); 4] {
        self.memory.bindings(0)
    }

    /// Writes the passes that find what arrives at the sections in some light, as the set of this number in the frame. Where nothing casts and the
    /// sky is dark there is no pass. Returns whether there is.
    pub(crate) fn passes(
        &mut self,
        list: &mut PassList,
        set: usize,
        lights: &Lights,
        draws: &[SectionDraw],
    ) -> Result<bool> {
        let uniform = ShadowUniform::new(&self.desc, lights, draws);
        self.memory.uniforms.upload(list, set, &[uniform]);
        if uniform.first == uniform.end {
            return Ok(false);
        }
        let desc = self.desc.coarser(draws);
        self.count(list, set, &desc, draws)?;
        let Self { kernels, memory, .. } = self;
        if uniform.end > 1 {
            let rows = (uniform.end - 1) * desc.texels * desc.texels;
            kernels.sum(list, set, memory, Grid::for_threads(rows, GROUP))?;
        }
        if uniform.first == 0 {
            kernels.sky(list, set, memory, desc.cells)?;
        }
        for draw in draws {
            kernels.light(list, set, draw, memory)?;
        }
        self.opaque(list, set, lights, draws)?;
        Ok(true)
    }

    /// Counts what hair takes in each cell.
    fn count(&mut self, list: &mut PassList, set: usize, desc: &ShadowDesc, draws: &[SectionDraw]) -> Result<()> {
        let Self { kernels, memory, .. } = self;
        list.clear(memory.bounds, 0, BOUNDS_BYTES);
        list.clear(memory.cells, 0, 4 * cells_of_all(desc));
        draws.iter().try_for_each(|draw| kernels.bounds(list, set, draw, memory, desc))?;
        draws.iter().try_for_each(|draw| kernels.splat(list, set, draw, memory, desc))
    }

    /// The shadows of opaque scenes: lights whose depth is in one texture share a pass.
    fn opaque(&mut self, list: &mut PassList, set: usize, lights: &Lights, draws: &[SectionDraw]) -> Result<()> {
        let Self { kernels, memory, .. } = self;
        let casting = lights.lights.iter().take(STORED_LIGHTS).enumerate().filter(|(_, light)| light.casts);
        let mut left: Vec<_> = casting.filter_map(|(index, light)| Some((index, light.opaque?))).collect();
        while let Some((place, OpaqueDepth { depth, .. })) = left.first().copied() {
            let (same, others): (Vec<_>, _) = left.into_iter().partition(|(_, scene)| scene.depth == depth);
            let place = set * STORED_LIGHTS + place;
            memory.scenes.upload(list, place, &[OpaqueScenesUniform::new(&same)]);
            let uniform = (place, memory.scenes.binding(place));
            draws.iter().try_for_each(|draw| kernels.opaque(list, uniform, depth, draw))?;
            left = others;
        }
        Ok(())
    }

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 6] {
        self.kernels.shaders()
    }
}
