//! Translates the commands of a list into commands of a Vulkan command buffer.

use ash::vk;
use gpu_allocator::MemoryLocation;
use tressfx_core::backend::{Record, Timing};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::hazards::{Access, accesses};
use tressfx_core::id::{Resource, TextureId};
use tressfx_core::pass::{Command, PassList};

use crate::device::Gpu;
use crate::frames::Recording;
use crate::reads::Copy;
use crate::sets::Sets;
use crate::tables::whole;
use crate::timer::Timer;
use crate::tracker::Tracker;
use crate::{Resources, VulkanBackend};

/// A command buffer of the engine that lists can be recorded into.
#[derive(Debug)]
pub struct EngineCommands {
    buffer: vk::CommandBuffer,
    device: vk::Device,
    family: u32,
}

impl EngineCommands {
    /// Wraps a command buffer. Only `backend` may record into the result.
    ///
    /// # Safety
    /// * It is a primary command buffer of the backend's device and queue family, and until this value is dropped it is being
    ///   recorded, outside of a render pass, and by one thread at a time.
    /// * It is submitted to the backend's queue once: after everything that was recorded before it, before everything that is
    ///   recorded after it, and before the backend [runs](tressfx_core::backend::Run::run) a list by itself. Or it is never
    ///   submitted, and the backend is told so by [`VulkanBackend::mark_discarded_after`] before it records the next list
    ///   into another command buffer, or runs one.
    pub unsafe fn new(backend: &VulkanBackend, buffer: vk::CommandBuffer) -> Self {
        Self { buffer, device: backend.gpu.device.handle(), family: backend.gpu.queue_family }
    }

    /// The command buffer.
    pub fn raw(&self) -> vk::CommandBuffer {
        self.buffer
    }
}

impl Record for VulkanBackend {
    type Encoder = EngineCommands;

    fn record(&mut self, encoder: &mut EngineCommands, list: &PassList) -> Result<()> {
        if (encoder.device, encoder.family) != (self.gpu.device.handle(), self.gpu.queue_family) {
            return Err(Error::rule("record", "the command buffer is of another device or another family of queues"));
        }
        self.sweep();
        self.catalog.check(list)?;
        self.gpu.check_lost()?;
        self.time();
        let mut recording = self.frames.begin(&self.gpu)?;
        let copies = match self.prepare(list, &mut recording) {
            Ok(copies) => copies,
            Err(error) => {
                self.frames.reuse(&self.gpu, &mut self.sets, recording);
                return Err(error);
            }
        };
        let Self { catalog, sets, timer, tracker, gpu, .. } = self;
        let (commands, resources) = (encoder.buffer, &*catalog);
        Recorder { gpu, resources, sets, timer, tracker, commands, recording: &mut recording }.list(list, &copies);
        recording.undo = self.tracker.hazards.end_recording();
        recording.tickets.extend(copies.iter().map(|copy| copy.ticket));
        let number = recording.number;
        self.frames.add(recording);
        for copy in copies {
            if let Some(unread) = self.reads.add(copy, number) {
                self.throw_away(crate::frames::Garbage::Host(unread));
            }
        }
        Ok(())
    }
}

impl VulkanBackend {
    /// Does everything that can fail, before a command is written: makes descriptor sets and queries, copies the bytes of
    /// uploads, and allocates memory for read-backs. Returns the read-backs in the order of their commands.
    fn prepare(&mut self, list: &PassList, recording: &mut Recording) -> Result<Vec<Copy>> {
        let Self { catalog, sets, timer, gpu, .. } = self;
        for command in list.commands() {
            match command {
                Command::Compute(pass) => {
                    let kernel = (pass.kernel.pipeline, &*pass.kernel.shader);
                    sets.prepare(gpu, catalog, kernel, &pass.bindings)?;
                }
                Command::Raster(pass) => pass.draws.iter().try_for_each(|draw| {
                    sets.prepare(gpu, catalog, (draw.pipeline.pipeline, &*draw.pipeline.shader), &draw.bindings)
                })?,
                _ => {}
            }
        }
        timer.prepare(gpu, &mut recording.queries, list.passes().count())?;
        prepare_uploads(gpu, list.bytes(), recording)?;
        let mut copies = Vec::new();
        for command in list.commands() {
            match allocate_read_back(gpu, catalog, command) {
                None => {}
                Some(Ok(copy)) => copies.push(copy),
                Some(Err(error)) => {
                    copies.into_iter().for_each(|copy| gpu.free_host(copy.memory));
                    return Err(error);
                }
            }
        }
        Ok(copies)
    }
}

