//! What a renderer asks of the technique that puts fragments in order.

use std::fmt::Debug;

use tressfx_core::backend::{Backend, Format};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::ppll::{Ppll, PpllDesc};
use crate::renderer::Targets;
use crate::strands::SectionDraw;
use crate::views::BoundView;

/// How hair in front of hair gets its order.
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

/// A technique at work: what becomes of shaded strands in front of a view.
///
/// The renderer has uploaded views and sections, and shades the strands for a view before it calls `draw`. It owns what is made.
pub(crate) trait Order: Debug + Send + Sync {
    /// Makes what is as large as the screen anew.
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()>;

    /// Makes room for so many fragments.
    fn reserve(&mut self, backend: &mut dyn Backend, fragments: u64) -> Result<()>;

    /// Fragments that there is room for.
    fn capacity(&self) -> u32;

    /// The buffer with the [`Counters`](crate::Counters) of each view, and where those of a view are.
    fn counters(&self, view: usize) -> (BufferId, u64);

    /// Begins a frame of so many views: uploads what is the same for all of them.
    fn begin(&mut self, list: &mut PassList, views: usize, draws: &[SectionDraw]);

    /// Writes the passes of a view.
    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()>;
}

impl Technique {
    pub(crate) fn make(&self, backend: &mut dyn Backend, size: [u32; 2], target: Format) -> Result<Box<dyn Order>> {
        match self {
            Self::Ppll(desc) => Ok(Box::new(Ppll::new(backend, desc, size, target)?)),
        }
    }
}
