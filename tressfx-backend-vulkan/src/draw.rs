//! Compute and raster passes.

use ash::vk;
use tressfx_core::id::TextureId;
use tressfx_core::pass::{ComputePass, Count, Draw, Grid, Groups, Load, RasterPass, Viewport};

use crate::record::Recorder;

impl Recorder<'_> {
    pub(crate) fn compute(&self, pass: &ComputePass) {
        let pipeline = self.resources.pipeline(pass.kernel.pipeline);
        let sets = [self.sets.get(pass.kernel.pipeline, &pass.bindings)];
        let (device, commands) = (&self.gpu.device, self.commands);
        // SAFETY: the command buffer is being recorded, outside of a render pass; pipeline, set and arguments are alive.
        unsafe {
            device.cmd_bind_pipeline(commands, pipeline.point, pipeline.pipeline);
            device.cmd_bind_descriptor_sets(commands, pipeline.point, pipeline.layout, 0, &sets, &[]);
            match pass.groups {
                Groups::Grid(Grid([x, y, z])) => device.cmd_dispatch(commands, x, y, z),
                Groups::Indirect { buffer, offset } => {
                    device.cmd_dispatch_indirect(commands, self.resources.buffer(buffer).buffer, offset);
                }
            }
        }
    }

    pub(crate) fn raster(&self, pass: &RasterPass) {
        let colors: Vec<_> = pass.colors.iter().map(|&(id, load)| self.color(id, load)).collect();
        let depth = pass.depth.map(|(id, load)| self.depth(id, load));
        let targets = pass.colors.iter().map(|(id, _)| id).chain(pass.depth.iter().map(|(id, _)| id));
        let size = targets.map(|&id| self.resources.texture(id).size).next().unwrap_or([1, 1]);
        let whole = Viewport { origin: [0, 0], size };
        let mut info = vk::RenderingInfo::default().render_area(area(whole)).layer_count(1).color_attachments(&colors);
        if let Some(depth) = &depth {
            info = info.depth_attachment(depth);
        }
        let drawn = pass.viewport.unwrap_or(whole);
        let (device, commands) = (&self.gpu.device, self.commands);
        // SAFETY: the command buffer is being recorded, outside of a render pass; all targets are alive and in the layout
        // that the barrier has put them into.
        unsafe {
            device.cmd_begin_rendering(commands, &info);
            device.cmd_set_viewport(commands, 0, &[viewport(drawn)]);
            device.cmd_set_scissor(commands, 0, &[area(drawn)]);
        }
        pass.draws.iter().for_each(|draw| self.draw(draw));
        // SAFETY: it was begun above.
        unsafe { device.cmd_end_rendering(commands) };
    }

    fn draw(&self, draw: &Draw) {
        let pipeline = self.resources.pipeline(draw.pipeline.pipeline);
        let sets = [self.sets.get(draw.pipeline.pipeline, &draw.bindings)];
        let (device, commands) = (&self.gpu.device, self.commands);
        // SAFETY: inside of the render pass; pipeline, set and arguments are alive.
        unsafe {
            device.cmd_bind_pipeline(commands, pipeline.point, pipeline.pipeline);
            device.cmd_bind_descriptor_sets(commands, pipeline.point, pipeline.layout, 0, &sets, &[]);
            match draw.count {
                Count::Direct { vertices, instances } => device.cmd_draw(commands, vertices, instances, 0, 0),
                Count::Indirect { buffer, offset } => {
                    let buffer = self.resources.buffer(buffer).buffer;
                    device.cmd_draw_indirect(commands, buffer, offset, 1, 0);
                }
            }
        }
    }

    fn color(&self, id: TextureId, load: Load<[f32; 4]>) -> vk::RenderingAttachmentInfo<'static> {
        let is_uint = self.resources.texture(id).format.is_uint();
        let value = |color: [f32; 4]| vk::ClearValue {
            color: match is_uint {
                true => vk::ClearColorValue { uint32: color.map(|channel| channel as u32) },
                false => vk::ClearColorValue { float32: color },
            },
        };
        self.attachment(id, load, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, value)
    }

    fn depth(&self, id: TextureId, load: Load<f32>) -> vk::RenderingAttachmentInfo<'static> {
        let value =
            |depth| vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth, ..Default::default() } };
        self.attachment(id, load, vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL, value)
    }

    fn attachment<T: Copy>(
        &self,
        id: TextureId,
        load: Load<T>,
        layout: vk::ImageLayout,
        value: impl Fn(T) -> vk::ClearValue,
    ) -> vk::RenderingAttachmentInfo<'static> {
        let info = vk::RenderingAttachmentInfo::default()
            .image_view(self.resources.texture(id).view)
            .image_layout(layout)
            .store_op(vk::AttachmentStoreOp::STORE);
        match load {
            Load::Keep => info.load_op(vk::AttachmentLoadOp::LOAD),
            Load::Clear(color) => info.load_op(vk::AttachmentLoadOp::CLEAR).clear_value(value(color)),
        }
    }
}

fn area(Viewport { origin: [x, y], size: [width, height] }: Viewport) -> vk::Rect2D {
    let offset = vk::Offset2D { x: x as i32, y: y as i32 };
    vk::Rect2D { offset, extent: vk::Extent2D { width, height } }
}

/// Upside down, since y points up in the clip space of WGSL and down in Vulkan's.
fn viewport(Viewport { origin, size }: Viewport) -> vk::Viewport {
    let [x, y, width, height] = [origin[0], origin[1], size[0], size[1]].map(|pixels| pixels as f32);
    vk::Viewport { x, y: y + height, width, height: -height, min_depth: 0.0, max_depth: 1.0 }
}
