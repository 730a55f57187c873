//! ShortCut, after TressFX 3 and 4: the depths of the nearest fragments of each pixel first, then their colours. It needs the
//! same memory for each pixel, however much hair there is.
//!
//! What differs from the original: sums are of integers, so that a picture does not depend on the order of atomics. The second
//! pass reads the depth of the last layer from the layers; the original writes it to the depth buffer of the scene for the
//! early test of the hardware, and later passes see hair there. Colours are cleared to zero and no sum is divided by zero.
//! Faint fragments add to the opacity too, and come last for a layer.

mod colors;
mod depths;
mod memory;
mod resolve;

use std::ops::RangeInclusive;

use tressfx_core::backend::Backend;
use tressfx_core::error::{Need, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Specialization;
use tressfx_core::view::View;

use crate::composite::Composite;
use crate::counters::Counters;
use crate::occlusion::Occlusion;
use crate::output::Output;
use crate::predict;
use crate::renderer::Targets;
use crate::resolved::{Resolved, check_pixels, pixels, tile_count};
use crate::segments::{Fill, Segments};
use crate::strands::SectionDraw;
use crate::technique::{Technique, TechniqueInstance, another_technique, check_k};
use crate::views::BoundView;
use memory::Memory;

/// Layers of nearest fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ShortCutDesc {
    /// How many of the nearest fragments of a pixel give it its colour; the others add to its opacity alone. In
    /// [`ShortCutDesc::K_RANGE`].
    pub k: u32,
    /// Whether the nearest fragments are blended in order. Else the colour is their mean, weighted by alpha.
    pub ordered: bool,
    /// What turns segments of strands into fragments.
    pub fill: Fill,
    /// Whether hair is left out that is behind hair which lets less than a thousandth through: dense hair is faster, for more memory.
    pub skips_hidden: bool,
}

impl ShortCutDesc {
    /// Fragments of a pixel that may give it its colour.
    pub const K_RANGE: RangeInclusive<u32> = 1..=8;

    /// The same with `k` layers.
    #[must_use]
    pub fn k(self, k: u32) -> Self {
        Self { k, ..self }
    }

    /// The same with fragments in order, or their mean.
    #[must_use]
    pub fn ordered(self, ordered: bool) -> Self {
        Self { ordered, ..self }
    }

    /// The same with fragments from another kind of pass.
    #[must_use]
    pub fn fill(self, fill: Fill) -> Self {
        Self { fill, ..self }
    }

    /// The same, with or without hair that other hair hides.
    #[must_use]
    pub fn skips_hidden(self, skips_hidden: bool) -> Self {
        Self { skips_hidden, ..self }
    }

    fn specialization(&self, output: Output) -> Specialization {
        output.specialization().feature("ordered", self.ordered).constant("K", self.k)
    }
}

impl Default for ShortCutDesc {
    /// The mean of three layers.
    fn default() -> Self {
        Self { k: 3, ordered: false, fill: Fill::Compute, skips_hidden: false }
    }
}

impl From<ShortCutDesc> for crate::Technique {
    fn from(desc: ShortCutDesc) -> Self {
        Self::ShortCut(desc)
    }
}

/// Layers at work.
#[derive(Debug)]
pub(crate) struct ShortCut {
    desc: ShortCutDesc,
    output: Output,
    depths: Segments,
    colors: Segments,
    resolve: resolve::Resolve,
    occlusion: Occlusion,
    composite: Composite,
    memory: Memory,
}

impl ShortCut {
    pub(crate) fn new(
        backend: &mut dyn Backend,
        desc: &ShortCutDesc,
        size: [u32; 2],
        output: impl Into<Output>,
    ) -> Result<Self> {
        let output = output.into();
        check_k("hair.render.shortcut", desc.k, &ShortCutDesc::K_RANGE)?;
        check(backend, desc, size, output)?;
        let k = output.walk().constant("K", desc.k);
        let own = desc.specialization(output);
        let depths = Segments::new(backend, desc.fill, depths::SHADERS, &k, output.color)?;
        let colors = Segments::new(backend, desc.fill, colors::SHADERS, &own, output.color)?;
        Ok(Self {
            desc: *desc,
            output,
            depths: depths.with_lists(backend, desc.skips_hidden)?,
            colors: colors.with_lists(backend, desc.skips_hidden)?,
            resolve: resolve::Resolve::new(backend, desc, output)?,
            occlusion: Occlusion::new(backend, Some(desc.skips_hidden), desc.fill, size, output)?,
            composite: Composite::new(backend, output)?,
            memory: Memory::new(backend, size, desc, output)?,
        })
    }

