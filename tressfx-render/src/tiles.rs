//! Tiles: every fragment of a pixel in its exact order, from front to back until nothing more is seen.
//!
//! The screen is divided into tiles of 8 x 8 pixels, and depth into slices. Segments are referred to from the bins, a slice of a
//! tile, that they touch. A group of lanes then makes the fragments of a tile, slice after slice, sorts them in its own memory and
//! blends them. So fragments are never stored, those that nobody sees are never made, and the memory is that of the references.
//! Unity's high quality lines and Frostbite's hair go through tiles in the same way; they sort segments, not fragments.

mod kernels;
mod layout;
mod memory;

use tressfx_core::backend::{Backend, Format};
use tressfx_core::error::{Error, Need, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::view::View;

use crate::composite::Composite;
use crate::counters::Counters;
use crate::predict;
use crate::renderer::{Targets, with_headroom};
use crate::resolved::check_pixels;
use crate::strands::SectionDraw;
use crate::technique::{Technique, TechniqueInstance, another_technique};
use crate::usage::Usage;
use crate::views::BoundView;
use kernels::Kernels;
use layout::Layout;
use memory::Memory;

#[cfg(test)]
pub(crate) use layout::TilesUniform;
pub(crate) use layout::vertices;

/// Exact order in tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TilesDesc {
    /// Memory that the references to segments may take, 4 bytes each; at most [`TilesDesc::MAX_REFERENCE_BYTES`]. The device's
    /// own limit for one binding holds too. Where a picture needs more, its tiles are drawn in rounds.
    pub max_reference_bytes: u64,
    /// Transmittance of a pixel below which nothing more is blended into it.
    pub closed_below: f32,
}

impl TilesDesc {
    /// The largest [`TilesDesc::max_reference_bytes`].
    pub const MAX_REFERENCE_BYTES: u64 = 64 << 20;

    /// The same with room for at most so many bytes of references.
    #[must_use]
    pub fn max_reference_bytes(self, max_reference_bytes: u64) -> Self {
        Self { max_reference_bytes, ..self }
    }

    /// The same with another end of what is seen.
    #[must_use]
    pub fn closed_below(self, closed_below: f32) -> Self {
        Self { closed_below, ..self }
    }
}

impl Default for TilesDesc {
    /// Room for 16.7 million references; a pixel is closed when less than 1/1024 passes.
    fn default() -> Self {
        Self { max_reference_bytes: Self::MAX_REFERENCE_BYTES, closed_below: 1.0 / 1024.0 }
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
    kernels: Kernels,
    composite: Composite,
    memory: Memory,
    /// References and vertices.
    usage: Usage<2>,
}

impl Tiles {
    pub(crate) fn new(backend: &mut dyn Backend, desc: &TilesDesc, size: [u32; 2], target: Format) -> Result<Self> {
        check(backend, size)?;
        Ok(Self {
            desc: *desc,
            kernels: Kernels::new(backend)?,
            composite: Composite::new(backend, target)?,
            memory: Memory::new(backend, size, desc)?,
            usage: Usage::new(),
        })
    }

    /// Makes room for so many references and some more, and for vertices.
    pub(crate) fn reserve_counts(&mut self, backend: &mut dyn Backend, references: u64, vertices: u64) -> Result<()> {
        self.usage.expect([references, vertices]);
        let grown = self.memory.grow(backend, with_headroom(references), vertices);
        self.forget_bindings();
        grown
    }

    /// Gives back all that was reserved.
    pub(crate) fn release(&mut self, backend: &mut dyn Backend) -> Result<()> {
        self.usage = Usage::new();
        let released = self.memory.shrink(backend, 0, 0);
        self.forget_bindings();
        released
    }

    /// Memory for views of another size, with room for nothing yet.
    pub(crate) fn memory(backend: &mut dyn Backend, desc: &TilesDesc, size: [u32; 2]) -> Result<Memory> {
        check(backend, size)?;
        Memory::new(backend, size, desc)
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

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 5] {
        self.kernels.shaders()
    }
}

impl TechniqueInstance for Tiles {
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        check(backend, size)?;
        self.memory.resize(backend, size)?;
        self.forget_bindings();
        Ok(())
    }

    /// No more than there is room for in one round: only what was measured asks for more rounds.
    fn predicted(&self, view: &View, draws: &[SectionDraw]) -> f64 {
        predict::references(view, draws).min(self.memory.largest_round())
    }

    fn reserve(&mut self, backend: &mut dyn Backend, references: u64, draws: &[SectionDraw]) -> Result<()> {
        self.reserve_counts(backend, references, layout::vertices(draws))
    }

    fn measured(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<bool> {
        let before = self.capacity();
        if counters.wanted > before {
            self.reserve(backend, counters.wanted.into(), &[])?;
        }
        let settled = self.usage.measured([counters.wanted.into(), 0]);
        if self.capacity() > before {
            return Ok(true);
        }
        if let Some([references, vertices]) = settled {
            self.memory.shrink(backend, references, vertices)?;
            self.forget_bindings();
        }
        Ok(false)
    }

    fn retune(&mut self, _: &mut dyn Backend, technique: &Technique) -> Result<()> {
        let Technique::Tiles(desc) = technique else { return Err(another_technique("hair.render.tiles")) };
        if desc.max_reference_bytes != self.desc.max_reference_bytes {
            return Err(Error::rule("hair.render.tiles", "another limit of memory needs a new renderer".to_owned()));
        }
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
        let (wanted, room) = (Layout::new(draws)?.vertices, self.memory.vertices.count);
        if wanted > room {
            let message = format!("{wanted} vertices, there is room for {room}: `grow_to_predicted` makes room");
            return Err(Error::rule("hair.render.tiles", message));
        }
        Ok(())
    }

    fn begin(&mut self, list: &mut PassList, views: usize, draws: &[SectionDraw]) {
        self.usage.begin_frame();
        self.usage.expect([0, layout::vertices(draws)]);
        self.kernels.begin_frame();
        self.composite.bound.begin_frame();
        self.memory.counters.clear(list, views);
    }

    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()> {
        let layout = Layout::new(draws)?;
        let uniforms = layout.uniforms(view.view, draws, &self.desc, &self.memory.references);
        self.memory.uniforms.upload(list, view.index * memory::UNIFORMS_OF_A_VIEW, &uniforms);
        self.memory.clear(list, view.size);
        for (draw, &first) in draws.iter().zip(&layout.first_vertices) {
            self.kernels.points(list, view, draw, &self.memory, first)?;
        }
        self.kernels.depth(list, view, &self.memory, targets.depth)?;
        self.kernels.bin(list, view, &self.memory, layout.segments, None)?;
        self.kernels.alloc(list, view, &self.memory)?;
        for round in 0..self.memory.references.rounds {
            self.kernels.bin(list, view, &self.memory, layout.segments, Some(round))?;
            self.kernels.blend(list, view, &self.memory, targets.depth, round)?;
        }
        self.composite.pass(list, view, &self.memory.screen.resolved, targets.color)
    }
}

/// Whether a device can draw hair on a screen of this size.
fn check(backend: &dyn Backend, size: [u32; 2]) -> Result<()> {
    let needs = [
        Need::StorageBuffers(7),
        Need::TextureEdge(size[0].max(size[1])),
        Need::StorageBindingBytes(memory::largest_binding(size)),
    ];
    backend.caps().check("hair.render", &needs)?;
    check_pixels(size)
}
