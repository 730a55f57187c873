//! Tiles: every fragment of a pixel in its exact order, from front to back until nothing more is seen.
//!
//! The screen is divided into tiles of 8 x 8 pixels, and depth into slices. Segments are referred to from the bins, a slice of a
//! tile, that they touch. A group of lanes then makes the fragments of a tile, slice after slice, sorts them in its own memory and
//! blends them. So fragments are never stored, those that nobody sees are never made, and the memory is that of the references.
//! Unity's high quality lines and Frostbite's hair go through tiles in the same way; they sort segments, not fragments.

mod kernels;
mod layout;
mod memory;

use tressfx_core::backend::Backend;
use tressfx_core::error::{Error, Need, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Groups, PassList};
use tressfx_core::view::View;

use crate::composite::Composite;
use crate::counters::Counters;
use crate::output::Output;
use crate::places::check_places;
use crate::predict;
use crate::renderer::{Targets, with_headroom};
use crate::resolved::{Resolved, check_pixels};
use crate::strands::SectionDraw;
use crate::technique::{Technique, TechniqueInstance, Wanted, another_technique};
use crate::usage::Usage;
use crate::views::BoundView;
use kernels::{Kernels, alloc_grid};
use memory::{Memory, is_tight};

#[cfg(test)]
pub(crate) use layout::TilesUniform;
pub(crate) use layout::{MAX_VERTICES, distances, vertices};
pub(crate) use memory::Vertices;

/// Exact order in tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TilesDesc {
    /// Memory that the references to segments may take, 4 bytes each; at most [`TilesDesc::MAX_REFERENCE_BYTES`]. The device's
    /// own limit for one binding holds too. Where a picture needs more, its tiles are drawn in rounds.
    pub max_reference_bytes: u64,
    /// Transmittance of a pixel below which nothing more is blended into it. With 1/4096 what is left out is less than what half floats round off; dense hair takes up to
    /// a tenth longer than with the default.
    pub closed_below: f32,
    /// Whether segments are left out that were hidden by other hair in the frame before. A tile in which they are not hidden any more
    /// is drawn again with all of them, so that the picture is the same. None: where hair is dense, in more than [`TilesDesc::few_tiles`].
    pub skips_hidden: Option<bool>,
    /// Places in a pixel where light passes hair for itself, one of [`PLACES`](crate::PLACES).
    pub places: u32,
    /// Tiles with hair up to which the pixels of each are divided among 16 groups, not among four: where hair covers little of the
    /// picture, more of the device has work. The picture is the same. Best is about as many as the device can blend at once, each by four
    /// groups of 160 lanes. None: [`TilesDesc::FEW_TILES`], and 0 on a CPU.
    pub few_tiles: Option<u32>,
    /// Lanes of a group that blends, one of [`TilesDesc::LANES`]: with several places in a pixel not the most, and with 64 not the fewest of them. A group of more lanes has room for more fragments at
    /// once, but fewer groups run at once. The picture is the same. None: those that are best for hair as dense as in the frame before, and 160 on
    /// a CPU.
    pub lanes: Option<u32>,
}

impl TilesDesc {
    /// [`TilesDesc::few_tiles`] of a GPU, unless another number is given.
    pub const FEW_TILES: u32 = 256;

    /// How many lanes a group that blends may have.
    pub const LANES: [u32; 3] = [96, 160, 224];

    /// The largest [`TilesDesc::max_reference_bytes`].
    pub const MAX_REFERENCE_BYTES: u64 = 128 << 20;

    /// The same with another number of places in a pixel.
    #[must_use]
    pub fn places(self, places: u32) -> Self {
        Self { places, ..self }
    }

    /// The same with room for at most so many bytes of references.
    #[must_use]
    pub fn max_reference_bytes(self, max_reference_bytes: u64) -> Self {
        Self { max_reference_bytes, ..self }
    }

