//! Recordings that the GPU may still be busy with, and what waits for it.
//!
//! Each recording ends by setting an event, which the CPU can ask for at any time: so nobody has to tell the backend when
//! a frame begins or how many are in flight. The event tells that bytes have come back. It does not tell that the command
//! buffer is over, and until then Vulkan lets nobody destroy what it names: that an engine tells with
//! [`VulkanBackend::retire`].

use std::collections::VecDeque;

use ash::vk;
use tressfx_core::error::Result;
use tressfx_core::hazards::Hazards;
use tressfx_core::id::Resource;

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::error::error;
use crate::pipeline::Pipeline;
use crate::resource::{Buffer, HostBuffer, Texture};
use crate::timer::Queries;

/// An upload buffer of so many bytes is kept for the next list. A larger one is for a groom on its way, which comes once.
const KEPT_BYTES: u64 = 1 << 20;

/// What is freed once the GPU cannot use it any more.
#[derive(Debug)]
pub(crate) enum Garbage {
    Buffer(Buffer),
    Texture(Texture),
    Pipeline(Pipeline),
    Set(vk::DescriptorPool, vk::DescriptorSet),
    Host(HostBuffer),
}

impl Gpu {
    pub(crate) fn destroy(&self, garbage: Garbage) {
        match garbage {
            Garbage::Buffer(buffer) => self.destroy_buffer(buffer),
            Garbage::Texture(texture) => self.destroy_texture(texture),
            Garbage::Pipeline(pipeline) => self.destroy_pipeline(pipeline),
            // SAFETY: the set is of that pool, and no recording that can still run binds it.
            Garbage::Set(pool, set) => unsafe {
                let _ = self.device.free_descriptor_sets(pool, &[set]);
            },
            Garbage::Host(buffer) => self.free_host(buffer),
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
    /// The bytes of its uploads; kept for the next list, if they are few.
    pub(crate) uploads: Option<HostBuffer>,
    pub(crate) queries: Queries,
    /// What it fills with zeros before their first use.
    pub(crate) zeroed: Vec<Resource>,
    /// The state of everything before it: what holds again where it never runs.
    pub(crate) before: Hazards,
    garbage: Vec<Garbage>,
}

/// Recordings in flight, oldest first, and those that can be used again.
#[derive(Debug, Default)]
pub(crate) struct Frames {
    in_flight: VecDeque<Recording>,
    idle: Vec<Recording>,
    pub(crate) recorded: u64,
    /// Command buffers of the recordings up to this number are known to be over.
    retired: u64,
}

impl Recording {
    fn new(gpu: &Gpu) -> Result<Self> {
        // SAFETY: the device is alive.
        let event = unsafe { gpu.device.create_event(&vk::EventCreateInfo::default(), None) };
        let event = event.map_err(|code| error(code, "hair.recording", 0))?;
        gpu.name(event, "hair.recording");
        Ok(Self {
            number: 0,
            event,
            uploads: None,
            queries: Queries::default(),
            zeroed: Vec::new(),
            before: Hazards::default(),
            garbage: Vec::new(),
        })
    }

    /// Writes what tells the CPU that everything before it has run.
    pub(crate) fn end(&self, gpu: &Gpu, commands: vk::CommandBuffer) {
        // SAFETY: the command buffer is being recorded, outside of a render pass, and the event is not in use.
        unsafe { gpu.device.cmd_set_event(commands, self.event, vk::PipelineStageFlags::ALL_COMMANDS) };
    }

    pub(crate) fn has_run(&self, gpu: &Gpu) -> bool {
        // SAFETY: the event is alive.
        unsafe { gpu.device.get_event_status(self.event) }.unwrap_or(false)
    }

    fn destroy(mut self, gpu: &Gpu) {
        self.garbage.drain(..).for_each(|garbage| gpu.destroy(garbage));
        self.uploads.into_iter().for_each(|uploads| gpu.free_host(uploads));
        self.queries.destroy(gpu);
        // SAFETY: the GPU has finished with it.
        unsafe { gpu.device.destroy_event(self.event, None) };
    }
}

impl Frames {
    /// A recording to write to.
    pub(crate) fn begin(&mut self, gpu: &Gpu) -> Result<Recording> {
        let mut recording = self.idle.pop().map_or_else(|| Recording::new(gpu), Ok)?;
        self.recorded += 1;
        recording.number = self.recorded;
        Ok(recording)
    }

    pub(crate) fn end(&mut self, recording: Recording) {
        self.in_flight.push_back(recording);
    }

    /// Whether the recording of that number has run.
    pub(crate) fn has_run(&self, gpu: &Gpu, number: u64) -> bool {
        self.in_flight
            .iter()
            .find(|recording| recording.number == number)
            .is_none_or(|recording| recording.has_run(gpu))
    }

    /// Forgets a destroyed resource.
    pub(crate) fn forget(&mut self, resource: Resource) {
        for recording in &mut self.in_flight {
            recording.zeroed.retain(|&other| other != resource);
            recording.before.forget(resource);
        }
    }

    /// Makes a recording ready for its next use.
    fn recycle(&mut self, gpu: &Gpu, mut recording: Recording) {
        recording.garbage.drain(..).for_each(|garbage| gpu.destroy(garbage));
        recording.zeroed.clear();
        let large = recording.uploads.take_if(|uploads| uploads.bytes > KEPT_BYTES);
        large.into_iter().for_each(|uploads| gpu.free_host(uploads));
        // SAFETY: it has run, so nothing sets the event any more.
        let _ = unsafe { gpu.device.reset_event(recording.event) };
        self.idle.push(recording);
    }

    pub(crate) fn destroy(&mut self, gpu: &Gpu) {
        self.in_flight.drain(..).chain(self.idle.drain(..)).for_each(|recording| recording.destroy(gpu));
    }
}

impl VulkanBackend {
    /// How many lists were recorded so far: for [`retire`](Self::retire).
    pub fn recorded(&self) -> u64 {
        self.frames.recorded
    }

    /// Says that the command buffers of the first `recorded` recordings are over: the engine has waited for their fences.
    ///
    /// An engine that has waited for the fence of a frame says here what [`recorded`](Self::recorded) said when it submitted
    /// it. What those recordings have kept, and what was destroyed since, is freed now and no sooner.
    pub fn retire(&mut self, recorded: u64) {
        self.frames.retired = self.frames.retired.max(recorded);
        self.collect();
    }

    /// Reads the times of finished recordings, and frees what those have kept whose command buffers are over.
    pub(crate) fn collect(&mut self) {
        self.collect_until(self.frames.retired);
    }

    /// As [`collect`](Self::collect), for recordings up to a number. What was thrown away since is older recordings' too, so
    /// the oldest goes first.
    pub(crate) fn collect_until(&mut self, number: u64) {
        let frames = &mut self.frames;
        let mut over = 0;
        for recording in &mut frames.in_flight {
            if !recording.has_run(&self.gpu) {
                break;
            }
            self.timer.finish(&self.gpu, recording);
            over += usize::from(recording.number <= number);
        }
        for _ in 0..over {
            let Some(recording) = frames.in_flight.pop_front() else { return };
            frames.recycle(&self.gpu, recording);
        }
    }

    /// Destroys something once everything that was recorded so far has run.
    pub(crate) fn throw_away(&mut self, garbage: Garbage) {
        self.collect();
        match self.frames.in_flight.back_mut() {
            Some(recording) => recording.garbage.push(garbage),
            None => self.gpu.destroy(garbage),
        }
    }

    /// Waits until the device has finished with everything. What was recorded before and never submitted must not be submitted
    /// any more: its memory is taken back, and everything counts as it was before.
    ///
    /// An engine that records lists and throws its command buffer away calls this before it records the next one. No other
    /// thread may submit meanwhile.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn wait_idle(&mut self) -> Result<()> {
        // SAFETY: the device is alive, and no queue of it is in use, as promised above.
        let waited = unsafe { self.gpu.device.device_wait_idle() };
        self.noted(waited.map_err(|code| error(code, "wait", 0)))?;
        self.collect_until(u64::MAX);
        let never_ran = self.frames.in_flight.iter_mut().find(|recording| !recording.has_run(&self.gpu));
        if let Some(first) = never_ran {
            self.hazards = std::mem::take(&mut first.before);
        }
        while let Some(mut recording) = self.frames.in_flight.pop_front() {
            if recording.has_run(&self.gpu) {
                self.timer.finish(&self.gpu, &mut recording);
            } else {
                self.not_zeroed.append(&mut recording.zeroed);
                self.forget_reads(recording.number);
            }
            self.frames.recycle(&self.gpu, recording);
        }
        Ok(())
    }
}
