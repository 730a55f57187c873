//! The hair inside of the engine: its backend on the engine's device, and the engine's images in it.

use anyhow::Result;
use tressfx_backend_vulkan::{Enabled, Import, VulkanBackend, VulkanDesc};
use tressfx_core::backend::{Format, TextureDesc};
use tressfx_render::Targets;

use crate::engine::Engine;
use crate::gpu::Gpu;

/// The hair on the engine's device.
pub(crate) fn share(engine: &Gpu) -> VulkanBackend {
    let desc = VulkanDesc {
        instance: engine.instance.clone(),
        physical_device: engine.physical_device,
        device: engine.device.clone(),
        queue: engine.queue,
        queue_family: engine.queue_family,
        allocator: engine.allocator.clone(),
        // The engine enabled nothing that is not required; so the shaders keep their accesses within bounds by themselves.
        enabled: Enabled { debug_utils: engine.is_watched(), ..Enabled::default() },
        pipeline_cache: None,
    };
    // SAFETY: they belong together and outlive the backend, the device has what is required, and one thread does
    // everything. All command buffers are submitted, in order.
    unsafe { VulkanBackend::new(desc) }
}

/// The engine's images, with the use in which the hair finds them and the use in which it leaves them.
pub(crate) fn import(gpu: &mut VulkanBackend, engine: &Engine, size: [u32; 2]) -> Result<Targets> {
    let light = TextureDesc { label: "engine.light", size, format: Format::Rgba16F };
    let depth = TextureDesc { label: "engine.depth", size, format: Format::Depth32F };
    // SAFETY: they are images of this device, made with these sizes and formats, to be drawn to and sampled; and they live
    // until the backend is gone.
    unsafe {
        // The engine has just drawn to it, and samples it next.
        let color = gpu.import_texture(engine.light.image, &light, Import::COLOR_TARGET, Import::SAMPLED)?;
        // It stays a depth target: the engine might go on drawing.
        let depth = gpu.import_texture(engine.depth.image, &depth, Import::DEPTH_TARGET, Import::DEPTH_TARGET)?;
        Ok(Targets::new(color, depth))
    }
}
