//! A small engine on raw Vulkan: an opaque pass into light and depth, and a last pass that develops the light; two frames in
//! flight, each with a command buffer, a fence, and what it tells its shaders.

use anyhow::Result;
use tressfx_backend_vulkan::ash::vk;
use tressfx_backend_vulkan::gpu_allocator::MemoryLocation;
use tressfx_core::shader::ShaderSource;
use tressfx_examples::{Shade, Stage};

use crate::gpu::Gpu;
use crate::memory::{Buffer, Image, whole};
use crate::pipeline::{Pipeline, PipelineDesc};

const LIGHT: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
const DEPTH: vk::Format = vk::Format::D32_SFLOAT;
const PICTURE: vk::Format = vk::Format::R8G8B8A8_SRGB;
const IN_FLIGHT: usize = 2;

/// Everything that the engine has; it does not know of hair.
pub(crate) struct Engine {
    pub(crate) gpu: Gpu,
    /// Linear light: drawn to by the engine and by the hair, then sampled.
    pub(crate) light: Image,
    /// Drawn to by the engine, sampled by the hair.
    pub(crate) depth: Image,
    picture: Image,
    size: [u32; 2],
    stage: Pipeline,
    develop: Pipeline,
    sets: vk::DescriptorPool,
    light_set: vk::DescriptorSet,
    vertices: Buffer,
    indices: Buffer,
    index_count: u32,
    frames: Vec<Frame>,
    /// Frames that were begun.
    begun: usize,
    /// The mark of the newest frame that has left the GPU.
    finished: u64,
}

/// What a frame needs until the GPU has finished with it.
struct Frame {
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    shade: Buffer,
    shade_set: vk::DescriptorSet,
    /// What it was submitted with.
    mark: u64,
}

/// A use of an image: what a barrier has to know of it.
type Use = (vk::PipelineStageFlags2, vk::AccessFlags2, vk::ImageLayout);

const DRAWN: Use = (
    vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT,
    vk::AccessFlags2::COLOR_ATTACHMENT_WRITE,
    vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
);
const DEPTH_TESTED: Use = (
    vk::PipelineStageFlags2::from_raw(
        vk::PipelineStageFlags2::EARLY_FRAGMENT_TESTS.as_raw() | vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS.as_raw(),
    ),
    vk::AccessFlags2::from_raw(
        vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
            | vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
    ),
    vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
);
const SAMPLED: Use = (
    vk::PipelineStageFlags2::FRAGMENT_SHADER,
    vk::AccessFlags2::SHADER_SAMPLED_READ,
    vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
);
const COPIED: Use =
    (vk::PipelineStageFlags2::ALL_TRANSFER, vk::AccessFlags2::TRANSFER_READ, vk::ImageLayout::TRANSFER_SRC_OPTIMAL);

impl Engine {
    pub(crate) fn new(gpu: Gpu, stage: &Stage) -> Result<Self> {
        use vk::{BufferUsageFlags as B, ImageUsageFlags as I};
        let size = stage.view.size();
        // What the hair asks for: it draws to the light and samples the depth.
        let light = gpu.image(size, LIGHT, I::COLOR_ATTACHMENT | I::SAMPLED)?;
        let depth = gpu.image(size, DEPTH, I::DEPTH_STENCIL_ATTACHMENT | I::SAMPLED)?;
        let picture = gpu.image(size, PICTURE, I::COLOR_ATTACHMENT | I::TRANSFER_SRC)?;
        let vertices = gpu.filled(bytemuck::cast_slice(&stage.vertices), B::VERTEX_BUFFER)?;
        let indices = gpu.filled(bytemuck::cast_slice(&stage.indices), B::INDEX_BUFFER)?;
        let source = |label, text| ShaderSource { label, root: (label, text), library: &[] };
        let mesh_desc = PipelineDesc {
            source: source("stage", include_str!("../shaders/stage.wgsl")),
            binding: vk::DescriptorType::UNIFORM_BUFFER,
            target: LIGHT,
            meshes: true,
        };
        let develop_desc = PipelineDesc {
            source: source("develop", include_str!("../shaders/develop.wgsl")),
            binding: vk::DescriptorType::SAMPLED_IMAGE,
            target: PICTURE,
            meshes: false,
        };
        let (mesh_pipeline, develop) = (gpu.pipeline(&mesh_desc)?, gpu.pipeline(&develop_desc)?);
        let sets = gpu.set_pool()?;
        let light_set = gpu.set(sets, &develop)?;
        gpu.bind_image(light_set, light.view);
        let frames = (0..IN_FLIGHT).map(|_| Frame::new(&gpu, sets, &mesh_pipeline)).collect::<Result<_>>()?;
        let index_count = stage.indices.len() as u32;
        let stage = mesh_pipeline;
        let (begun, finished) = (0, 0);
        Ok(Self {
            gpu,
            light,
            depth,
            picture,
            size,
            stage,
            develop,
            sets,
            light_set,
            vertices,
            indices,
            index_count,
            frames,
            begun,
            finished,
        })
    }

