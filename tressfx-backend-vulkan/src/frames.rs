//! Recordings that the GPU may still execute, and what is freed after them.
//!
//! A recording is one list in a command buffer; a command buffer can hold several. Each recording ends by setting an event,
//! whose state the CPU can read at any time. So nobody has to tell the backend when a frame begins or how many frames are in
//! flight. When the event is set, the recording has run, and the bytes of its read-backs are there. But the command buffer
//! may still be executing, and Vulkan forbids to destroy anything that it names. The engine tells the end of the command
//! buffer with [`VulkanBackend::mark_finished`], or with [`VulkanBackend::mark_discarded_after`] that it was thrown away. In
//! this module "has run" means that the event is set, and "is over" that the engine has told the end.

use std::collections::{HashSet, VecDeque};

use ash::vk;
use tressfx_core::error::Result;
use tressfx_core::hazards::Undo;
use tressfx_core::id::Resource;
use tressfx_core::pass::Ticket;

use crate::device::Gpu;
use crate::memory::HostBuffer;
use crate::pipeline::Pipeline;
use crate::resource::{Buffer, Texture};
use crate::sets::{Set, Sets};
use crate::timer::Queries;

/// An upload buffer of up to this many bytes is kept for the next list. A larger one has held a new groom, which is uploaded
/// only once, and is freed.
const MAX_KEPT_BYTES: u64 = 1 << 20;

/// Something that is freed once the GPU cannot use it any more.
#[derive(Debug)]
pub(crate) enum Garbage {
    Buffer(Buffer),
    Texture(Texture),
    Pipeline(Pipeline),
    Set(Set),
    Host(HostBuffer),
}

impl Garbage {
    pub(crate) fn destroy(self, gpu: &Gpu, sets: &mut Sets) {
        match self {
            Self::Buffer(buffer) => gpu.destroy_buffer(buffer),
            Self::Texture(texture) => gpu.destroy_texture(texture),
            Self::Pipeline(pipeline) => gpu.destroy_pipeline(pipeline),
            Self::Set(set) => sets.free(gpu, set),
            Self::Host(buffer) => gpu.free_host(buffer),
        }
    }
}

/// What one recorded list needs until it has run.
#[derive(Debug)]
pub(crate) struct Recording {
    /// How many recordings were made up to this one.
    pub(crate) number: u64,
    /// The GPU sets it when it has run.
    event: vk::Event,
    has_run: bool,
    /// The buffer with the bytes of its uploads; if it is small it is kept for the next list.
    pub(crate) uploads: Option<HostBuffer>,
    pub(crate) queries: Queries,
    /// The resources that it fills with zeros before their first use.
    pub(crate) zeroed: Vec<Resource>,
    /// The read-backs that it makes.
    pub(crate) tickets: Vec<Ticket>,
    /// Takes its changes to the hazards back.
    pub(crate) undo: Undo,
    /// What was destroyed while this was the newest recording: it is freed when this one is over.
    garbage: Vec<Garbage>,
    /// The resources among it.
    pub(crate) forgotten: Vec<Resource>,
}

impl Recording {
    fn new(gpu: &Gpu) -> Result<Self> {
        let info = vk::EventCreateInfo::default();
        // SAFETY: the device is alive.
        let event = gpu.create("hair.recording", |device| unsafe { device.create_event(&info, None) })?;
        Ok(Self {
            number: 0,
            event,
            has_run: false,
            uploads: None,
            queries: Queries::default(),
            zeroed: Vec::new(),
            tickets: Vec::new(),
            undo: Undo::default(),
            garbage: Vec::new(),
            forgotten: Vec::new(),
        })
    }

    /// Writes the command that sets the event after everything before it has run.
    pub(crate) fn end(&self, gpu: &Gpu, commands: vk::CommandBuffer) {
        // SAFETY: the command buffer is being recorded, outside of a render pass, and the event is not in use.
        unsafe { gpu.device.cmd_set_event(commands, self.event, vk::PipelineStageFlags::ALL_COMMANDS) };
    }

    pub(crate) fn has_run(&mut self, gpu: &Gpu) -> bool {
        if !self.has_run {
            // SAFETY: the event is alive.
            let status = unsafe { gpu.device.get_event_status(self.event) };
            self.has_run = status.unwrap_or_else(|code| {
                gpu.failed(code, "hair.recording", 0);
                false
            });
        }
        self.has_run
    }

    fn destroy(mut self, gpu: &Gpu, sets: &mut Sets) {
        self.garbage.drain(..).for_each(|garbage| garbage.destroy(gpu, sets));
        self.uploads.into_iter().for_each(|uploads| gpu.free_host(uploads));
        self.queries.destroy(gpu);
        // SAFETY: the GPU has finished with it.
        unsafe { gpu.device.destroy_event(self.event, None) };
    }
}

