//! What hair hides of itself, for techniques that walk over segments: where hair is dense, most fragments lie behind others that let nothing through.
//!
//! From the mass of hair in each tile it is guessed between which depths its pixels become opaque. The segments before the guess are walked once to sum
//! optical depths, so that it is known in each pixel from where on it is opaque. Segments behind that, in all tiles that they may touch, are on no list,
//! and the walks of the technique take what is opaque for the scene. All of it is found anew in each frame.

mod kernels;
mod memory;

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::gpu_struct;
use tressfx_core::id::TextureId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;
use tressfx_core::view::View;

use crate::output::Output;
use crate::predict;
use crate::renderer::Targets;
use crate::resolved::TILE;
use crate::segments::Fill;
use crate::strands::SectionDraw;
use crate::tiles::distances;
use crate::views::BoundView;
use kernels::{Hair, Kernels};
use memory::{Memory, Room};

pub(crate) use memory::Listed;

gpu_struct! {
    /// What the kernels know of the hair.
    pub(crate) struct OcclusionUniform {
        /// Distance at which hair is expected to begin.
        pub nearest: f32,
        /// How much farther it is expected to end.
        pub depth: f32,
        /// Bits of optical depth at which nothing more is seen.
        pub closing: f32,
        /// Of so many strands the mass of one is taken.
        pub stride: u32,
    }
}

/// Transmittance of a pixel below which nothing more is seen, as a power of a half.
const CLOSING: f32 = 10.0;

/// Of so many strands the mass of one is taken.
const STRIDE: u32 = 8;

/// Fragments a pixel, predicted over the tiles that hair may touch, from which on lists are faster where hidden hair is left out (H200, 1920x1080: at 28 they
/// take 1.1 times as long, at 55 0.36).
const DENSE: f64 = 40.0;

/// The same where raster passes make fragments, which takes many times as long on a GPU with few raster units (H200: at 3.5 0.6).
const DENSE_IN_RASTER: f64 = 3.0;

/// Where fewer fragments are predicted hair is never dense: what is done beside the walks takes as long as to draw so many (H200: 0.10 ms at 4,096 strands, whose 2.8
/// million fragments take 0.26).
const LEAST: f64 = 1e6;

/// Frames after which it is predicted again how dense hair is.
const FRAMES: u64 = 16;

/// Hair is dense no more where it has less than this share of what it became dense at, so that no picture flickers between both.
const BACK: f64 = 0.7;

/// Frames after which memory is given back that was not in use.
const UNUSED_FRAMES: u64 = 120;

/// Pixels of the tiles that hair may touch.
fn pixels(view: &View, draws: &[SectionDraw]) -> f64 {
    (u64::from(TILE * TILE) * predict::tiles(view, draws)) as f64
}

/// What was made and is not in use yet: if something else fails, it is forgotten.
#[derive(Debug)]
pub(crate) struct Prepared {
    kernels: Option<Kernels>,
    memory: Memory,
}

/// What finds hidden hair.
#[derive(Debug)]
pub(crate) struct Occlusion {
    /// Whether it always or never does; by how dense hair is otherwise.
    wanted: Option<bool>,
    size: [u32; 2],
    output: Output,
    kernels: Option<Kernels>,
    memory: Option<Memory>,
    /// Of ranges of buffers that are bound.
    alignment: u64,
    /// Fragments a pixel from which on hair is dense.
    dense: f64,
    /// Whether hair was predicted to be so, in a view of the frame in which that was predicted last.
    is_dense: bool,
    frame: u64,
    /// That frame, and the one in which hidden hair was looked for last.
    predicted: u64,
    used: u64,
    /// What the lists of the newest frame's sections take.
    room: Room,
}

impl Occlusion {
    /// Kernels are compiled at once where they will be needed for sure.
    pub(crate) fn new(
        backend: &mut dyn Backend,
        wanted: Option<bool>,
        fill: Fill,
        size: [u32; 2],
        output: Output,
    ) -> Result<Self> {
        let dense = match fill {
            Fill::Raster if !backend.caps().is_cpu => DENSE_IN_RASTER,
            _ => DENSE,
        };
        let kernels = if wanted == Some(true) { Some(Kernels::new(backend, output)?) } else { None };
        let (memory, room, alignment) = (None, Room::default(), backend.caps().binding_alignment);
        Ok(Self {
            wanted,
            size,
            output,
            kernels,
            memory,
            alignment,
            dense,
            is_dense: false,
            frame: 0,
            predicted: 0,
            used: 0,
            room,
        })
    }

    /// Whether so many fragments are so dense that most of them are hidden by others.
    fn are_dense(&self, fragments: f64, view: &View, draws: &[SectionDraw]) -> bool {
        let share = if self.is_dense { BACK } else { 1.0 };
        fragments > share * LEAST && fragments > share * self.dense * pixels(view, draws)
    }