    /// The same, always with or always without what was hidden in the frame before.
    #[must_use]
    pub fn skips_hidden(self, skips_hidden: impl Into<Option<bool>>) -> Self {
        Self { skips_hidden: skips_hidden.into(), ..self }
    }

    /// The same with another number of tiles that are few.
    #[must_use]
    pub fn few_tiles(self, few_tiles: impl Into<Option<u32>>) -> Self {
        Self { few_tiles: few_tiles.into(), ..self }
    }

    /// The same with another number of lanes.
    #[must_use]
    pub fn lanes(self, lanes: impl Into<Option<u32>>) -> Self {
        Self { lanes: lanes.into(), ..self }
    }

    /// The same with another end of what is seen.
    #[must_use]
    pub fn closed_below(self, closed_below: f32) -> Self {
        Self { closed_below, ..self }
    }
}

impl TilesDesc {
    /// Whether a renderer for another description can take this one.
    pub(crate) fn check_same_renderer(&self, other: &Self) -> Result<()> {
        let differs = [
            ("another limit of memory", self.max_reference_bytes != other.max_reference_bytes),
            ("another number of places in a pixel", self.places != other.places),
            ("another number of lanes", self.lanes != other.lanes),
        ];
        match differs.into_iter().find(|(_, differs)| *differs) {
            Some((what, _)) => Err(Error::rule("hair.render.tiles", format!("{what} needs a new renderer"))),
            None => Ok(()),
        }
    }
}

impl Default for TilesDesc {
    /// Room for 33.5 million references, as much as WebGPU gives a binding; a pixel is closed when less than 1/1024 passes.
    fn default() -> Self {
        let (max_reference_bytes, closed_below) = (Self::MAX_REFERENCE_BYTES, 1.0 / 1024.0);
        Self { max_reference_bytes, closed_below, skips_hidden: None, places: 1, few_tiles: None, lanes: None }
    }
}

impl From<TilesDesc> for crate::Technique {
    fn from(desc: TilesDesc) -> Self {
        Self::Tiles(desc)
    }
}

/// Tiles at work.
#[derive(Debug)]
pub(crate) struct Tiles {
    desc: TilesDesc,
    output: Output,
    kernels: Kernels,
    composite: Composite,
    memory: Memory,
    /// References, tiles and vertices.
    usage: Usage<3>,
    /// Measurements in a row that needed fewer rounds than there are.
    fitting: u32,
    /// Whether hair was so dense that what it hides is left out.
    is_dense: bool,
    is_cpu: bool,
    /// Vertices that the sections of the newest frame have.
    most_vertices: u64,
    /// Its number, which begins anew behind the greatest.
    frame: u32,
}

/// References of a pixel with hair, in the mean of a view, from which on hair is dense.
const DENSE: f64 = 30.0;

/// Measurements in a row that need fewer rounds than there are, before there are as few.
const FITTING: u32 = 30;

/// Below so many hair is dense no more, though nothing is referred to that is hidden.
const LOOSE: f64 = 3.0;

impl Tiles {
    pub(crate) fn new(
        backend: &mut dyn Backend,
        desc: &TilesDesc,
        size: [u32; 2],
        output: impl Into<Output>,
    ) -> Result<Self> {
        let output = output.into();
        check(backend, size, output)?;
        check_places("hair.render.tiles", desc.places)?;
        Ok(Self {
            desc: *desc,
            output,
            kernels: Kernels::new(backend, output, desc)?,
            composite: Composite::new(backend, output)?,
            memory: Memory::new(backend, size, desc, output)?,
            usage: Usage::new(),
            fitting: 0,
            is_dense: false,
            is_cpu: backend.caps().is_cpu,
            most_vertices: 0,
            frame: 0,
        })
    }

    /// Makes room for so many references and tiles and some more, and for so many vertices.
    pub(crate) fn reserve(&mut self, backend: &mut dyn Backend, wanted: Wanted) -> Result<()> {
        self.usage.expect([wanted.kept, wanted.tiles, wanted.vertices]);
        let roomy = Wanted { kept: with_headroom(wanted.kept), tiles: with_headroom(wanted.tiles), ..wanted };
        let grown = self.memory.grow(backend, roomy);
        self.forget_bindings();
        grown
    }

