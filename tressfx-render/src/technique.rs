//! Techniques: how fragments are sorted and blended. The interface between the renderer and a technique.

use std::fmt::Debug;
use std::ops::RangeInclusive;

use tressfx_core::backend::Backend;
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::view::View;

use crate::auto::{Auto, AutoDesc};
use crate::counters::Counters;
use crate::output::Output;
use crate::ppll::{Ppll, PpllDesc};
use crate::renderer::Targets;
use crate::resolved::Resolved;
use crate::shortcut::{ShortCut, ShortCutDesc};
use crate::strands::SectionDraw;
use crate::tiles::{Tiles, TilesDesc};
use crate::views::BoundView;

/// How fragments of hair behind each other are sorted and blended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Technique {
    /// A list of fragments for each pixel, of which the nearest are sorted.
    Ppll(PpllDesc),
    /// Layers of the nearest fragments of each pixel, in the same memory however much hair there is.
    ShortCut(ShortCutDesc),
    /// All fragments of each pixel in order, in tiles, until nothing more is seen.
    Tiles(TilesDesc),
    /// Lists or tiles, by what was measured in the frames before.
    Auto(AutoDesc),
}

impl Default for Technique {
    fn default() -> Self {
        Self::Ppll(PpllDesc::default())
    }
}

/// What a frame needs room for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wanted {
    /// Fragments, or references to segments.
    pub(crate) kept: u64,
    /// Tiles with hair, where only they have room for their pixels.
    pub(crate) tiles: u64,
    /// Vertices that tiles keep.
    pub(crate) vertices: u64,
}

/// An instance of a technique: it turns shaded strands into pixels of a view.
///
/// The renderer has uploaded views and sections, and shades the strands for a view before it calls `draw`. It owns what is made.
pub(crate) trait TechniqueInstance: Debug + Send + Sync {
    /// Makes the buffers whose size depends on that of the view again.
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()>;

    /// Makes room for what a view of sections is predicted to need and [what the next frame may need more](crate::renderer::with_headroom),
    /// up to the limit of its pool.
    fn make_room(&mut self, backend: &mut dyn Backend, view: &View, draws: &[SectionDraw]) -> Result<()>;

    /// Makes room for what a view has needed. Returns whether there is another room than before.
    fn measured(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<bool>;

    /// Changes what can be changed from frame to frame.
    fn retune(&mut self, backend: &mut dyn Backend, technique: &Technique) -> Result<()>;

    /// Whether tiles draw the next frame.
    fn uses_tiles(&self) -> bool {
        false
    }

    /// How much the pool can hold; all that can be counted where there is none.
    fn capacity(&self) -> u32;

    /// Bytes of the buffers that it has made.
    fn bytes(&self) -> u64;

    /// The buffer with the [`Counters`](crate::Counters) of each view, and where those of a view are.
    fn counters(&self, view: usize) -> (BufferId, u64);

    /// Whether it can draw these sections, before anything is written.
    fn check(&self, _: &[SectionDraw]) -> Result<()> {
        Ok(())
    }

    /// Begins a frame with this many views: uploads what is the same for all of them.
    fn begin(&mut self, list: &mut PassList, views: usize, draws: &[SectionDraw]);

    /// The tiles with hair of the view whose passes were written last.
    fn hairy(&self) -> &Resolved;

    /// Writes the passes of a view.
    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()>;
}

/// What an instance says that is told to be another technique, or to change what it cannot.
pub(crate) fn another_technique(label: Label) -> Error {
    Error::rule(label, "another technique needs a new renderer".to_owned())
}

/// Whether a technique takes `k` fragments of a pixel.
pub(crate) fn check_k(label: Label, k: u32, range: &RangeInclusive<u32>) -> Result<()> {
    if range.contains(&k) {
        return Ok(());
    }
    let message = format!("k is {k}, it must be from {} to {}", range.start(), range.end());
    Err(Error::rule(label, message))
}

impl Technique {
    pub(crate) fn make(
        &self,
        backend: &mut dyn Backend,
        size: [u32; 2],
        output: Output,
    ) -> Result<Box<dyn TechniqueInstance>> {
        match self {
            Self::Ppll(desc) => Ok(Box::new(Ppll::new(backend, desc, size, output)?)),
            Self::Tiles(desc) => Ok(Box::new(Tiles::new(backend, desc, size, output)?)),
            Self::Auto(desc) => Ok(Box::new(Auto::new(backend, desc, size, output)?)),
            Self::ShortCut(desc) => Ok(Box::new(ShortCut::new(backend, desc, size, output)?)),
        }
    }
}