/// Recordings in flight, oldest first, and those that can be used again.
#[derive(Debug, Default)]
pub(crate) struct Frames {
    in_flight: VecDeque<Recording>,
    idle: Vec<Recording>,
    pub(crate) recorded: u64,
}

impl Frames {
    /// A new recording. It gets its number now and counts as recorded once it is [added](Self::add).
    pub(crate) fn begin(&mut self, gpu: &Gpu) -> Result<Recording> {
        let mut recording = self.idle.pop().map_or_else(|| Recording::new(gpu), Ok)?;
        recording.number = self.recorded + 1;
        Ok(recording)
    }

    /// A recording was written.
    pub(crate) fn add(&mut self, recording: Recording) {
        self.recorded = recording.number;
        self.in_flight.push_back(recording);
    }

    /// The recordings in flight, oldest first.
    pub(crate) fn in_flight(&mut self) -> impl Iterator<Item = &mut Recording> {
        self.in_flight.iter_mut()
    }

    /// Whether the recording of that number has run.
    pub(crate) fn has_run(&mut self, gpu: &Gpu, number: u64) -> bool {
        let recording = self.in_flight.iter_mut().find(|recording| recording.number == number);
        recording.is_none_or(|recording| recording.has_run(gpu))
    }

    /// Takes the oldest recording out, if its number is at most `number`.
    pub(crate) fn take_oldest(&mut self, number: u64) -> Option<Recording> {
        self.in_flight.pop_front_if(|oldest| oldest.number <= number)
    }

    /// Takes the newest recording out, if its number is larger than `number`.
    pub(crate) fn take_newest(&mut self, number: u64) -> Option<Recording> {
        self.in_flight.pop_back_if(|newest| newest.number > number)
    }

    /// Takes the newest recording out, if the engine says that it is over (its number is at most `number`) but it has not
    /// run: then it never will.
    pub(crate) fn take_never_run(&mut self, gpu: &Gpu, number: u64) -> Option<Recording> {
        self.in_flight.pop_back_if(|newest| newest.number <= number && !newest.has_run(gpu))
    }

    /// Takes resources that no list can name any more out of what recordings fill with zeros, and notes that the newest
    /// recording may still use them.
    pub(crate) fn forget(&mut self, gone: &HashSet<Resource>) {
        for recording in &mut self.in_flight {
            recording.zeroed.retain(|resource| !gone.contains(resource));
        }
        if let Some(newest) = self.in_flight.back_mut() {
            newest.forgotten.extend(gone);
        }
    }

    /// Whether a resource that no list can name any more is still kept for a recording in flight.
    pub(crate) fn holds(&self, resource: Resource) -> bool {
        self.in_flight.iter().any(|recording| recording.forgotten.contains(&resource))
    }

    /// Destroys something once everything that was recorded so far is over.
    pub(crate) fn throw_away(&mut self, gpu: &Gpu, sets: &mut Sets, garbage: Garbage) {
        match self.in_flight.back_mut() {
            Some(recording) => recording.garbage.push(garbage),
            None => garbage.destroy(gpu, sets),
        }
    }

    /// This recording and all older ones are over: what was kept for it is freed.
    pub(crate) fn finish(&mut self, gpu: &Gpu, sets: &mut Sets, mut recording: Recording) {
        recording.garbage.drain(..).for_each(|garbage| garbage.destroy(gpu, sets));
        self.reuse(gpu, sets, recording);
    }

    /// The newest recording will never run. What was kept for it is now kept for the recording before it.
    pub(crate) fn undo(&mut self, gpu: &Gpu, sets: &mut Sets, mut recording: Recording) {
        for garbage in std::mem::take(&mut recording.garbage) {
            self.throw_away(gpu, sets, garbage);
        }
        if let Some(older) = self.in_flight.back_mut() {
            older.forgotten.append(&mut recording.forgotten);
        }
        self.reuse(gpu, sets, recording);
    }

    /// Makes a recording ready for its next use. It is over, was undone, or was never added.
    pub(crate) fn reuse(&mut self, gpu: &Gpu, sets: &mut Sets, mut recording: Recording) {
        recording.zeroed.clear();
        recording.tickets.clear();
        recording.forgotten.clear();
        recording.undo = Undo::default();
        let large = recording.uploads.take_if(|uploads| uploads.bytes > MAX_KEPT_BYTES);
        large.into_iter().for_each(|uploads| gpu.free_host(uploads));
        recording.has_run = false;
        // SAFETY: nothing sets the event any more.
        match unsafe { gpu.device.reset_event(recording.event) } {
            Ok(()) => self.idle.push(recording),
            Err(_) => recording.destroy(gpu, sets),
        }
    }

    pub(crate) fn destroy(&mut self, gpu: &Gpu, sets: &mut Sets) {
        self.in_flight.drain(..).chain(self.idle.drain(..)).for_each(|recording| recording.destroy(gpu, sets));
    }
}
