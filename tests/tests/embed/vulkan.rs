//! Inside of an engine on raw Vulkan, under the eyes of the validation layer.

use std::collections::HashMap;

use tressfx_backend_vulkan::ash::vk;
use tressfx_backend_vulkan::{EngineCommands, EngineUse, VulkanBackend};
use tressfx_conformance::embed::{Embed, TEXTURE_SIZE};
use tressfx_core::backend::{BufferDesc, Format, TextureDesc};
use tressfx_core::id::{BufferId, TextureId};

#[path = "engine.rs"]
mod engine;
#[path = "in_flight.rs"]
mod in_flight;
#[path = "promises.rs"]
mod promises;
#[path = "refused.rs"]
mod refused;

use engine::{Engine, whole};

tressfx_conformance::embed_suite!(|| Game::new());

/// As the engine's own commands use its buffers.
const COPIED: EngineUse = EngineUse {
    stage: vk::PipelineStageFlags2::ALL_TRANSFER,
    access: vk::AccessFlags2::from_raw(
        vk::AccessFlags2::TRANSFER_READ.as_raw() | vk::AccessFlags2::TRANSFER_WRITE.as_raw(),
    ),
    layout: vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
};

/// A texture without content.
const FRESH: EngineUse = EngineUse {
    stage: vk::PipelineStageFlags2::NONE,
    access: vk::AccessFlags2::NONE,
    layout: vk::ImageLayout::UNDEFINED,
};

fn texture() -> TextureDesc {
    TextureDesc::new("engine", TEXTURE_SIZE, Format::Rgba8)
}

/// An engine with hair in it.
struct Game {
    /// Goes before the device that it lives on.
    hair: VulkanBackend,
    engine: Engine,
    buffers: HashMap<BufferId, vk::Buffer>,
    textures: HashMap<TextureId, vk::Image>,
    /// Lists that were recorded before the newest command buffer was begun.
    begun: u64,
}

impl Game {
    fn new() -> Result<Self, String> {
        let engine = Engine::new()?;
        // SAFETY: all of it is the engine's, which goes after the backend.
        let hair = unsafe { VulkanBackend::new(engine.desc()) };
        Ok(Self { hair, engine, buffers: HashMap::new(), textures: HashMap::new(), begun: 0 })
    }

    fn import(&mut self, image: vk::Image) -> TextureId {
        // SAFETY: the image is as it is described, and lives as long as the engine.
        let id =
            unsafe { self.hair.import_texture(image, &texture(), EngineUse::SAMPLED, EngineUse::SAMPLED) }.unwrap();
        self.textures.insert(id, image);
        id
    }

    /// Waits between two uses of a texture of the engine's, and changes its layout.
    fn turn(&self, commands: vk::CommandBuffer, image: vk::Image, from: EngineUse, to: EngineUse) {
        let barrier = [vk::ImageMemoryBarrier2::default()
            .src_stage_mask(from.stage)
            .src_access_mask(from.access)
            .old_layout(from.layout)
            .dst_stage_mask(to.stage)
            .dst_access_mask(to.access)
            .new_layout(to.layout)
            .image(image)
            .subresource_range(whole(vk::Format::R8G8B8A8_UNORM))];
        let info = vk::DependencyInfo::default().image_memory_barriers(&barrier);
        // SAFETY: the command buffer is being recorded, outside of a render pass.
        unsafe { self.engine.device.cmd_pipeline_barrier2(commands, &info) };
    }
}

/// The first texel of a texture, in a copy.
fn first_texel() -> vk::BufferImageCopy {
    let aspect_mask = vk::ImageAspectFlags::COLOR;
    vk::BufferImageCopy::default()
        .image_subresource(vk::ImageSubresourceLayers { aspect_mask, layer_count: 1, ..Default::default() })
        .image_extent(vk::Extent3D { width: 1, height: 1, depth: 1 })
}

impl Embed for Game {
    type Backend = VulkanBackend;

    fn backend(&mut self) -> &mut VulkanBackend {
        &mut self.hair
    }

    fn buffer(&mut self, words: [u32; 4]) -> BufferId {
        let buffer = self.engine.buffer(bytemuck::bytes_of(&words));
        // SAFETY: it has 16 bytes and lives as long as the engine.
        let id =
            unsafe { self.hair.import_buffer(buffer, &BufferDesc::storage("engine", 16), COPIED, COPIED) }.unwrap();
        self.buffers.insert(id, buffer);
        id
    }

    fn texture(&mut self) -> TextureId {
        let (image, _) = self.engine.image(TEXTURE_SIZE, vk::Format::R8G8B8A8_UNORM);
        let commands = self.engine.begin();
        self.turn(commands, image, FRESH, EngineUse::SAMPLED);
        self.engine.submit(commands);
        self.import(image)
    }

    fn import_again(&mut self, texture: TextureId) -> TextureId {
        self.import(self.textures[&texture])
    }

    fn begin(&mut self) -> Box<EngineCommands> {
        self.begun = self.hair.recorded();
        // SAFETY: it is being recorded, and is submitted or discarded before the next is begun.
        Box::new(unsafe { EngineCommands::new(&self.hair, self.engine.begin()) })
    }

    fn clear_word(&mut self, encoder: &mut EngineCommands, buffer: BufferId, word: u64) {
        // SAFETY: the command buffer is being recorded, and the buffer lives as long as the engine.
        unsafe { self.engine.device.cmd_fill_buffer(encoder.raw(), self.buffers[&buffer], 4 * word, 4, 0) };
    }

    fn copy_texel(&mut self, encoder: &mut EngineCommands, texture: TextureId, buffer: BufferId) {
        let (image, buffer) = (self.textures[&texture], self.buffers[&buffer]);
        self.turn(encoder.raw(), image, EngineUse::SAMPLED, COPIED);
        // SAFETY: as above, and the texture was just put into the layout.
        unsafe {
            let regions = [first_texel()];
            self.engine.device.cmd_copy_image_to_buffer(encoder.raw(), image, COPIED.layout, buffer, &regions);
        }
        self.turn(encoder.raw(), image, COPIED, EngineUse::SAMPLED);
    }

    fn submit(&mut self, encoder: Box<EngineCommands>) {
        self.engine.submit(encoder.raw());
    }

    fn wait(&mut self) {
        self.engine.wait();
        // SAFETY: the queue has finished with everything that was submitted, and all else was discarded.
        unsafe { self.hair.mark_finished(self.hair.recorded()) };
        self.engine.assert_silent();
    }

    fn discard(&mut self, encoder: Box<EngineCommands>) {
        self.engine.discard(encoder.raw());
        // SAFETY: it was never submitted.
        unsafe { self.hair.mark_discarded_after(self.begun) };
    }
}
