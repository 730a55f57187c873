//! Three frames in flight on two queues: one draws, the other copies what was drawn.

use std::rc::Rc;

use anyhow::Result;
use tressfx_backend_vulkan::EngineUse;
use tressfx_backend_vulkan::ash::vk;

use crate::gpu::{Gpu, Queue};
use crate::targets::Images;

const IN_FLIGHT: u64 = 3;

const CLEARED: EngineUse = EngineUse {
    stage: vk::PipelineStageFlags2::ALL_TRANSFER,
    access: vk::AccessFlags2::TRANSFER_WRITE,
    layout: vk::ImageLayout::TRANSFER_DST_OPTIMAL,
};
const COPIED: EngineUse = EngineUse {
    stage: vk::PipelineStageFlags2::ALL_TRANSFER,
    access: vk::AccessFlags2::TRANSFER_READ,
    layout: vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
};

/// A command buffer, its pool and its images.
struct Slot {
    draw: (vk::CommandPool, vk::CommandBuffer),
    copy: (vk::CommandPool, vk::CommandBuffer),
    /// Signalled once the copy is over, and with it the frame.
    fence: vk::Fence,
    /// What the frame was submitted with.
    mark: u64,
    images: Option<Rc<Images>>,
}

/// The frames in flight.
pub(crate) struct Frames {
    slots: Vec<Slot>,
    /// The frame that was drawn last, and copied last: timelines.
    drawn: vk::Semaphore,
    copied: vk::Semaphore,
    /// The frame that was submitted last.
    submitted: u64,
    /// Frames that had to wait for the one that was three before.
    pub(crate) stalls: u64,
}

impl Frames {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self> {
        let slots = (0..IN_FLIGHT).map(|_| Slot::new(gpu)).collect::<Result<_>>()?;
        let timeline = || {
            let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
            let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
            // SAFETY: the device is alive.
            unsafe { gpu.device.create_semaphore(&info, None) }
        };
        Ok(Self { slots, drawn: timeline()?, copied: timeline()?, submitted: 0, stalls: 0 })
    }

    fn slot(&mut self, frame: u64) -> &mut Slot {
        &mut self.slots[(frame % IN_FLIGHT) as usize]
    }

    /// Waits for the frame that was three before: its mark.
    pub(crate) fn wait(&mut self, gpu: &Gpu, frame: u64) -> Result<u64> {
        let slot = self.slot(frame);
        // SAFETY: the fence is alive.
        let is_over = unsafe { gpu.device.get_fence_status(slot.fence) }?;
        // SAFETY: as above.
        unsafe { gpu.device.wait_for_fences(&[slot.fence], true, u64::MAX) }?;
        slot.images = None;
        let mark = slot.mark;
        self.stalls += u64::from(!is_over);
        Ok(mark)
    }

    /// Begins a frame that draws to images, if there are any, and clears them.
    pub(crate) fn begin(&mut self, gpu: &Gpu, frame: u64, images: Option<&Rc<Images>>) -> Result<vk::CommandBuffer> {
        let slot = self.slot(frame);
        slot.images = images.cloned();
        let commands = begin(gpu, slot.draw)?;
        let Some(images) = images else { return Ok(commands) };
        gpu.barrier(commands, images.light, COPIED, CLEARED, false);
        gpu.barrier_of_depth(commands, images.depth, EngineUse::DEPTH_TARGET, CLEARED, false);
        let range = |aspect_mask| {
            [vk::ImageSubresourceRange { aspect_mask, level_count: 1, layer_count: 1, ..Default::default() }]
        };
        let (dusk, far) =
            (vk::ClearColorValue { float32: [0.10, 0.115, 0.14, 1.0] }, vk::ClearDepthStencilValue::default());
        // SAFETY: the command buffer is being recorded, and the barriers have put the images into this layout.
        unsafe {
            let (device, layout) = (&gpu.device, CLEARED.layout);
            device.cmd_clear_color_image(commands, images.light, layout, &dusk, &range(vk::ImageAspectFlags::COLOR));
            device.cmd_clear_depth_stencil_image(
                commands,
                images.depth,
                layout,
                &far,
                &range(vk::ImageAspectFlags::DEPTH),
            );
        }
        gpu.barrier(commands, images.light, CLEARED, EngineUse::COLOR_TARGET, true);
        gpu.barrier_of_depth(commands, images.depth, CLEARED, EngineUse::DEPTH_TARGET, true);
        Ok(commands)
    }

    /// Throws a frame away.
    pub(crate) fn discard(&mut self, gpu: &Gpu, frame: u64) -> Result<()> {
        let slot = self.slot(frame);
        slot.images = None;
        // SAFETY: it was not submitted.
        Ok(unsafe { gpu.device.reset_command_pool(slot.draw.0, vk::CommandPoolResetFlags::empty()) }?)
    }

    /// Submits a frame to both queues. `mark` is what [`Frames::wait`] says once it is over.
    pub(crate) fn submit(&mut self, gpu: &Gpu, frame: u64, mark: u64) -> Result<()> {
        let before = self.submitted;
        self.submitted = frame;
        let (drawn, copied) = (self.drawn, self.copied);
        let slot = self.slot(frame);
        slot.mark = mark;
        let (device, draw) = (&gpu.device, slot.draw.1);
        if let Some(images) = &slot.images {
            gpu.barrier(draw, images.light, EngineUse::COLOR_TARGET, COPIED, true);
        }
        let copy = begin(gpu, slot.copy)?;
        if let Some(images) = &slot.images {
            gpu.copy(copy, images);
        }
        // SAFETY: both command buffers are being recorded, and the fence is of a frame that is over.
        unsafe {
            device.end_command_buffer(draw)?;
            device.end_command_buffer(copy)?;
            device.reset_fences(&[slot.fence])?;
        }
        // What is drawn to was copied before.
        gpu.submit(gpu.frames, draw, [(copied, before), (drawn, frame)], vk::Fence::null())?;
        gpu.submit(gpu.copies, copy, [(drawn, frame), (copied, frame)], slot.fence)
    }