fn prepare_uploads(gpu: &Gpu, data: &[u8], recording: &mut Recording) -> Result<()> {
    let bytes = data.len() as u64;
    if recording.uploads.as_ref().is_none_or(|uploads| uploads.bytes < bytes) && bytes > 0 {
        let room = bytes.next_power_of_two();
        let larger = gpu.host_buffer("hair.uploads", room, MemoryLocation::CpuToGpu)?;
        recording.uploads.replace(larger).into_iter().for_each(|uploads| gpu.free_host(uploads));
    }
    if let Some(memory) = recording.uploads.as_mut().and_then(|uploads| uploads.memory.mapped_slice_mut()) {
        memory[..data.len()].copy_from_slice(data);
    }
    Ok(())
}

/// Allocates memory for the bytes that a command reads back; `None` for other commands.
fn allocate_read_back(gpu: &Gpu, resources: &Resources, command: &Command) -> Option<Result<Copy>> {
    let (ticket, bytes) = match *command {
        Command::ReadBuffer { bytes, ticket, .. } => (ticket, bytes),
        Command::ReadTexture { src, ticket } => (ticket, resources.bytes(src.into())),
        _ => return None,
    };
    let memory = gpu.host_buffer("hair.read_back", bytes.max(4), MemoryLocation::GpuToCpu);
    Some(memory.map(|memory| Copy { ticket, memory, bytes }))
}

/// Writes the commands of one list. This cannot fail: the list was checked, and `prepare` has made what it needs.
pub(crate) struct Recorder<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) resources: &'a Resources,
    pub(crate) sets: &'a Sets,
    timer: &'a Timer,
    tracker: &'a mut Tracker,
    pub(crate) commands: vk::CommandBuffer,
    recording: &'a mut Recording,
}

