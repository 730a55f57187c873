//! What has to be waited for becomes one `vkCmdPipelineBarrier2`.

use ash::vk;
use tressfx_core::hazards::{Access, Layout};

use crate::device::Gpu;
use crate::resource::Texture;
use crate::tables::{StageAccess, image_layout, scope, whole, writes};
use crate::uses::EngineUse;

/// The barrier before one command. Buffers share one memory barrier; each texture has its own, for its layout.
#[derive(Debug, Default)]
pub(crate) struct Barrier {
    before: StageAccess,
    after: StageAccess,
    images: Vec<vk::ImageMemoryBarrier2<'static>>,
    left_out: bool,
}

impl Barrier {
    /// A buffer is used otherwise.
    pub(crate) fn buffer(&mut self, before: StageAccess, after: StageAccess) {
        self.before = (self.before.0 | before.0, self.before.1 | writes(before.1));
        self.after = (self.after.0 | after.0, self.after.1 | after.1);
    }

    /// A texture is used otherwise; empty `before`: its contents are not needed.
    pub(crate) fn texture(&mut self, texture: &Texture, before: Access, after: Access) {
        let layout = |access| image_layout(Layout::of(access), texture.format);
        let old = if before.is_empty() { vk::ImageLayout::UNDEFINED } else { layout(before) };
        let format = Some(texture.format);
        self.image(texture, (scope(before, format), old), (scope(after, format), layout(after)));
    }

    /// A texture comes from its owner.
    pub(crate) fn acquire(&mut self, texture: &Texture, found: &EngineUse, after: Access) {
        let layout = image_layout(Layout::of(after), texture.format);
        self.image(texture, ((found.stage, found.access), found.layout), (scope(after, Some(texture.format)), layout));
    }

    /// A texture goes back to its owner.
    pub(crate) fn release(&mut self, texture: &Texture, before: Access, left: &EngineUse) {
        let layout = image_layout(Layout::of(before), texture.format);
        self.image(texture, (scope(before, Some(texture.format)), layout), ((left.stage, left.access), left.layout));
    }

    fn image(
        &mut self,
        texture: &Texture,
        before: (StageAccess, vk::ImageLayout),
        after: (StageAccess, vk::ImageLayout),
    ) {
        self.images.push(
            vk::ImageMemoryBarrier2::default()
                .src_stage_mask(before.0.0)
                .src_access_mask(writes(before.0.1))
                .old_layout(before.1)
                .dst_stage_mask(after.0.0)
                .dst_access_mask(after.0.1)
                .new_layout(after.1)
                .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .image(texture.image)
                .subresource_range(whole(texture.format)),
        );
    }

    /// Writes none from now on, or all again.
    #[cfg(feature = "faults")]
    pub(crate) fn leave_out(&mut self, left_out: bool) {
        *self = Self { left_out, ..Self::default() };
    }

    /// Writes it, if there is anything to wait for, and empties it. Says whether it was written.
    pub(crate) fn record(&mut self, gpu: &Gpu, commands: vk::CommandBuffer) -> bool {
        let waits = self.before.0 != vk::PipelineStageFlags2::NONE;
        if self.left_out || (!waits && self.images.is_empty()) {
            return false;
        }
        let memory = [vk::MemoryBarrier2::default()
            .src_stage_mask(self.before.0)
            .src_access_mask(self.before.1)
            .dst_stage_mask(self.after.0)
            .dst_access_mask(self.after.1)];
        let info = vk::DependencyInfo::default()
            .memory_barriers(if waits { &memory } else { &[] })
            .image_memory_barriers(&self.images);
        // SAFETY: the command buffer is being recorded, outside of a render pass, and the images are alive.
        unsafe { gpu.device.cmd_pipeline_barrier2(commands, &info) };
        (self.before, self.after) = Default::default();
        self.images.clear();
        true
    }
}
