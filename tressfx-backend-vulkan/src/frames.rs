//! Recordings that the GPU may still be busy with, and what waits for it.
//!
//! Each recording ends by setting an event, which the CPU can ask for at any time: so nobody has to tell the backend when
//! a frame begins or how many are in flight. The event tells that bytes have come back. It does not tell that the command
//! buffer is over, and until then Vulkan lets nobody destroy what it names: that an engine tells with
//! [`VulkanBackend::retire`], or with [`VulkanBackend::discard`] where it throws a command buffer away.

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

/// An upload buffer of so many bytes is kept for the next list. A larger one is for a groom on its way, which comes once.
const KEPT_BYTES: u64 = 1 << 20;

/// What is freed once the GPU cannot use it any more.
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
    /// Counts recordings.
    pub(crate) number: u64,
    /// Set once it has run.
    event: vk::Event,
    has_run: bool,
    /// The bytes of its uploads; kept for the next list, if they are few.
    pub(crate) uploads: Option<HostBuffer>,
    pub(crate) queries: Queries,
    /// What it fills with zeros before their first use.
    pub(crate) zeroed: Vec<Resource>,
    /// The read-backs that it makes.
    pub(crate) tickets: Vec<Ticket>,
    /// What it has changed about hazards.
    pub(crate) undo: Undo,
    /// What was thrown away while this was the newest recording.
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

    /// Writes what tells the CPU that everything before it has run.
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
    /// A recording to write to. It does not count before it is [added](Self::add).
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

    /// Takes the oldest recording out, if it is one of the first `number`.
    pub(crate) fn take_oldest(&mut self, number: u64) -> Option<Recording> {
        self.in_flight.pop_front_if(|oldest| oldest.number <= number)
    }

    /// Takes the newest recording out, if it is none of the first `number`.
    pub(crate) fn take_newest(&mut self, number: u64) -> Option<Recording> {
        self.in_flight.pop_back_if(|newest| newest.number > number)
    }

    /// The newest recording, where the first `number` are over and this one among them, and it has not run: so it never will.
    pub(crate) fn take_never_run(&mut self, gpu: &Gpu, number: u64) -> Option<Recording> {
        self.in_flight.pop_back_if(|newest| newest.number <= number && !newest.has_run(gpu))
    }

    /// Forgets resources that no list can name any more.
    pub(crate) fn forget(&mut self, gone: &HashSet<Resource>) {
        for recording in &mut self.in_flight {
            recording.zeroed.retain(|resource| !gone.contains(resource));
        }
        if let Some(newest) = self.in_flight.back_mut() {
            newest.forgotten.extend(gone);
        }
    }

    /// Whether a resource that no list can name any more waits for recordings.
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

    /// A recording is over, and all that are older: what has waited for it is destroyed.
    pub(crate) fn finish(&mut self, gpu: &Gpu, sets: &mut Sets, mut recording: Recording) {
        recording.garbage.drain(..).for_each(|garbage| garbage.destroy(gpu, sets));
        self.reuse(gpu, sets, recording);
    }

    /// The newest recording will never run. What has waited for it waits for those that are older.
    pub(crate) fn take_back(&mut self, gpu: &Gpu, sets: &mut Sets, mut recording: Recording) {
        for garbage in std::mem::take(&mut recording.garbage) {
            self.throw_away(gpu, sets, garbage);
        }
        if let Some(older) = self.in_flight.back_mut() {
            older.forgotten.append(&mut recording.forgotten);
        }
        self.reuse(gpu, sets, recording);
    }

    /// Makes a recording ready for its next use: one that is over, or was never written.
    pub(crate) fn reuse(&mut self, gpu: &Gpu, sets: &mut Sets, mut recording: Recording) {
        recording.zeroed.clear();
        recording.tickets.clear();
        recording.forgotten.clear();
        recording.undo = Undo::default();
        let large = recording.uploads.take_if(|uploads| uploads.bytes > KEPT_BYTES);
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