    /// Waits for all frames.
    pub(crate) fn finish(&mut self, gpu: &Gpu) -> Result<()> {
        (0..IN_FLIGHT).try_for_each(|frame| self.wait(gpu, frame).map(drop))
    }

    pub(crate) fn destroy(self, gpu: &Gpu) {
        // SAFETY: all frames are over.
        unsafe {
            for slot in self.slots {
                gpu.device.destroy_fence(slot.fence, None);
                gpu.device.destroy_command_pool(slot.draw.0, None);
                gpu.device.destroy_command_pool(slot.copy.0, None);
            }
            gpu.device.destroy_semaphore(self.drawn, None);
            gpu.device.destroy_semaphore(self.copied, None);
        }
    }
}

impl Slot {
    fn new(gpu: &Gpu) -> Result<Self> {
        let commands = |(_, family): Queue| -> Result<_> {
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(family);
            // SAFETY: the device is alive.
            unsafe {
                let pool = gpu.device.create_command_pool(&info, None)?;
                let one = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
                Ok((pool, gpu.device.allocate_command_buffers(&one)?[0]))
            }
        };
        let signaled = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        // SAFETY: as above.
        let fence = unsafe { gpu.device.create_fence(&signaled, None) }?;
        Ok(Self { draw: commands(gpu.frames)?, copy: commands(gpu.copies)?, fence, mark: 0, images: None })
    }
}

fn begin(gpu: &Gpu, (pool, commands): (vk::CommandPool, vk::CommandBuffer)) -> Result<vk::CommandBuffer> {
    let once = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
    // SAFETY: what it held is over, or was never submitted.
    unsafe {
        gpu.device.reset_command_pool(pool, vk::CommandPoolResetFlags::empty())?;
        gpu.device.begin_command_buffer(commands, &once)?;
    }
    Ok(commands)
}

impl Gpu {
    fn barrier(&self, commands: vk::CommandBuffer, image: vk::Image, from: EngineUse, to: EngineUse, keep: bool) {
        self.barrier_of(commands, (image, vk::ImageAspectFlags::COLOR), from, to, keep);
    }

    fn barrier_of_depth(
        &self,
        commands: vk::CommandBuffer,
        image: vk::Image,
        from: EngineUse,
        to: EngineUse,
        keep: bool,
    ) {
        self.barrier_of(commands, (image, vk::ImageAspectFlags::DEPTH), from, to, keep);
    }

    fn barrier_of(
        &self,
        commands: vk::CommandBuffer,
        (image, aspect_mask): (vk::Image, vk::ImageAspectFlags),
        from: EngineUse,
        to: EngineUse,
        keep: bool,
    ) {
        let barrier = [vk::ImageMemoryBarrier2::default()
            .src_stage_mask(from.stage)
            .src_access_mask(from.access)
            .old_layout(if keep { from.layout } else { vk::ImageLayout::UNDEFINED })
            .dst_stage_mask(to.stage)
            .dst_access_mask(to.access)
            .new_layout(to.layout)
            .image(image)
            .subresource_range(vk::ImageSubresourceRange {
                aspect_mask,
                level_count: 1,
                layer_count: 1,
                ..Default::default()
            })];
        let info = vk::DependencyInfo::default().image_memory_barriers(&barrier);
        // SAFETY: the command buffer is being recorded, outside of a render pass.
        unsafe { self.device.cmd_pipeline_barrier2(commands, &info) };
    }

    /// Copies the light.
    fn copy(&self, commands: vk::CommandBuffer, images: &Images) {
        let aspect_mask = vk::ImageAspectFlags::COLOR;
        let [width, height] = images.size;
        let region = [vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers { aspect_mask, layer_count: 1, ..Default::default() })
            .image_extent(vk::Extent3D { width, height, depth: 1 })];
        // SAFETY: the command buffer is being recorded; the frame has left the light in this layout.
        unsafe {
            self.device.cmd_copy_image_to_buffer(commands, images.light, COPIED.layout, images.copy, &region);
        }
    }

    /// Submits a command buffer that waits for one value and signals another.
    fn submit(
        &self,
        (queue, _): Queue,
        commands: vk::CommandBuffer,
        [wait, signal]: [(vk::Semaphore, u64); 2],
        fence: vk::Fence,
    ) -> Result<()> {
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(commands)];
        let [wait, signal] = [wait, signal].map(|(semaphore, value)| {
            let all = vk::PipelineStageFlags2::ALL_COMMANDS;
            [vk::SemaphoreSubmitInfo::default().semaphore(semaphore).value(value).stage_mask(all)]
        });
        let submit = [vk::SubmitInfo2::default()
            .command_buffer_infos(&commands)
            .wait_semaphore_infos(&wait)
            .signal_semaphore_infos(&signal)];
        // SAFETY: the command buffer was ended, and this thread alone uses the queues.
        Ok(unsafe { self.device.queue_submit2(queue, &submit, fence) }?)
    }
}