impl Recorder<'_> {
    fn list(&mut self, list: &PassList, copies: &[Copy]) {
        self.timer.begin(self.gpu, self.commands, &self.recording.queries, list.passes().count());
        self.zero();
        let mut left = copies.iter();
        list.commands().iter().for_each(|command| self.command(command, &mut left));
        self.tracker.give_back(self.gpu, self.resources, self.commands);
        if !copies.is_empty() {
            let copied = (vk::PipelineStageFlags2::ALL_TRANSFER, vk::AccessFlags2::TRANSFER_WRITE);
            self.tracker.barrier.buffer(copied, (vk::PipelineStageFlags2::HOST, vk::AccessFlags2::HOST_READ));
            self.tracker.write(self.gpu, self.commands);
        }
        self.recording.end(self.gpu, self.commands);
    }

    /// `copies` are the read-backs of this command and of those after it.
    fn command<'c>(&mut self, command: &Command, copies: &mut impl Iterator<Item = &'c Copy>) {
        if does_nothing(command) {
            return;
        }
        let accesses = accesses(command);
        accesses.iter().for_each(|&(resource, access)| self.tracker.wait_for(self.resources, resource, access));
        self.tracker.write(self.gpu, self.commands);
        let resources = self.resources;
        match command {
            Command::Upload { dst, offset, data } => {
                let Some(uploads) = &self.recording.uploads else { return };
                let (src_offset, size) = (data.start as u64, data.len() as u64);
                let region = vk::BufferCopy { src_offset, dst_offset: *offset, size };
                self.copy(uploads.buffer, resources.buffer(*dst).buffer, region);
            }
            Command::Clear { dst, offset, bytes } => {
                let dst = resources.buffer(*dst).buffer;
                // SAFETY: the command buffer is being recorded, and the buffer lives until it has run.
                unsafe { self.gpu.device.cmd_fill_buffer(self.commands, dst, *offset, *bytes, 0) };
            }
            Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                let region = vk::BufferCopy { src_offset: *src_offset, dst_offset: *dst_offset, size: *bytes };
                self.copy(resources.buffer(*src).buffer, resources.buffer(*dst).buffer, region);
            }
            Command::CopyToTexture { src, offset, row_bytes, dst } => {
                self.copy_to_texture(resources.buffer(*src).buffer, *offset, *row_bytes, *dst);
            }
            Command::Compute(pass) => self.pass(command, &accesses, |recorder| recorder.compute(pass)),
            Command::Raster(pass) => self.pass(command, &accesses, |recorder| recorder.raster(pass)),
            Command::ReadBuffer { src, offset, bytes, .. } => {
                let Some(copy) = copies.next() else { return };
                let region = vk::BufferCopy { src_offset: *offset, dst_offset: 0, size: *bytes };
                if *bytes > 0 {
                    self.copy(resources.buffer(*src).buffer, copy.memory.buffer, region);
                }
            }
            Command::ReadTexture { src, .. } => {
                let Some(copy) = copies.next() else { return };
                self.copy_from_texture(*src, copy.memory.buffer);
            }
            // `Command` is non-exhaustive, so the compiler asks for this arm. There are no other commands.
            _ => {}
        }
    }

    fn copy(&self, src: vk::Buffer, dst: vk::Buffer, region: vk::BufferCopy) {
        // SAFETY: the command buffer is being recorded, and both buffers live until it has run.
        unsafe { self.gpu.device.cmd_copy_buffer(self.commands, src, dst, &[region]) };
    }

    fn copy_to_texture(&self, src: vk::Buffer, offset: u64, row_bytes: u32, dst: TextureId) {
        let format = self.resources.texture(dst).format;
        let region = [self.region(dst).buffer_offset(offset).buffer_row_length(row_bytes / format.bytes())];
        let (image, layout) = (self.resources.texture(dst).image, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        // SAFETY: as above; the barrier before it has put the texture into this layout.
        unsafe { self.gpu.device.cmd_copy_buffer_to_image(self.commands, src, image, layout, &region) };
    }

    fn copy_from_texture(&self, src: TextureId, dst: vk::Buffer) {
        let (image, layout) = (self.resources.texture(src).image, vk::ImageLayout::TRANSFER_SRC_OPTIMAL);
        let region = [self.region(src)];
        // SAFETY: as above.
        unsafe { self.gpu.device.cmd_copy_image_to_buffer(self.commands, image, layout, dst, &region) };
    }

    /// All of a texture, rows without padding.
    fn region(&self, id: TextureId) -> vk::BufferImageCopy {
        let texture = self.resources.texture(id);
        let aspect_mask = whole(texture.format).aspect_mask;
        let layers = vk::ImageSubresourceLayers { aspect_mask, layer_count: 1, ..Default::default() };
        let [width, height] = texture.size;
        vk::BufferImageCopy::default().image_subresource(layers).image_extent(vk::Extent3D { width, height, depth: 1 })
    }

    /// Fills everything that was made since the last recording with zeros.
    fn zero(&mut self) {
        self.recording.zeroed.append(&mut self.tracker.not_zeroed);
        for &resource in &self.recording.zeroed {
            self.tracker.wait_for(self.resources, resource, Access::COPY_WRITE);
        }
        self.tracker.write(self.gpu, self.commands);
        for &resource in &self.recording.zeroed {
            match resource {
                Resource::Buffer(id) => {
                    let buffer = self.resources.buffer(id).buffer;
                    // SAFETY: as above.
                    unsafe { self.gpu.device.cmd_fill_buffer(self.commands, buffer, 0, vk::WHOLE_SIZE, 0) };
                }
                Resource::Texture(id) => self.zero_texture(id),
            }
        }
    }

    fn zero_texture(&self, id: TextureId) {
        let texture = self.resources.texture(id);
        let (layout, range) = (vk::ImageLayout::TRANSFER_DST_OPTIMAL, [whole(texture.format)]);
        let (color, depth) = (vk::ClearColorValue::default(), vk::ClearDepthStencilValue::default());
        let device = &self.gpu.device;
        // SAFETY: as above; the barrier before it has put the texture into this layout.
        unsafe {
            if texture.format.is_depth() {
                device.cmd_clear_depth_stencil_image(self.commands, texture.image, layout, &depth, &range);
            } else {
                device.cmd_clear_color_image(self.commands, texture.image, layout, &color, &range);
            }
        }
    }

    /// Writes a pass with its debug label and its timestamps.
    fn pass(&mut self, command: &Command, accesses: &[(Resource, Access)], write: impl FnOnce(&Self)) {
        let (label, scope): (Label, _) = (command.name(), command.scope());
        self.gpu.begin_label(self.commands, label, scope.map(|scope| &**scope));
        let bytes = accesses.iter().map(|&(resource, _)| self.resources.bytes(resource)).sum();
        let timing = Timing::new(label, scope.cloned(), bytes);
        self.timer.begin_pass(self.gpu, self.commands, &mut self.recording.queries, timing);
        write(self);
        self.timer.end_pass(self.gpu, self.commands, &self.recording.queries);
        self.gpu.end_label(self.commands);
    }
}

/// Whether a command has no bytes to move: Vulkan does not allow copies of 0 bytes.
fn does_nothing(command: &Command) -> bool {
    match command {
        Command::Upload { data, .. } => data.is_empty(),
        Command::Clear { bytes, .. } | Command::Copy { bytes, .. } => *bytes == 0,
        _ => false,
    }
}