    /// Gives back all that was reserved.
    pub(crate) fn release(&mut self, backend: &mut dyn Backend) -> Result<()> {
        self.usage = Usage::new();
        let released = self.memory.shrink(backend, Wanted::default());
        self.forget_bindings();
        released
    }

    /// Memory for views of another size, with room for nothing yet.
    pub(crate) fn memory(
        backend: &mut dyn Backend,
        desc: &TilesDesc,
        size: [u32; 2],
        output: Output,
    ) -> Result<Memory> {
        check(backend, size, output)?;
        Memory::new(backend, size, desc, output)
    }

    /// Uses other memory.
    pub(crate) fn replace_memory(&mut self, backend: &mut dyn Backend, memory: Memory) {
        std::mem::replace(&mut self.memory, memory).destroy(backend);
        self.forget_bindings();
    }

    fn forget_bindings(&mut self) {
        self.kernels.forget_bindings();
        self.composite.bound.clear();
    }

    /// References, tiles and vertices that there is room for.
    fn room(&self) -> [u64; 3] {
        [self.capacity(), self.memory.screen.resolved.slots, self.memory.vertices.count].map(u64::from)
    }

    /// Of which of them the next frame may need more than there is room for: of no more than there can be.
    fn tight(&self, needed: [u64; 3]) -> [bool; 3] {
        let most = [u64::MAX, self.memory.most_slots(), self.most_vertices];
        let room = self.room();
        [0, 1, 2].map(|i| is_tight(room[i], needed[i]) && room[i] < most[i].max(needed[i]))
    }

    fn few_tiles(&self) -> u32 {
        self.desc.few_tiles.unwrap_or(if self.is_cpu { 0 } else { TilesDesc::FEW_TILES })
    }

    fn skips_hidden(&self) -> bool {
        self.desc.skips_hidden.unwrap_or(self.is_dense)
    }

    /// Looks at how dense hair is. Where it has become dense, what is needed from now on is not what was.
    fn note_density(&mut self, counters: &Counters) {
        let density = f64::from(counters.wanted) / f64::from(counters.pixels_with_hair.max(1));
        self.kernels.choose(density);
        if self.desc.skips_hidden.is_some() {
            return;
        }
        // To look for what is hidden in few tiles takes longer than to draw it.
        let (tiles, few) = (counters.tiles_with_hair, self.few_tiles());
        if !self.is_dense && density > DENSE && tiles > few {
            (self.is_dense, self.usage) = (true, Usage::settling());
        }
        self.is_dense &= density > LOOSE && tiles > few / 2;
    }

    /// Binds all references and blends all tiles that wait, in rounds.
    fn rounds(&mut self, list: &mut PassList, view: &BoundView, scene: TextureId) -> Result<()> {
        let (kernels, memory) = (&mut self.kernels, &self.memory);
        for round in 0..memory.references.rounds {
            kernels.bin(list, view, memory, Some(round), memory.store_groups(round))?;
            kernels.blend(list, view, memory, scene, round)?;
        }
        Ok(())
    }

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 6] {
        self.kernels.shaders()
    }
}