    /// Begins a frame, once the one before the last has left the GPU.
    pub(crate) fn begin(&mut self, shade: &Shade) -> Result<vk::CommandBuffer> {
        self.begun += 1;
        let frame = &mut self.frames[self.begun % IN_FLIGHT];
        let once = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        let device = &self.gpu.device;
        // SAFETY: all is of this device; after the wait the GPU has finished with what the frame owns.
        unsafe {
            device.wait_for_fences(&[frame.fence], true, u64::MAX)?;
            device.reset_fences(&[frame.fence])?;
            device.reset_command_pool(frame.pool, vk::CommandPoolResetFlags::empty())?;
            device.begin_command_buffer(frame.commands, &once)?;
        }
        self.finished = self.finished.max(frame.mark);
        frame.shade.write(bytemuck::bytes_of(shade))?;
        Ok(frame.commands)
    }

    /// Clears the targets and draws what is not hair. The light is left drawn, as the hair was promised to find it.
    pub(crate) fn draw_stage(&self, commands: vk::CommandBuffer) {
        // What the last frame left in them is not needed, but it must be over: it sampled the light, and the hair gave the
        // depth back as a depth target.
        self.barrier(commands, &self.light, LIGHT, SAMPLED, DRAWN, false);
        self.barrier(commands, &self.depth, DEPTH, DEPTH_TESTED, DEPTH_TESTED, false);
        let dusk = vk::ClearValue { color: vk::ClearColorValue { float32: [0.10, 0.115, 0.14, 1.0] } };
        let colors = [attachment(&self.light, DRAWN.2, dusk)];
        // The view has its far plane at 0, and the hair reads this depth after the pass.
        let depth = attachment(&self.depth, DEPTH_TESTED.2, vk::ClearValue::default());
        let info = vk::RenderingInfo::default().color_attachments(&colors).depth_attachment(&depth);
        let set = self.frames[self.begun % IN_FLIGHT].shade_set;
        let device = &self.gpu.device;
        // SAFETY: the command buffer is being recorded, and all that is bound is alive until it has run.
        unsafe {
            self.begin_pass(commands, info, &self.stage, set);
            device.cmd_bind_vertex_buffers(commands, 0, &[self.vertices.buffer], &[0]);
            device.cmd_bind_index_buffer(commands, self.indices.buffer, 0, vk::IndexType::UINT32);
            device.cmd_draw_indexed(commands, self.index_count, 1, 0, 0, 0);
            device.cmd_end_rendering(commands);
        }
    }

    /// From light, which the hair has left to be sampled, to a picture.
    pub(crate) fn develop(&self, commands: vk::CommandBuffer) {
        self.barrier(commands, &self.picture, PICTURE, DRAWN, DRAWN, false);
        let colors = [attachment(&self.picture, DRAWN.2, vk::ClearValue::default())];
        let info = vk::RenderingInfo::default().color_attachments(&colors);
        // SAFETY: as above.
        unsafe {
            self.begin_pass(commands, info, &self.develop, self.light_set);
            self.gpu.device.cmd_draw(commands, 3, 1, 0, 0);
            self.gpu.device.cmd_end_rendering(commands);
        }
    }

    /// # Safety
    /// The command buffer is being recorded, outside of a render pass.
    unsafe fn begin_pass(
        &self,
        commands: vk::CommandBuffer,
        info: vk::RenderingInfo,
        pipeline: &Pipeline,
        set: vk::DescriptorSet,
    ) {
        let [width, height] = self.size;
        let area = vk::Rect2D { extent: vk::Extent2D { width, height }, ..Default::default() };
        // Upside down: the view's clip space has y up, and Vulkan's has it down.
        let (width, height) = (width as f32, height as f32);
        let viewport = vk::Viewport { x: 0.0, y: height, width, height: -height, min_depth: 0.0, max_depth: 1.0 };
        let (device, point) = (&self.gpu.device, vk::PipelineBindPoint::GRAPHICS);
        // SAFETY: as promised.
        unsafe {
            device.cmd_begin_rendering(commands, &info.render_area(area).layer_count(1));
            device.cmd_set_viewport(commands, 0, &[viewport]);
            device.cmd_set_scissor(commands, 0, &[area]);
            device.cmd_bind_pipeline(commands, point, pipeline.pipeline);
            device.cmd_bind_descriptor_sets(commands, point, pipeline.layout, 0, &[set], &[]);
        }
    }

