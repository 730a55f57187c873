//! The technique by what was measured: lists while there is room for all fragments and hair is not dense, tiles where it is.
//!
//! Lists are the faster ones where a pixel has few fragments, and blend what lies behind the nearest ones as a mean; tiles keep the exact order
//! in memory that does not grow with the density of hair. On a CPU tiles take several times as long, so that it stays with lists, which
//! are bounded where there is no room for all. It begins with lists, and after a new size again, unless it is sure that hair is dense.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::view::View;

use crate::counters::Counters;
use crate::output::Output;
use crate::places::check_places;
use crate::ppll::{Ppll, PpllDesc};
use crate::predict;
use crate::renderer::Targets;
use crate::resolved::{Resolved, TILE};
use crate::strands::SectionDraw;
use crate::technique::{Technique, TechniqueInstance, Wanted, another_technique};
use crate::tiles::{self, MAX_VERTICES, Tiles, TilesDesc, Vertices};
use crate::views::BoundView;

/// Measurements in a row that must speak for the other technique before it takes over.
const VOTES: u32 = 30;

/// Frames after the technique has changed for which counters are not looked at: they may still be those of the other one.
const LATENCY: u64 = 8;

/// Frames after which is predicted again what the other technique would need.
const FRAMES: u64 = 16;

/// Lists come back where hair has less than this share of what tiles take over at.
const BACK: f64 = 0.7;

/// Times as many fragments as lists hold that are predicted where there is no doubt: a body hides up to two thirds of them.
const NO_DOUBT: f64 = 3.0;

/// Lists or tiles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AutoDesc {
    /// The lists.
    pub lists: PpllDesc,
    /// The tiles. With as many places in a pixel as lists have the picture stays what it is where one takes over from the other.
    pub tiles: TilesDesc,
    /// Fragments a pixel with hair, in the mean of a view, from which on hair is drawn in tiles. They also draw it where there are more
    /// fragments than lists hold unbounded.
    pub dense: f32,
    /// Whether tiles may take over on a device that computes on the CPU too.
    pub tiles_on_cpu: bool,
}

impl AutoDesc {
    /// The same with other lists.
    #[must_use]
    pub fn lists(self, lists: PpllDesc) -> Self {
        Self { lists, ..self }
    }

    /// The same with other tiles.
    #[must_use]
    pub fn tiles(self, tiles: TilesDesc) -> Self {
        Self { tiles, ..self }
    }

    /// The same with tiles from another density on.
    #[must_use]
    pub fn dense(self, dense: f32) -> Self {
        Self { dense, ..self }
    }

    /// The same with or without tiles on a CPU.
    #[must_use]
    pub fn tiles_on_cpu(self, tiles_on_cpu: bool) -> Self {
        Self { tiles_on_cpu, ..self }
    }
}

impl Default for AutoDesc {
    /// Tiles from 20 fragments a pixel on, where they have become as fast as lists on a GPU (H200), and not on a CPU.
    fn default() -> Self {
        Self { lists: PpllDesc::default(), tiles: TilesDesc::default(), dense: 20.0, tiles_on_cpu: false }
    }
}

impl From<AutoDesc> for Technique {
    fn from(desc: AutoDesc) -> Self {
        Self::Auto(desc)
    }
}

/// What a frame is predicted to need, by either technique.
#[derive(Clone, Copy, Debug, Default)]
struct Predicted {
    fragments: f64,
    references: f64,
    tiles: u64,
    vertices: u64,
}

impl Predicted {
    /// What no view changes.
    fn new(draws: &[SectionDraw]) -> Self {
        Self { vertices: tiles::vertices(draws), ..Self::default() }
    }

    /// The larger of it and of what a view needs.
    fn with(self, view: &View, draws: &[SectionDraw]) -> Self {
        self.and(Self {
            fragments: predict::fragments(view, draws),
            references: predict::references(view, draws),
            tiles: predict::tiles(view, draws),
            vertices: 0,
        })
    }

    /// The larger of both.
    fn and(self, other: Self) -> Self {
        Self {
            fragments: self.fragments.max(other.fragments),
            references: self.references.max(other.references),
            tiles: self.tiles.max(other.tiles),
            vertices: self.vertices.max(other.vertices),
        }
    }
}

