//! Techniques: how fragments are sorted and blended. The interface between the renderer and a technique.

use std::fmt::Debug;

use tressfx_core::backend::{Backend, Format};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::ppll::{Ppll, PpllDesc};
use crate::renderer::Targets;
use crate::strands::SectionDraw;
use crate::views::BoundView;

/// How fragments of hair behind each other are sorted and blended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Technique {
    /// A list of fragments for each pixel, of which the nearest are sorted.
    Ppll(PpllDesc),
}

impl Default for Technique {
    fn default() -> Self {
        Self::Ppll(PpllDesc::default())
    }
}

/// An instance of a technique: it turns shaded strands into pixels of a view.
///
/// The renderer has uploaded views and sections, and shades the strands for a view before it calls `draw`. It owns what is made.
pub(crate) trait TechniqueInstance: Debug + Send + Sync {
    /// Makes the buffers whose size depends on that of the view again.
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()>;

    /// Enlarges the pool to at least this many fragments, up to its limit.
    fn reserve(&mut self, backend: &mut dyn Backend, fragments: u64) -> Result<()>;

    /// How many fragments the pool can hold.
    fn capacity(&self) -> u32;

    /// The buffer with the [`Counters`](crate::Counters) of each view, and where those of a view are.
    fn counters(&self, view: usize) -> (BufferId, u64);

    /// Begins a frame with this many views: uploads what is the same for all of them.
    fn begin(&mut self, list: &mut PassList, views: usize, draws: &[SectionDraw]);

    /// Writes the passes of a view.
    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()>;
}

impl Technique {
    pub(crate) fn make(
        &self,
        backend: &mut dyn Backend,
        size: [u32; 2],
        target: Format,
    ) -> Result<Box<dyn TechniqueInstance>> {
        match self {
            Self::Ppll(desc) => Ok(Box::new(Ppll::new(backend, desc, size, target)?)),
        }
    }
}
