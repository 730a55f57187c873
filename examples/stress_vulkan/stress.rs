//! Frames in which everything changes that can change.

use std::rc::Rc;

use anyhow::{Result, ensure};
use tressfx_asset::builtin::Builtin;
use tressfx_backend_vulkan::{EngineCommands, VulkanBackend};
use tressfx_core::backend::{Backend, Format, Record};
use tressfx_core::glam::Mat4;
use tressfx_core::pass::PassList;
use tressfx_core::view::View;
use tressfx_examples::{Hair, Stage, head};

use crate::frames::Frames;
use crate::gpu::{Gpu, waits};
use crate::targets::{Images, Replaced};

/// Seconds from frame to frame.
const DT: f64 = 1.0 / 60.0;
const SIZES: [[u32; 2]; 3] = [[96, 64], [64, 96], [128, 80]];
const GROOMS: usize = 3;

/// What came of it.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Figures {
    pub(crate) adapter: String,
    /// Whether frames and copies have queues of their own.
    pub(crate) two_queues: bool,
    pub(crate) submitted: u64,
    pub(crate) thrown_away: u64,
    pub(crate) minimized: u64,
    pub(crate) resizes: u64,
    pub(crate) grooms: u64,
    /// Lists that were recorded after something that they name was destroyed.
    pub(crate) late_lists: u64,
    /// Frames that had to wait for the frame that was three before.
    pub(crate) stalls: u64,
    /// Calls that wait for a device or a queue, and for fences beside the engine's one a frame.
    pub(crate) idle_waits: u64,
    pub(crate) other_fence_waits: u64,
    /// Bytes of the allocator's in use before the backend was made, at most between frames, at the end with the backend still
    /// there, and without it.
    pub(crate) allocated: [u64; 4],
    /// What the backend counts at the end.
    pub(crate) memory: u64,
    pub(crate) messages: Vec<String>,
}

/// A groom.
struct Groom {
    hair: Hair,
    /// Its first list carries its rest pose, and must run.
    has_run: bool,
}

/// The lists of a frame that are not recorded yet, and what they draw to.
struct Written {
    lists: Vec<PassList>,
    images: Option<Rc<Images>>,
    must_run: bool,
}

/// The engine.
struct Stress {
    gpu: Gpu,
    backend: VulkanBackend,
    frames: Frames,
    stages: Vec<Stage>,
    builtin: Builtin,
    /// Which of the sizes; none where the window is minimised.
    size: usize,
    images: Option<Rc<Images>>,
    replaced: Replaced,
    grooms: Vec<Groom>,
    written: Written,
    figures: Figures,
}

/// Draws so many frames.
pub(crate) fn run(frames: u64, validate: bool) -> Result<Figures> {
    let gpu = Gpu::open(validate)?;
    let started = gpu.allocated();
    let mut stress = Stress::new(gpu)?;
    stress.figures.allocated[0] = started;
    let [idle, fences] = waits();
    for frame in 1..=frames {
        stress.frame(frame)?;
    }
    let now = waits();
    stress.figures.idle_waits = now[0] - idle;
    stress.figures.other_fence_waits = now[1] - fences - frames;
    stress.end()
}

impl Stress {
    fn new(gpu: Gpu) -> Result<Self> {
        let backend = gpu.share();
        let frames = Frames::new(&gpu)?;
        let builtin = Builtin::parse("wavy:60:8")?;
        let stages = SIZES.map(|size| Stage::new(&builtin, size)).into();
        let two_queues = gpu.frames.0 != gpu.copies.0;
        let figures = Figures { adapter: backend.caps().adapter.clone(), two_queues, ..Figures::default() };
        let images = Some(Rc::new(Images::new(&gpu, SIZES[0])?));
        let written = Written { lists: Vec::new(), images: None, must_run: false };
        let (replaced, grooms) = (Replaced::default(), Vec::new());
        Ok(Self { gpu, backend, frames, stages, builtin, size: 0, images, replaced, grooms, written, figures })
    }

    fn frame(&mut self, frame: u64) -> Result<()> {
        let mark = self.frames.wait(&self.gpu, frame)?;
        // SAFETY: the engine has waited for the fence of that frame; what was thrown away before was discarded.
        unsafe { self.backend.mark_finished(mark) };
        self.replaced.free(&self.gpu, &self.backend);
        self.figures.allocated[1] = self.figures.allocated[1].max(self.gpu.allocated());
        // The lists of this frame are written, and not recorded yet.
        let changed = self.change(frame)?;
        let Written { lists, images, must_run } =
            std::mem::replace(&mut self.written, Written { lists: Vec::new(), images: None, must_run: false });
        self.figures.late_lists += if changed { lists.len() as u64 } else { 0 };
        let raw = self.frames.begin(&self.gpu, frame, images.as_ref())?;
        let before = self.backend.recorded();
        // SAFETY: it is being recorded, and is submitted or discarded below.
        let mut commands = unsafe { EngineCommands::new(&self.backend, raw) };
        lists.iter().try_for_each(|list| self.backend.record(&mut commands, list))?;
        if frame.is_multiple_of(17) && !must_run {
            self.frames.discard(&self.gpu, frame)?;
            // SAFETY: it is not submitted.
            unsafe { self.backend.mark_discarded_after(before) };
            self.figures.thrown_away += 1;
        } else {
            self.frames.submit(&self.gpu, frame, self.backend.recorded())?;
            self.figures.submitted += 1;
        }
        drop(lists);
        for groom in &mut self.grooms {
            groom.hair.observe(&mut self.backend)?;
        }
        self.write(frame + 1)
    }

