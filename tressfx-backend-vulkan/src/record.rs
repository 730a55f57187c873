//! Commands of a list become commands of a Vulkan command buffer.

use ash::vk;
use gpu_allocator::MemoryLocation;
use tressfx_core::backend::{Record, Timing};
use tressfx_core::check::check;
use tressfx_core::error::{Label, Result};
use tressfx_core::hazards::{Access, accesses};
use tressfx_core::id::{Resource, TextureId};
use tressfx_core::pass::{Command, ComputePass, Grid, Groups, Load, PassList, RasterPass};

use crate::VulkanBackend;
use crate::frame::Recording;
use crate::tables::whole;

impl Record for VulkanBackend {
    type Encoder = vk::CommandBuffer;

    fn record(&mut self, encoder: &mut vk::CommandBuffer, list: &PassList) -> Result<()> {
        check(list);
        self.check_lost()?;
        self.collect();
        let mut recording = self.frames.begin(&self.gpu)?;
        recording.before = self.hazards.clone();
        let recorded =
            self.prepare(list, &mut recording).and_then(|()| self.encode_all(*encoder, list, &mut recording));
        // Even where something failed: what was written so far may run.
        recording.end(&self.gpu, *encoder);
        self.frames.end(recording);
        self.noted(recorded)
    }
}

impl VulkanBackend {
    /// Everything that can fail for want of memory, before anything is written.
    fn prepare(&mut self, list: &PassList, recording: &mut Recording) -> Result<()> {
        for command in &list.commands {
            match command {
                Command::Compute(pass) => self.prepare_set(&pass.kernel, &pass.bindings)?,
                Command::Raster(pass) => {
                    pass.draws.iter().try_for_each(|draw| self.prepare_set(&draw.kernel, &draw.bindings))?;
                }
                _ => {}
            }
        }
        let bytes = list.bytes.len() as u64;
        if recording.uploads.as_ref().is_none_or(|uploads| uploads.bytes < bytes) && bytes > 0 {
            let room = bytes.next_power_of_two();
            let larger = self.gpu.host_buffer("hair.uploads", room, MemoryLocation::CpuToGpu)?;
            recording.uploads.replace(larger).into_iter().for_each(|uploads| self.gpu.free_host(uploads));
        }
        if let Some(memory) = recording.uploads.as_mut().and_then(|uploads| uploads.memory.mapped_slice_mut()) {
            memory[..list.bytes.len()].copy_from_slice(&list.bytes);
        }
        Ok(())
    }

    fn encode_all(&mut self, commands: vk::CommandBuffer, list: &PassList, recording: &mut Recording) -> Result<()> {
        self.timer.begin(&self.gpu, commands, &mut recording.queries, list.passes().count())?;
        self.zero(commands, recording);
        let encoded = list.commands.iter().try_for_each(|command| self.encode(commands, command, recording));
        // Where it failed too: what was written so far may run, and the next list must find nothing borrowed.
        self.give_back(commands);
        if list
            .commands
            .iter()
            .any(|command| matches!(command, Command::ReadBuffer { .. } | Command::ReadTexture { .. }))
        {
            let copied = (vk::PipelineStageFlags2::ALL_TRANSFER, vk::AccessFlags2::TRANSFER_WRITE);
            self.barrier.buffer(copied, (vk::PipelineStageFlags2::HOST, vk::AccessFlags2::HOST_READ));
            self.write_barrier(commands);
        }
        encoded
    }

