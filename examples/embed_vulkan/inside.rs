//! The hair inside of the engine: its backend on the engine's device, and the engine's images in it.

use anyhow::Result;
use tressfx_backend_vulkan::{Enabled, EngineUse, VulkanBackend, VulkanDesc};
use tressfx_core::backend::{Format, TextureDesc, TextureUses};
use tressfx_render::Targets;

use crate::engine::Engine;
use crate::gpu::Gpu;

/// The hair on the engine's device.
pub(crate) fn share(engine: &Gpu) -> VulkanBackend {
    let (queue, allocator) = ((engine.queue, engine.queue_family), engine.allocator.clone());
    let (instance, device) = (engine.instance.clone(), engine.device.clone());
    let mut desc = VulkanDesc::new(instance, engine.physical_device, device, queue, allocator);
    // The engine enabled nothing that is not required; so the shaders keep their accesses within bounds by themselves.
    desc.enabled = Enabled { debug_utils: engine.is_watched(), ..Enabled::default() };
    // SAFETY: they belong together and outlive the backend, the device has what is required, and one thread does
    // everything. The engine waits for its last frame before the backend goes.
    unsafe { VulkanBackend::new(desc) }
}

/// The engine's images, with their initial use, in which the hair finds them, and their final use, in which it leaves them.
pub(crate) fn import(gpu: &mut VulkanBackend, engine: &Engine, size: [u32; 2]) -> Result<Targets> {
    // As the images were made.
    let uses = TextureUses::TARGET | TextureUses::SAMPLED;
    let light = TextureDesc::new("engine.light", size, Format::Rgba16F).with_uses(uses);
    let depth = TextureDesc::new("engine.depth", size, Format::Depth32F).with_uses(uses);
    // SAFETY: they are images of this device, made with these sizes and formats, to be drawn to and sampled; and they live
    // until the backend is gone.
    unsafe {
        // The engine has just drawn to it, and samples it next.
        let color = gpu.import_texture(engine.light.image, &light, EngineUse::COLOR_TARGET, EngineUse::SAMPLED)?;
        // It stays a depth target: the engine might go on drawing.
        let depth = gpu.import_texture(engine.depth.image, &depth, EngineUse::DEPTH_TARGET, EngineUse::DEPTH_TARGET)?;
        Ok(Targets::new(color, depth))
    }
}