impl TechniqueInstance for Tiles {
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        check(backend, size, self.output)?;
        self.memory.resize(backend, size)?;
        self.forget_bindings();
        Ok(())
    }

    /// No more than there is room for in one round: only what was measured asks for more rounds.
    fn make_room(&mut self, backend: &mut dyn Backend, view: &View, draws: &[SectionDraw]) -> Result<()> {
        let references = predict::references(view, draws).min(self.memory.largest_round());
        let (tiles, vertices) = (predict::tiles(view, draws), layout::vertices(draws));
        self.reserve(backend, Wanted { kept: references as u64, tiles, vertices })
    }

    fn measured(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<bool> {
        let before = self.room();
        let needed = [counters.wanted, counters.tiles_with_hair, counters.vertices].map(u64::from);
        let [kept, tiles, vertices] = needed;
        let tight = self.tight(needed);
        if tight.contains(&true) {
            let more = if tight[2] { with_headroom(vertices) } else { 0 };
            let vertices = more.min(self.most_vertices.max(vertices));
            self.reserve(backend, Wanted { kept, tiles, vertices })?;
        }
        self.note_density(counters);
        let settled = self.usage.measured(needed);
        if self.room() != before {
            self.fitting = 0;
            return Ok(true);
        }
        self.fitting = if self.memory.has_rounds_to_spare(kept) { self.fitting + 1 } else { 0 };
        if self.fitting >= FITTING {
            self.memory.spare_rounds(kept);
            self.fitting = 0;
        }
        if let Some([kept, tiles, vertices]) = settled {
            self.memory.shrink(backend, Wanted { kept, tiles, vertices })?;
            self.forget_bindings();
        }
        Ok(false)
    }

    fn retune(&mut self, _: &mut dyn Backend, technique: &Technique) -> Result<()> {
        let Technique::Tiles(desc) = technique else { return Err(another_technique("hair.render.tiles")) };
        desc.check_same_renderer(&self.desc)?;
        self.desc = *desc;
        Ok(())
    }

    fn uses_tiles(&self) -> bool {
        true
    }

    fn capacity(&self) -> u32 {
        self.memory.references.covered()
    }

    fn bytes(&self) -> u64 {
        self.memory.bytes()
    }

    fn counters(&self, view: usize) -> (BufferId, u64) {
        (self.memory.counters.of(view), 0)
    }

    fn check(&self, draws: &[SectionDraw]) -> Result<()> {
        layout::check(draws)
    }

    fn begin(&mut self, list: &mut PassList, views: usize, draws: &[SectionDraw]) {
        self.most_vertices = layout::vertices(draws);
        self.frame = self.frame.wrapping_add(1);
        self.usage.begin_frame();
        self.kernels.begin_frame();
        self.composite.bound.begin_frame();
        self.memory.begin(list, views);
    }

    fn hairy(&self) -> &Resolved {
        &self.memory.screen.resolved
    }

    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()> {
        let skips_hidden = self.skips_hidden();
        let uniforms = layout::uniforms(view.view, draws, self, skips_hidden);
        self.memory.uniforms.upload(list, view.index * memory::UNIFORMS_OF_A_VIEW, &uniforms);
        self.memory.clear(list, view.size);
        self.kernels.depth(list, view, &self.memory, targets.depth)?;
        for draw in draws {
            self.kernels.points(list, view, draw, &self.memory)?;
        }
        self.kernels.bin(list, view, &self.memory, None, Groups::Grid(self.memory.bin_grid(draws)))?;
        self.kernels.alloc(list, view, &self.memory, Groups::Grid(alloc_grid(view.size)))?;
        self.rounds(list, view, targets.depth)?;
        if skips_hidden {
            self.memory.clear_again(list, view.size);
            self.kernels.reopen(list, view, &self.memory)?;
            let [bin, alloc] = self.memory.groups_again();
            self.kernels.bin(list, view, &self.memory, None, bin)?;
            self.kernels.alloc(list, view, &self.memory, alloc)?;
            self.rounds(list, view, targets.depth)?;
        }
        self.composite.pass(list, view, &self.memory.screen.resolved, targets)
    }
}

/// Whether a device can draw hair on a screen of this size.
fn check(backend: &dyn Backend, size: [u32; 2], output: Output) -> Result<()> {
    let needs = [
        Need::StorageBuffers(8),
        Need::TextureEdge(size[0].max(size[1])),
        Need::StorageBindingBytes(memory::largest_binding(size, output)),
    ];
    backend.caps().check("hair.render", &needs)?;
    check_pixels(size)
}