    fn encode(&mut self, commands: vk::CommandBuffer, command: &Command, recording: &mut Recording) -> Result<()> {
        if does_nothing(command) {
            return Ok(());
        }
        let accesses = accesses(command);
        accesses.iter().for_each(|&(resource, access)| self.wait_for(resource, access));
        self.write_barrier(commands);
        match command {
            Command::Upload { dst, offset, data } => {
                let Some(uploads) = &recording.uploads else { return Ok(()) };
                let (src_offset, size) = (data.start as u64, data.len() as u64);
                let region = vk::BufferCopy { src_offset, dst_offset: *offset, size };
                self.copy(commands, uploads.buffer, self.buffer(*dst, "upload").buffer, region);
            }
            Command::Clear { dst, offset, bytes } => {
                let dst = self.buffer(*dst, "clear").buffer;
                // SAFETY: the command buffer is being recorded, and the buffer lives until it has run.
                unsafe { self.gpu.device.cmd_fill_buffer(commands, dst, *offset, *bytes, 0) };
            }
            Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                let region = vk::BufferCopy { src_offset: *src_offset, dst_offset: *dst_offset, size: *bytes };
                self.copy(commands, self.buffer(*src, "copy").buffer, self.buffer(*dst, "copy").buffer, region);
            }
            Command::Compute(pass) => {
                let label = pass.kernel.label();
                self.begin_pass(commands, label, &accesses, recording);
                self.encode_compute(commands, pass);
                self.end_pass(commands, recording);
            }
            Command::Raster(pass) => {
                self.begin_pass(commands, pass.label, &accesses, recording);
                self.encode_raster(commands, pass);
                self.end_pass(commands, recording);
            }
            Command::ReadBuffer { src, offset, bytes, ticket } => {
                self.encode_read_buffer(commands, (*src, *offset, *bytes), *ticket, recording.number)?;
            }
            Command::ReadTexture { src, ticket } => {
                self.encode_read_texture(commands, *src, *ticket, recording.number)?;
            }
        }
        Ok(())
    }

    fn copy(&self, commands: vk::CommandBuffer, src: vk::Buffer, dst: vk::Buffer, region: vk::BufferCopy) {
        // SAFETY: the command buffer is being recorded, and both buffers live until it has run.
        unsafe { self.gpu.device.cmd_copy_buffer(commands, src, dst, &[region]) };
    }

    /// What was made since the last list begins with zeros.
    fn zero(&mut self, commands: vk::CommandBuffer, recording: &mut Recording) {
        recording.zeroed.append(&mut self.not_zeroed);
        recording.zeroed.iter().for_each(|&resource| self.wait_for(resource, Access::COPY_WRITE));
        self.write_barrier(commands);
        for &resource in &recording.zeroed {
            match resource {
                Resource::Buffer(id) => {
                    let buffer = self.buffer(id, "zero").buffer;
                    // SAFETY: as above.
                    unsafe { self.gpu.device.cmd_fill_buffer(commands, buffer, 0, vk::WHOLE_SIZE, 0) };
                }
                Resource::Texture(id) => self.zero_texture(commands, id),
            }
        }
    }

    fn zero_texture(&self, commands: vk::CommandBuffer, id: TextureId) {
        let texture = self.texture(id, "zero");
        let (layout, range) = (vk::ImageLayout::TRANSFER_DST_OPTIMAL, [whole(texture.format)]);
        let (color, depth) = (vk::ClearColorValue::default(), vk::ClearDepthStencilValue::default());
        let device = &self.gpu.device;
        // SAFETY: as above; the barrier before it has put the texture into this layout.
        unsafe {
            if texture.format.is_depth() {
                device.cmd_clear_depth_stencil_image(commands, texture.image, layout, &depth, &range);
            } else {
                device.cmd_clear_color_image(commands, texture.image, layout, &color, &range);
            }
        }
    }

    fn begin_pass(
        &self,
        commands: vk::CommandBuffer,
        label: Label,
        accesses: &[(Resource, Access)],
        recording: &mut Recording,
    ) {
        self.gpu.begin_label(commands, label);
        let bytes = accesses.iter().map(|&(resource, _)| self.bytes(resource)).sum();
        let pass = Timing { label, begin: 0.0, nanoseconds: 0.0, bytes, invocations: None };
        self.timer.begin_pass(&self.gpu, commands, &mut recording.queries, pass);
    }

    fn end_pass(&self, commands: vk::CommandBuffer, recording: &Recording) {
        self.timer.end_pass(&self.gpu, commands, &recording.queries);
        self.gpu.end_label(commands);
    }

    fn encode_compute(&self, commands: vk::CommandBuffer, pass: &ComputePass) {
        let label = pass.kernel.label();
        let pipeline = self.pipeline(pass.kernel.pipeline, label);
        assert!(pipeline.point == vk::PipelineBindPoint::COMPUTE, "{label}: a raster pipeline in a compute pass");
        let sets = [self.sets.get(&pass.kernel, &pass.bindings)];
        let device = &self.gpu.device;
        // SAFETY: the command buffer is being recorded, outside of a render pass; pipeline, set and arguments are alive.
        unsafe {
            device.cmd_bind_pipeline(commands, pipeline.point, pipeline.pipeline);
            device.cmd_bind_descriptor_sets(commands, pipeline.point, pipeline.layout, 0, &sets, &[]);
            match pass.groups {
                Groups::Grid(Grid([x, y, z])) => device.cmd_dispatch(commands, x, y, z),
                Groups::Indirect { buffer, offset } => {
                    device.cmd_dispatch_indirect(commands, self.buffer(buffer, label).buffer, offset);
                }
            }
        }
    }

    fn encode_raster(&self, commands: vk::CommandBuffer, pass: &RasterPass) {
        let colors: Vec<_> = pass
            .colors
            .iter()
            .map(|&(id, load)| {
                let value = |color| vk::ClearValue { color: vk::ClearColorValue { float32: color } };
                self.attachment(id, pass.label, load, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, value)
            })
            .collect();
        let depth = pass.depth.map(|(id, load)| {
            let value =
                |depth| vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth, ..Default::default() } };
            self.attachment(id, pass.label, load, vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL, value)
        });
        let targets = pass.colors.iter().map(|(id, _)| id).chain(pass.depth.iter().map(|(id, _)| id));
        let [width, height] = targets.map(|&id| self.texture(id, pass.label).size).next().unwrap_or([1, 1]);
        let area = vk::Rect2D { extent: vk::Extent2D { width, height }, ..Default::default() };
        let mut info = vk::RenderingInfo::default().render_area(area).layer_count(1).color_attachments(&colors);
        if let Some(depth) = &depth {
            info = info.depth_attachment(depth);
        }
        // Upside down, since y points up in the clip space of WGSL and down in Vulkan's.
        let (width, height) = (width as f32, height as f32);
        let viewport = vk::Viewport { x: 0.0, y: height, width, height: -height, min_depth: 0.0, max_depth: 1.0 };
        let device = &self.gpu.device;
        // SAFETY: the command buffer is being recorded, outside of a render pass; all targets are alive and in the layout
        // that the barrier has put them into.
        unsafe {
            device.cmd_begin_rendering(commands, &info);
            device.cmd_set_viewport(commands, 0, &[viewport]);
            device.cmd_set_scissor(commands, 0, &[area]);
        }
        for draw in &pass.draws {
            let label = draw.kernel.label();
            let pipeline = self.pipeline(draw.kernel.pipeline, label);
            assert!(pipeline.point == vk::PipelineBindPoint::GRAPHICS, "{label}: a compute pipeline in a raster pass");
            let sets = [self.sets.get(&draw.kernel, &draw.bindings)];
            // SAFETY: inside of the render pass; pipeline and set are alive.
            unsafe {
                device.cmd_bind_pipeline(commands, pipeline.point, pipeline.pipeline);
                device.cmd_bind_descriptor_sets(commands, pipeline.point, pipeline.layout, 0, &sets, &[]);
                device.cmd_draw(commands, draw.vertices, draw.instances, 0, 0);
            }
        }
        // SAFETY: it was begun above.
        unsafe { device.cmd_end_rendering(commands) };
    }

    fn attachment<T: Copy>(
        &self,
        id: TextureId,
        label: Label,
        load: Load<T>,
        layout: vk::ImageLayout,
        value: impl Fn(T) -> vk::ClearValue,
    ) -> vk::RenderingAttachmentInfo<'static> {
        let info = vk::RenderingAttachmentInfo::default()
            .image_view(self.texture(id, label).view)
            .image_layout(layout)
            .store_op(vk::AttachmentStoreOp::STORE);
        match load {
            Load::Keep => info.load_op(vk::AttachmentLoadOp::LOAD),
            Load::Clear(color) => info.load_op(vk::AttachmentLoadOp::CLEAR).clear_value(value(color)),
        }
    }
}

/// Vulkan takes no copies of nothing.
fn does_nothing(command: &Command) -> bool {
    match command {
        Command::Upload { data, .. } => data.is_empty(),
        Command::Clear { bytes, .. } | Command::Copy { bytes, .. } => *bytes == 0,
        _ => false,
    }
}