/// Lists and tiles at work.
#[derive(Debug)]
pub(crate) struct Auto {
    desc: AutoDesc,
    size: [u32; 2],
    output: Output,
    lists: Ppll,
    /// Made when they first take over, and kept.
    tiles: Option<Tiles>,
    uses_tiles: bool,
    votes: u32,
    frame: u64,
    /// Counters count from this frame on.
    settled_at: u64,
    /// Whether the technique that is not in use still has its memory.
    has_surplus: bool,
    /// Vertices that tiles can draw on the device.
    most_vertices: u64,
    /// Whether tiles could draw the newest frame.
    tiles_can_draw: bool,
    /// The largest of the views.
    predicted: Predicted,
    /// The same of those for which there is to be room in the next frame.
    asked: Predicted,
    /// Fragments that lists have measured, of those that were predicted: a body hides the others.
    seen: f64,
}

impl Auto {
    pub(crate) fn new(backend: &mut dyn Backend, desc: &AutoDesc, size: [u32; 2], output: Output) -> Result<Self> {
        let caps = backend.caps();
        let bytes = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes);
        check_places("hair.render.auto", desc.tiles.places)?;
        Ok(Self {
            desc: *desc,
            size,
            output,
            most_vertices: MAX_VERTICES.min(bytes / Vertices::POINT_BYTES),
            tiles_can_draw: false,
            lists: Ppll::new(backend, &desc.lists, size, output)?,
            tiles: None,
            uses_tiles: false,
            votes: 0,
            frame: 0,
            settled_at: 0,
            has_surplus: false,
            predicted: Predicted::default(),
            asked: Predicted::default(),
            seen: 1.0,
        })
    }

    fn active(&self) -> &dyn TechniqueInstance {
        match &self.tiles {
            Some(tiles) if self.uses_tiles => tiles,
            _ => &self.lists,
        }
    }

    fn active_mut(&mut self) -> &mut dyn TechniqueInstance {
        match &mut self.tiles {
            Some(tiles) if self.uses_tiles => tiles,
            _ => &mut self.lists,
        }
    }

    fn may_use_tiles(&self, backend: &dyn Backend) -> bool {
        self.tiles_can_draw && (self.desc.tiles_on_cpu || !backend.caps().is_cpu)
    }

    /// Whether a measurement speaks for the technique that is not in use.
    fn speaks_for_other(&mut self, backend: &dyn Backend, counters: &Counters) -> bool {
        if !self.uses_tiles && !self.may_use_tiles(backend) {
            return false;
        }
        if !self.uses_tiles && self.predicted.fragments > 0.0 {
            self.seen = (f64::from(counters.fragments) / self.predicted.fragments).min(1.0);
        }
        // Tiles do not make what nobody sees: then it is known from the prediction alone how many fragments there are.
        let fragments = if self.uses_tiles { self.predicted.fragments * self.seen } else { counters.fragments.into() };
        let depth = fragments / f64::from(counters.pixels_with_hair.max(1));
        let part = (depth / f64::from(self.desc.dense)).max(fragments / self.lists.most_unbounded());
        if self.uses_tiles { part < BACK } else { part > 1.0 }
    }

    /// Whether a view is for tiles without a measurement: lists would be bounded, or hair would be dense even if it filled all tiles that it may touch. (It
    /// fills about half of them at most, which makes up for what a body hides.)
    fn is_surely_for_tiles(&self, predicted: &Predicted) -> bool {
        let pixels = (u64::from(TILE * TILE) * predicted.tiles) as f64;
        predicted.fragments > NO_DOUBT * self.lists.most_unbounded()
            || predicted.fragments * self.seen > f64::from(self.desc.dense) * pixels
    }

    /// Hands over, with room for what is predicted, so that nothing is dropped.
    fn switch(&mut self, backend: &mut dyn Backend) -> Result<()> {
        let Predicted { fragments, references, tiles, vertices } = self.predicted;
        let wanted = Wanted { kept: references as u64, tiles, vertices };
        if self.uses_tiles {
            self.lists.reserve(backend, fragments as u64)?;
        } else if let Some(tiles) = &mut self.tiles {
            tiles.reserve(backend, wanted)?;
        } else {
            let mut tiles = Tiles::new(backend, &self.desc.tiles, self.size, self.output)?;
            tiles.reserve(backend, wanted)?;
            self.tiles = Some(tiles);
        }
        self.uses_tiles = !self.uses_tiles;
        (self.votes, self.has_surplus, self.settled_at) = (0, true, self.frame + LATENCY);
        Ok(())
    }

    /// Whether tiles can draw as many vertices as these have.
    fn can_tiles_draw(&self, draws: &[SectionDraw]) -> bool {
        tiles::vertices(draws) <= self.most_vertices
    }

    /// Goes back to lists at once where tiles cannot draw what there is.
    fn leave_tiles_for(&mut self, draws: &[SectionDraw]) {
        self.tiles_can_draw = self.can_tiles_draw(draws);
        if self.uses_tiles && !self.tiles_can_draw {
            self.uses_tiles = false;
            (self.votes, self.has_surplus, self.settled_at) = (0, true, self.frame + LATENCY);
        }
    }

    /// Frees what the technique that is not in use has kept for its last frames.
    fn release_other(&mut self, backend: &mut dyn Backend) -> Result<()> {
        match &mut self.tiles {
            Some(tiles) if !self.uses_tiles => tiles.release(backend),
            Some(_) => self.lists.release(backend),
            None => Ok(()),
        }
    }
}