    /// Whether the next frame looks for hidden hair, if there is room for its lists.
    pub(crate) fn is_wanted(&self) -> bool {
        self.wanted.unwrap_or(self.is_dense)
    }

    /// Whether there is all that takes.
    pub(crate) fn is_ready(&self) -> bool {
        self.kernels.is_some() && self.memory.as_ref().is_some_and(|memory| memory.room.holds(self.room))
    }

    /// A view with so many fragments comes next.
    pub(crate) fn expect(&mut self, view: &View, draws: &[SectionDraw], fragments: f64) {
        self.room = self.room.and(Room::of(self.alignment, draws));
        self.is_dense = self.are_dense(fragments, view, draws);
    }

    /// Gives back memory that was not in use for a long time.
    pub(crate) fn release_unused(&mut self, backend: &mut dyn Backend) {
        if self.memory.is_some() && self.frame - self.used > UNUSED_FRAMES {
            self.release(backend);
            self.room = Room::default();
        }
    }

    /// Makes what it takes to look for hidden hair, where that is wanted and not there, and changes nothing yet.
    pub(crate) fn prepare(&self, backend: &mut dyn Backend) -> Result<Option<Prepared>> {
        let has_work = self.is_wanted() && self.room != Room::default();
        if !has_work || self.is_ready() || memory::check(backend, self.size, self.room).is_err() {
            return Ok(None);
        }
        let kernels = if self.kernels.is_none() { Some(Kernels::new(backend, self.output)?) } else { None };
        let memory = Memory::new(backend, self.size, self.output.views, self.alignment, self.room)?;
        Ok(Some(Prepared { kernels, memory }))
    }

    /// Uses what was prepared.
    pub(crate) fn turn_on(&mut self, backend: &mut dyn Backend, prepared: Prepared) {
        if let Some(kernels) = prepared.kernels {
            self.kernels = Some(kernels);
        }
        if let Some(old) = self.memory.replace(prepared.memory) {
            old.destroy(backend);
        }
        self.used = self.frame;
        self.forget_bindings();
    }

    /// Gives back the memory.
    pub(crate) fn release(&mut self, backend: &mut dyn Backend) {
        if let Some(memory) = self.memory.take() {
            memory.destroy(backend);
        }
        self.forget_bindings();
    }

    /// Views have another size from now on.
    pub(crate) fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) {
        self.release(backend);
        self.size = size;
    }

    fn forget_bindings(&mut self) {
        self.kernels.iter_mut().for_each(Kernels::forget_bindings);
    }

    /// Bytes of its memory.
    pub(crate) fn bytes(&self) -> u64 {
        self.memory.as_ref().map_or(0, Memory::bytes)
    }

    pub(crate) fn begin_frame(&mut self) {
        self.frame += 1;
        self.kernels.iter_mut().for_each(Kernels::begin_frame);
    }

    /// Predicts now and then how dense hair is: the densest view decides.
    fn predict(&mut self, view: &View, draws: &[SectionDraw]) {
        if self.frame % FRAMES != 1 || self.wanted.is_some() {
            return;
        }
        let is_dense = self.are_dense(predict::fragments(view, draws), view, draws);
        self.is_dense = is_dense || (self.is_dense && self.predicted == self.frame);
        self.predicted = self.frame;
    }

    /// Writes the passes of a view; none where hidden hair is not looked for.
    pub(crate) fn passes(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draws: &[SectionDraw],
        targets: &Targets,
    ) -> Result<Option<Occluded>> {
        self.predict(view.view, draws);
        let is_wanted = self.is_wanted();
        self.room = Room::of(self.alignment, draws);
        let (Some(kernels), Some(memory)) = (&mut self.kernels, &self.memory) else { return Ok(None) };
        if !is_wanted || !memory.room.holds(self.room) {
            return Ok(None);
        }
        let [nearest, farthest] = distances(view.view, draws);
        let depth = farthest - nearest;
        memory.begin(list, view, OcclusionUniform { nearest, depth, closing: CLOSING, stride: STRIDE });
        self.used = self.frame;
        let lists = memory.lists(draws);
        kernels.find(list, &Hair { view, draws, scene: targets.depth, memory, lists: &lists })?;
        Ok(Some(Occluded { depth: memory.depth, lists }))
    }
}

/// What the walks of a technique take in place of the scene and of all segments.
#[derive(Debug)]
pub(crate) struct Occluded {
    /// The nearness of what is seen farthest in each pixel of the view.
    pub(crate) depth: TextureId,
    /// The segments of each section that may be seen.
    pub(crate) lists: Vec<Listed>,
}

impl Listed {
    /// What bindings with it differ by: sections have other places where others come and go.
    pub(crate) fn place(&self) -> [u64; 2] {
        [self.first, self.groups.1]
    }

    /// What a walk binds.
    pub(crate) fn binding(&self) -> (&'static str, Binding) {
        ("listed", self.segments)
    }
}