    fn barrier(&self, commands: vk::CommandBuffer, image: &Image, format: vk::Format, from: Use, to: Use, keep: bool) {
        let barrier = [vk::ImageMemoryBarrier2::default()
            .src_stage_mask(from.0)
            .src_access_mask(from.1)
            .old_layout(if keep { from.2 } else { vk::ImageLayout::UNDEFINED })
            .dst_stage_mask(to.0)
            .dst_access_mask(to.1)
            .new_layout(to.2)
            .image(image.image)
            .subresource_range(whole(format))];
        let info = vk::DependencyInfo::default().image_memory_barriers(&barrier);
        // SAFETY: the command buffer is being recorded, outside of a render pass.
        unsafe { self.gpu.device.cmd_pipeline_barrier2(commands, &info) };
    }

    /// The mark of the newest frame that has left the GPU; 0 before the first.
    pub(crate) fn finished(&self) -> u64 {
        self.finished
    }

    /// Submits a frame. `mark` is what [`Engine::finished`] says once it is over.
    pub(crate) fn submit(&mut self, commands: vk::CommandBuffer, mark: u64) -> Result<()> {
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(commands)];
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&buffers)];
        let frame = &mut self.frames[self.begun % IN_FLIGHT];
        frame.mark = mark;
        // SAFETY: the command buffer was begun, and the fence was reset.
        unsafe {
            self.gpu.device.end_command_buffer(commands)?;
            self.gpu.device.queue_submit2(self.gpu.queue, &submit, frame.fence)?;
        }
        Ok(())
    }

    /// The picture of the newest frame, rows tightly packed.
    pub(crate) fn read_picture(&mut self) -> Result<Vec<u8>> {
        let [width, height] = self.size;
        let bytes = 4 * u64::from(width) * u64::from(height);
        let copy = self.gpu.buffer(bytes, vk::BufferUsageFlags::TRANSFER_DST, MemoryLocation::GpuToCpu)?;
        let commands = self.begin(&bytemuck::Zeroable::zeroed())?;
        self.barrier(commands, &self.picture, PICTURE, DRAWN, COPIED, true);
        let region = vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                layer_count: 1,
                ..Default::default()
            })
            .image_extent(vk::Extent3D { width, height, depth: 1 });
        let written = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::ALL_TRANSFER)
            .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::HOST)
            .dst_access_mask(vk::AccessFlags2::HOST_READ)];
        let info = vk::DependencyInfo::default().memory_barriers(&written);
        let device = &self.gpu.device;
        // SAFETY: the barrier has put the image into that layout, and the buffer is large enough.
        unsafe {
            device.cmd_copy_image_to_buffer(commands, self.picture.image, COPIED.2, copy.buffer, &[region]);
            device.cmd_pipeline_barrier2(commands, &info);
        }
        self.submit(commands, self.finished)?;
        // SAFETY: this thread alone uses the queue.
        unsafe { self.gpu.device.device_wait_idle() }?;
        let picture = copy.read(bytes as usize)?;
        self.gpu.destroy_buffer(copy)?;
        Ok(picture)
    }

    /// Frees everything and says what the validation layer had to say.
    pub(crate) fn destroy(self) -> Result<Vec<String>> {
        let gpu = self.gpu;
        // SAFETY: this thread alone uses the queue; then the GPU has finished with everything.
        unsafe { gpu.device.device_wait_idle() }?;
        for frame in self.frames {
            // SAFETY: as above.
            unsafe {
                gpu.device.destroy_fence(frame.fence, None);
                gpu.device.destroy_command_pool(frame.pool, None);
            }
            gpu.destroy_buffer(frame.shade)?;
        }
        // SAFETY: as above.
        unsafe { gpu.device.destroy_descriptor_pool(self.sets, None) };
        [self.stage, self.develop].iter().for_each(|pipeline| gpu.destroy_pipeline(pipeline));
        [self.vertices, self.indices].into_iter().try_for_each(|buffer| gpu.destroy_buffer(buffer))?;
        [self.light, self.depth, self.picture].into_iter().try_for_each(|image| gpu.destroy_image(image))?;
        Ok(gpu.destroy())
    }
}

impl Frame {
    fn new(gpu: &Gpu, sets: vk::DescriptorPool, stage: &Pipeline) -> Result<Self> {
        let shade = size_of::<Shade>() as u64;
        let shade = gpu.buffer(shade, vk::BufferUsageFlags::UNIFORM_BUFFER, MemoryLocation::CpuToGpu)?;
        let shade_set = gpu.set(sets, stage)?;
        gpu.bind_buffer(shade_set, shade.buffer);
        let signaled = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        let family = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.queue_family);
        // SAFETY: the device is alive.
        unsafe {
            let pool = gpu.device.create_command_pool(&family, None)?;
            let one = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = gpu.device.allocate_command_buffers(&one)?[0];
            let fence = gpu.device.create_fence(&signaled, None)?;
            Ok(Self { pool, commands, fence, shade, shade_set, mark: 0 })
        }
    }
}

fn attachment(image: &Image, layout: vk::ImageLayout, clear: vk::ClearValue) -> vk::RenderingAttachmentInfo<'static> {
    vk::RenderingAttachmentInfo::default()
        .image_view(image.view)
        .image_layout(layout)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .clear_value(clear)
}
