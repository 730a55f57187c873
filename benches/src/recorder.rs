//! Recording on raw Vulkan into a command buffer that is never submitted.

use std::time::{Duration, Instant};

use tressfx_backend_vulkan::ash::vk;
use tressfx_backend_vulkan::{EngineCommands, VulkanBackend};
use tressfx_core::backend::Record;
use tressfx_core::pass::PassList;

/// An engine that records lists and throws them away.
#[derive(Debug)]
pub struct Recorder {
    backend: VulkanBackend,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
}

impl Recorder {
    /// Records what the resources of this backend are named in.
    ///
    /// # Panics
    /// Where Vulkan has no memory for a command buffer.
    pub fn new(backend: VulkanBackend) -> Self {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(backend.queue_family());
        // SAFETY: the device lives as long as the backend, which this keeps; both handles are freed with it.
        unsafe {
            let pool = backend.device().create_command_pool(&info, None).expect("a pool");
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = backend.device().allocate_command_buffers(&info).expect("a command buffer")[0];
            Self { backend, pool, commands }
        }
    }

    /// How long it takes to record a list.
    ///
    /// # Panics
    /// Where the list cannot be recorded.
    pub fn time(&mut self, list: &PassList) -> Duration {
        let Self { backend, pool, commands } = self;
        let device = backend.device().clone();
        let before = backend.recorded();
        // SAFETY: the command buffer is never submitted, so its pool may be reset, and the backend is told that nothing runs.
        unsafe {
            device.reset_command_pool(*pool, vk::CommandPoolResetFlags::empty()).expect("a reset");
            device.begin_command_buffer(*commands, &vk::CommandBufferBeginInfo::default()).expect("a beginning");
            let mut encoder = EngineCommands::new(backend, *commands);
            let start = Instant::now();
            backend.record(&mut encoder, list).expect("a recording");
            let time = start.elapsed();
            device.end_command_buffer(*commands).expect("an end");
            backend.mark_discarded_after(before);
            time
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // SAFETY: nothing was submitted.
        unsafe { self.backend.device().destroy_command_pool(self.pool, None) };
    }
}