    /// Makes what it takes to look for hidden hair, where that is wanted and the device can.
    fn prepare_occlusion(&mut self, backend: &mut dyn Backend) -> Result<()> {
        if let Some(prepared) = self.occlusion.prepare(backend)? {
            self.occlusion.turn_on(backend, prepared);
            self.depths.forget_bindings();
            self.colors.forget_bindings();
        }
        Ok(())
    }

    #[cfg(test)]
    pub(crate) fn shaders(&self) -> [&tressfx_core::shader::Shader; 4] {
        let Self { depths, colors, resolve, composite, .. } = self;
        [depths.shader(), colors.shader(), &resolve.kernel.shader, composite.shader()]
    }
}

impl TechniqueInstance for ShortCut {
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        check(backend, &self.desc, size, self.output)?;
        let memory = Memory::new(backend, size, &self.desc, self.output)?;
        std::mem::replace(&mut self.memory, memory).destroy(backend);
        self.occlusion.resize(backend, size);
        self.depths.forget_bindings();
        self.colors.forget_bindings();
        self.resolve.bound.clear();
        self.composite.bound.clear();
        Ok(())
    }

    /// There is no pool.
    fn make_room(&mut self, backend: &mut dyn Backend, view: &View, draws: &[SectionDraw]) -> Result<()> {
        self.occlusion.expect(view, draws, predict::fragments(view, draws));
        self.prepare_occlusion(backend)
    }

    fn measured(&mut self, backend: &mut dyn Backend, _: &Counters) -> Result<bool> {
        self.occlusion.release_unused(backend);
        self.prepare_occlusion(backend)?;
        Ok(false)
    }

    fn retune(&mut self, _: &mut dyn Backend, technique: &Technique) -> Result<()> {
        if *technique == self.desc.into() { Ok(()) } else { Err(another_technique("hair.render.shortcut")) }
    }

    fn capacity(&self) -> u32 {
        u32::MAX
    }

    fn bytes(&self) -> u64 {
        self.memory.bytes + self.occlusion.bytes()
    }

    fn counters(&self, view: usize) -> (BufferId, u64) {
        (self.memory.counters.of(view), 0)
    }

    fn begin(&mut self, list: &mut PassList, views: usize, _: &[SectionDraw]) {
        self.occlusion.begin_frame();
        self.depths.begin_frame();
        self.colors.begin_frame();
        self.resolve.bound.begin_frame();
        self.composite.bound.begin_frame();
        self.memory.counters.clear(list, views);
    }

    fn hairy(&self) -> &Resolved {
        &self.memory.resolved
    }

    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()> {
        self.memory.clear(list, &view.region, &self.desc);
        let occluded = self.occlusion.passes(list, view, draws, targets)?;
        let occluded = occluded.as_ref();
        self.depths.passes(list, view, draws, targets, &self.memory.of_depths(view), occluded)?;
        self.colors.passes(list, view, draws, targets, &self.memory.of_colors(&self.desc), occluded)?;
        self.resolve.pass(list, view, &self.memory)?;
        self.composite.pass(list, view, &self.memory.resolved, targets)
    }
}

/// Whether a device can draw hair on a screen of this size.
fn check(backend: &dyn Backend, desc: &ShortCutDesc, size: [u32; 2], output: Output) -> Result<()> {
    let largest = memory::bytes_of_pixel(desc).into_iter().max().unwrap_or(0) * pixels(size);
    let largest = largest.max(output.slot_bytes() * u64::from(tile_count(size)));
    let needs = [Need::StorageBuffers(7), Need::TextureEdge(size[0].max(size[1])), Need::StorageBindingBytes(largest)];
    backend.caps().check("hair.render", &needs)?;
    check_pixels(size)
}
