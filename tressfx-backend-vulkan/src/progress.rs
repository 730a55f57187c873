//! How far the GPU and the engine have come.

use std::collections::HashSet;

use tressfx_core::backend::Unlisted;
use tressfx_core::id::{PipelineId, Resource};

use crate::VulkanBackend;
use crate::frames::{Garbage, Recording};

impl VulkanBackend {
    /// How many lists were recorded so far: for [`mark_finished`](Self::mark_finished) and
    /// [`mark_discarded_after`](Self::mark_discarded_after).
    pub fn recorded(&self) -> u64 {
        self.frames.recorded
    }

    /// Says that the command buffers of the first `recorded` recordings are over: the engine has waited for their fences.
    ///
    /// An engine that has waited for the fence of a frame says here what [`recorded`](Self::recorded) said when it submitted
    /// it. What those recordings have kept, and what was destroyed since, is freed now and no sooner. Nothing is waited for.
    /// Recordings that were thrown away and that [`mark_discarded_after`](Self::mark_discarded_after) was not told of are
    /// freed with the others.
    ///
    /// # Safety
    /// Each of them has run to its end, or was never submitted and never will be.
    pub unsafe fn mark_finished(&mut self, recorded: u64) {
        self.time();
        while let Some(newest) = self.frames.take_never_run(&self.gpu, recorded) {
            self.undo_recording(newest);
        }
        while let Some(mut oldest) = self.frames.take_oldest(recorded) {
            let has_run = oldest.has_run(&self.gpu);
            self.reads.end(&self.gpu, &oldest.tickets, oldest.number, has_run);
            self.frames.finish(&self.gpu, &mut self.sets, oldest);
        }
        self.sweep();
    }

    /// Says that everything that was recorded after the first `recorded` recordings was thrown away. Everything counts as it
    /// was before; read-backs have failed. Nothing is waited for.
    ///
    /// An engine that throws a command buffer away says here what [`recorded`](Self::recorded) said before it recorded the
    /// first list into it, before it records or [runs](tressfx_core::backend::Run::run) the next.
    ///
    /// # Safety
    /// None of them was submitted, and none ever will be.
    pub unsafe fn mark_discarded_after(&mut self, recorded: u64) {
        while let Some(newest) = self.frames.take_newest(recorded) {
            self.undo_recording(newest);
        }
        self.sweep();
    }

    /// Whether a resource may still be used: it was not destroyed, or lists or recordings that may name it are not over. An
    /// engine frees what it had lent once it is not.
    pub fn uses(&self, resource: Resource) -> bool {
        self.catalog.has(resource) || self.frames.holds(resource)
    }

    /// The newest recording never runs: everything is as it was before it.
    fn undo_recording(&mut self, mut recording: Recording) {
        self.tracker.hazards.undo(std::mem::take(&mut recording.undo));
        recording.forgotten.iter().for_each(|&resource| self.tracker.hazards.forget(resource));
        self.tracker.not_zeroed.append(&mut recording.zeroed);
        self.reads.end(&self.gpu, &recording.tickets, recording.number, false);
        self.frames.undo(&self.gpu, &mut self.sets, recording);
    }

    /// Reads the times of recordings that have run.
    pub(crate) fn time(&mut self) {
        for recording in self.frames.in_flight() {
            if recording.has_run(&self.gpu) {
                self.timer.finish(&self.gpu, recording);
            }
        }
    }

    /// Destroys something once everything that was recorded so far is over.
    pub(crate) fn throw_away(&mut self, garbage: Garbage) {
        self.frames.throw_away(&self.gpu, &mut self.sets, garbage);
    }

    /// Throws away what was destroyed and what no list can name any more.
    pub(crate) fn sweep(&mut self) {
        let swept = self.catalog.sweep();
        if swept.is_empty() {
            return;
        }
        let mut resources: HashSet<Resource> = HashSet::new();
        let mut pipelines: HashSet<PipelineId> = HashSet::new();
        let mut garbage = Vec::with_capacity(swept.len());
        for each in swept {
            garbage.push(match each {
                Unlisted::Buffer(id, buffer) => {
                    resources.insert(id.into());
                    Garbage::Buffer(buffer)
                }
                Unlisted::Texture(id, texture) => {
                    resources.insert(id.into());
                    Garbage::Texture(texture)
                }
                Unlisted::Pipeline(id, pipeline) => {
                    pipelines.insert(id);
                    Garbage::Pipeline(pipeline)
                }
            });
        }
        let sets = self.sets.forget(|pipeline, bindings| {
            pipelines.contains(&pipeline) || bindings.resources().any(|resource| resources.contains(&resource))
        });
        self.frames.forget(&resources);
        self.tracker.not_zeroed.retain(|resource| !resources.contains(resource));
        resources.into_iter().for_each(|resource| self.tracker.hazards.forget(resource));
        sets.into_iter().map(Garbage::Set).chain(garbage).for_each(|garbage| self.throw_away(garbage));
    }
}
