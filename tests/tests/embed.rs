//! Backends inside of an engine: its device, its queue, its encoder, its buffers and textures.

#[path = "embed/vulkan.rs"]
mod vulkan;
#[path = "embed/wgpu.rs"]
mod wgpu;
