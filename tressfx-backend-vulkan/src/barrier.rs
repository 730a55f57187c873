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
    /// What is waited for.
    earlier: StageAccess,
    /// What has to wait.
    later: StageAccess,
    images: Vec<vk::ImageMemoryBarrier2<'static>>,
    /// Whether no barriers are written: for tests.
    left_out: bool,
}

impl Barrier {
    /// A buffer is used otherwise.
    pub(crate) fn buffer(&mut self, earlier: StageAccess, later: StageAccess) {
        self.earlier = (self.earlier.0 | earlier.0, self.earlier.1 | writes(earlier.1));
        self.later = (self.later.0 | later.0, self.later.1 | later.1);
    }

    /// A texture is used otherwise; empty `earlier`: its contents are not needed.
    pub(crate) fn texture(&mut self, texture: &Texture, earlier: Access, later: Access) {
        let layout = |access| image_layout(Layout::of(access), texture.format);
        let old = if earlier.is_empty() { vk::ImageLayout::UNDEFINED } else { layout(earlier) };
        let format = Some(texture.format);
        self.image(texture, (scope(earlier, format), old), (scope(later, format), layout(later)));
    }

    /// A texture comes from its owner.
    pub(crate) fn acquire(&mut self, texture: &Texture, initial_use: &EngineUse, later: Access) {
        let layout = image_layout(Layout::of(later), texture.format);
        self.image(
            texture,
            ((initial_use.stage, initial_use.access), initial_use.layout),
            (scope(later, Some(texture.format)), layout),
        );
    }

    /// A texture goes back to its owner.
    pub(crate) fn release(&mut self, texture: &Texture, earlier: Access, final_use: &EngineUse) {
        let layout = image_layout(Layout::of(earlier), texture.format);
        self.image(
            texture,
            (scope(earlier, Some(texture.format)), layout),
            ((final_use.stage, final_use.access), final_use.layout),
        );
    }

    fn image(
        &mut self,
        texture: &Texture,
        earlier: (StageAccess, vk::ImageLayout),
        later: (StageAccess, vk::ImageLayout),
    ) {
        self.images.push(
            vk::ImageMemoryBarrier2::default()
                .src_stage_mask(earlier.0.0)
                .src_access_mask(writes(earlier.0.1))
                .old_layout(earlier.1)
                .dst_stage_mask(later.0.0)
                .dst_access_mask(later.0.1)
                .new_layout(later.1)
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
        let waits = self.earlier.0 != vk::PipelineStageFlags2::NONE;
        if self.left_out || (!waits && self.images.is_empty()) {
            return false;
        }
        let memory = [vk::MemoryBarrier2::default()
            .src_stage_mask(self.earlier.0)
            .src_access_mask(self.earlier.1)
            .dst_stage_mask(self.later.0)
            .dst_access_mask(self.later.1)];
        let info = vk::DependencyInfo::default()
            .memory_barriers(if waits { &memory } else { &[] })
            .image_memory_barriers(&self.images);
        // SAFETY: the command buffer is being recorded, outside of a render pass, and the images are alive.
        unsafe { gpu.device.cmd_pipeline_barrier2(commands, &info) };
        (self.earlier, self.later) = Default::default();
        self.images.clear();
        true
    }
}