    /// Grooms come and go, the window changes its size, or is minimised for a while. Says whether anything was destroyed.
    fn change(&mut self, frame: u64) -> Result<bool> {
        let mut destroyed = false;
        if frame % 97 == 90 {
            self.replace(None);
            destroyed = true;
        } else if frame % 97 == 1 && self.images.is_none() {
            self.resize(self.size)?;
        } else if frame % 31 == 30 && self.images.is_some() {
            self.resize((self.size + 1) % SIZES.len())?;
            destroyed = true;
        }
        if frame % 25 == 1 && self.images.is_some() {
            if self.grooms.len() == GROOMS {
                let oldest = self.grooms.remove(0);
                oldest.hair.destroy(&mut self.backend);
                destroyed = true;
            }
            self.grow()?;
        }
        Ok(destroyed)
    }

    fn grow(&mut self) -> Result<()> {
        let Some(images) = &self.images else { return Ok(()) };
        let targets = images.import(&mut self.backend)?;
        let view = &self.stages[self.size].view;
        let hair = Hair::new(&mut self.backend, &self.builtin, view, Format::Rgba16F, targets)?;
        self.grooms.push(Groom { hair, has_run: false });
        self.figures.grooms += 1;
        Ok(())
    }

    /// Puts other images, or none, in the place of those that there are.
    fn replace(&mut self, images: Option<Rc<Images>>) {
        if let Some(old) = std::mem::replace(&mut self.images, images) {
            self.replaced.add(old);
        }
    }

    fn resize(&mut self, size: usize) -> Result<()> {
        self.size = size;
        let images = Rc::new(Images::new(&self.gpu, SIZES[size])?);
        self.replace(Some(images.clone()));
        for groom in &mut self.grooms {
            let targets = images.import(&mut self.backend)?;
            groom.hair.resize(&mut self.backend, &self.stages[size].view, targets)?;
        }
        self.figures.resizes += 1;
        Ok(())
    }

    /// Writes the lists of a frame. A minimised window has a view without pixels, and the hair goes on moving.
    fn write(&mut self, frame: u64) -> Result<()> {
        let (stage, head) = (&self.stages[self.size], head(frame as f64 * DT));
        let nothing = View::new(Mat4::IDENTITY, Mat4::IDENTITY, stage.view.depth(), [0, 0])?;
        let view = if self.images.is_some() { stage.view } else { nothing };
        self.figures.minimized += u64::from(view.is_empty());
        let mut lists = Vec::new();
        let mut must_run = false;
        for groom in &mut self.grooms {
            lists.push(groom.hair.frame(DT, head, &view, &stage.lights)?.clone());
            must_run |= !std::mem::replace(&mut groom.has_run, true);
        }
        self.written = Written { lists, images: self.images.clone(), must_run };
        Ok(())
    }

    /// Everything goes. The figures are complete then.
    fn end(mut self) -> Result<Figures> {
        self.figures.stalls = self.frames.stalls;
        self.written.lists.clear();
        self.written.images = None;
        self.replace(None);
        self.grooms.drain(..).for_each(|groom| groom.hair.destroy(&mut self.backend));
        self.frames.finish(&self.gpu)?;
        // SAFETY: the engine has waited for all frames.
        unsafe { self.backend.mark_finished(self.backend.recorded()) };
        self.replaced.free(&self.gpu, &self.backend);
        ensure!(self.replaced.is_empty(), "something still uses images that were replaced");
        self.figures.memory = self.backend.memory().bytes;
        self.figures.allocated[2] = self.gpu.allocated();
        drop(self.backend);
        self.figures.allocated[3] = self.gpu.allocated();
        self.frames.destroy(&self.gpu);
        self.figures.messages = self.gpu.close();
        Ok(self.figures)
    }
}

impl Figures {
    /// Whether nobody has waited, all memory came back and the validation layer was silent.
    pub(crate) fn check(&self) -> Result<()> {
        let [started, _, kept, ended] = self.allocated;
        ensure!(self.messages.is_empty(), "the validation layer says: {}", self.messages.join("\n"));
        ensure!(self.idle_waits == 0, "{} waits for a device or a queue", self.idle_waits);
        ensure!(self.other_fence_waits == 0, "{} waits for fences", self.other_fence_waits);
        ensure!(self.memory == 0, "{} bytes still count", self.memory);
        // Upload buffers of at most a MiB each are kept for the lists of three frames.
        let most = 3 * GROOMS as u64 * (1 << 20);
        ensure!(kept <= started + most, "{kept} bytes are kept");
        ensure!(ended == started, "{ended} bytes are left, {started} were there");
        Ok(())
    }
}