impl TechniqueInstance for Auto {
    fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        let memory =
            self.tiles.as_ref().map(|_| Tiles::memory(backend, &self.desc.tiles, size, self.output)).transpose()?;
        self.lists.resize(backend, size)?;
        if let (Some(tiles), Some(memory)) = (&mut self.tiles, memory) {
            tiles.replace_memory(backend, memory);
        }
        (self.size, self.uses_tiles, self.votes, self.has_surplus) = (size, false, 0, false);
        Ok(())
    }

    /// Tiles take over at once where there is no doubt, with room for all views that were asked for.
    fn make_room(&mut self, backend: &mut dyn Backend, view: &View, draws: &[SectionDraw]) -> Result<()> {
        self.leave_tiles_for(draws);
        if !self.uses_tiles && self.may_use_tiles(backend) {
            let of_view = Predicted::new(draws).with(view, draws);
            self.asked = self.asked.and(of_view);
            if self.is_surely_for_tiles(&of_view) {
                self.predicted = self.asked;
                return self.switch(backend);
            }
        }
        self.active_mut().make_room(backend, view, draws)
    }

    fn measured(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<bool> {
        // Each step is a change of its own: what one has replaced stays if another fails.
        if std::mem::take(&mut self.has_surplus) {
            self.release_other(backend)?;
            return Ok(false);
        }
        if self.frame < self.settled_at {
            return Ok(false);
        }
        self.votes = if self.speaks_for_other(backend, counters) { self.votes + 1 } else { 0 };
        if self.votes >= VOTES && self.predicted.vertices > 0 {
            self.switch(backend)?;
            return Ok(false);
        }
        self.active_mut().measured(backend, counters)
    }

    fn retune(&mut self, backend: &mut dyn Backend, technique: &Technique) -> Result<()> {
        let Technique::Auto(desc) = technique else { return Err(another_technique("hair.render.auto")) };
        desc.tiles.check_same_renderer(&self.desc.tiles)?;
        self.lists.retune(backend, &desc.lists.into())?;
        if let Some(tiles) = &mut self.tiles {
            tiles.retune(backend, &desc.tiles.into())?;
        }
        self.desc = *desc;
        Ok(())
    }

    fn uses_tiles(&self) -> bool {
        self.uses_tiles
    }

    fn capacity(&self) -> u32 {
        self.active().capacity()
    }

    fn bytes(&self) -> u64 {
        self.lists.bytes() + self.tiles.as_ref().map_or(0, |tiles| tiles.bytes())
    }

    fn counters(&self, view: usize) -> (BufferId, u64) {
        self.active().counters(view)
    }

    fn check(&self, draws: &[SectionDraw]) -> Result<()> {
        if self.can_tiles_draw(draws) { self.active().check(draws) } else { self.lists.check(draws) }
    }

    fn begin(&mut self, list: &mut PassList, views: usize, draws: &[SectionDraw]) {
        self.frame += 1;
        self.asked = Predicted::default();
        self.leave_tiles_for(draws);
        if self.frame % FRAMES == 1 {
            self.predicted = Predicted::new(draws);
        }
        self.active_mut().begin(list, views, draws);
    }

    fn hairy(&self) -> &Resolved {
        self.active().hairy()
    }

    fn draw(&mut self, list: &mut PassList, view: &BoundView, targets: &Targets, draws: &[SectionDraw]) -> Result<()> {
        if self.frame % FRAMES == 1 {
            self.predicted = self.predicted.with(view.view, draws);
        }
        self.active_mut().draw(list, view, targets, draws)
    }
}
