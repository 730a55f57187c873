//! Bytes that come back from the GPU.

use std::collections::HashMap;

use tressfx_core::backend::ReadBack;
use tressfx_core::pass::Ticket;

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::frames::Garbage;
use crate::memory::HostBuffer;

/// A copy on its way to the CPU.
#[derive(Debug)]
pub(crate) struct Copy {
    pub(crate) ticket: Ticket,
    pub(crate) memory: HostBuffer,
    /// How many bytes were asked for.
    pub(crate) bytes: u64,
}

impl Copy {
    fn bytes(&self) -> Option<Vec<u8>> {
        Some(self.memory.memory.mapped_slice()?.get(..self.bytes as usize)?.to_vec())
    }
}

/// What has become of a read-back.
#[derive(Debug)]
enum Read {
    /// A recording makes it, whose command buffer is not known to be over.
    Recorded(Copy, u64),
    /// The bytes are there.
    Done(Copy),
    Failed,
}

/// All read-backs that nobody has asked for yet.
#[derive(Debug, Default)]
pub(crate) struct Reads {
    all: HashMap<Ticket, Read>,
}

impl Reads {
    /// A recording makes a copy. What it takes the place of is given back: a list that is recorded again brings its bytes
    /// again, whether anybody asked for the first or not.
    pub(crate) fn add(&mut self, copy: Copy, recording: u64) -> Option<HostBuffer> {
        match self.all.insert(copy.ticket, Read::Recorded(copy, recording)) {
            Some(Read::Recorded(copy, _) | Read::Done(copy)) => Some(copy.memory),
            Some(Read::Failed) | None => None,
        }
    }

    /// The command buffer of a recording is over; `has_run`: because the GPU has finished with it.
    pub(crate) fn end(&mut self, gpu: &Gpu, tickets: &[Ticket], recording: u64, has_run: bool) {
        for ticket in tickets {
            let Some(read) = self.all.get_mut(ticket) else { continue };
            match std::mem::replace(read, Read::Failed) {
                Read::Recorded(copy, number) if number == recording => match has_run {
                    true => *read = Read::Done(copy),
                    false => gpu.free_host(copy.memory),
                },
                // It was recorded again since.
                other => *read = other,
            }
        }
    }

    pub(crate) fn destroy(&mut self, gpu: &Gpu) {
        for (_, read) in self.all.drain() {
            match read {
                Read::Recorded(copy, _) | Read::Done(copy) => gpu.free_host(copy.memory),
                Read::Failed => {}
            }
        }
    }
}

impl VulkanBackend {
    pub(crate) fn take_read(&mut self, ticket: Ticket) -> ReadBack {
        let recording = match self.reads.all.get(&ticket) {
            None => return ReadBack::Unknown,
            Some(&Read::Recorded(_, number)) => Some(number),
            Some(_) => None,
        };
        let has_run = recording.is_none_or(|number| self.frames.has_run(&self.gpu, number));
        if !has_run && !self.gpu.is_lost() {
            return ReadBack::Pending;
        }
        let bytes = match self.reads.all.remove(&ticket) {
            Some(Read::Recorded(copy, _)) => {
                let bytes = if has_run { copy.bytes() } else { None };
                self.throw_away(Garbage::Host(copy.memory));
                bytes
            }
            Some(Read::Done(copy)) => {
                let bytes = copy.bytes();
                self.gpu.free_host(copy.memory);
                bytes
            }
            Some(Read::Failed) | None => None,
        };
        bytes.map_or(ReadBack::Failed, ReadBack::Ready)
    }

    pub(crate) fn forget_read(&mut self, ticket: Ticket) {
        match self.reads.all.remove(&ticket) {
            Some(Read::Recorded(copy, _)) => self.throw_away(Garbage::Host(copy.memory)),
            Some(Read::Done(copy)) => self.gpu.free_host(copy.memory),
            Some(Read::Failed) | None => {}
        }
    }
}
