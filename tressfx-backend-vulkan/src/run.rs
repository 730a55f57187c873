//! Lists that this backend submits by itself: for tests and tools.

use ash::vk;
use tressfx_core::backend::Record;
use tressfx_core::error::Result;
use tressfx_core::pass::PassList;

use crate::VulkanBackend;
use crate::device::Gpu;
use crate::error::error;

/// A command buffer of our own, and what tells that it has run.
#[derive(Debug)]
pub(crate) struct Runner {
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
}

impl Runner {
    fn new(gpu: &Gpu) -> Result<Self> {
        let failed = |code| error(code, "hair.run", 0);
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.queue_family);
        // SAFETY: the device is alive. What was made is destroyed where the next step fails.
        unsafe {
            let pool = gpu.device.create_command_pool(&info, None).map_err(failed)?;
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let made = gpu.device.allocate_command_buffers(&info).and_then(|commands| {
                let fence = gpu.device.create_fence(&vk::FenceCreateInfo::default(), None)?;
                Ok(Self { pool, commands: commands[0], fence })
            });
            let runner = made.map_err(|code| {
                gpu.device.destroy_command_pool(pool, None);
                failed(code)
            })?;
            gpu.name(runner.pool, "hair.run");
            gpu.name(runner.commands, "hair.run");
            gpu.name(runner.fence, "hair.run");
            Ok(runner)
        }
    }

    fn begin(&self, gpu: &Gpu) -> ash::prelude::VkResult<()> {
        let once = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: what it recorded last has run.
        unsafe {
            gpu.device.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())?;
            gpu.device.begin_command_buffer(self.commands, &once)
        }
    }

    fn submit_and_wait(&self, gpu: &Gpu) -> ash::prelude::VkResult<()> {
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(self.commands)];
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&commands)];
        // SAFETY: the command buffer was begun, and the fence is not in use.
        unsafe {
            gpu.device.end_command_buffer(self.commands)?;
            gpu.device.queue_submit2(gpu.queue, &submit, self.fence)?;
            gpu.device.wait_for_fences(&[self.fence], true, u64::MAX)?;
            gpu.device.reset_fences(&[self.fence])
        }
    }

    pub(crate) fn destroy(self, gpu: &Gpu) {
        // SAFETY: the GPU has finished with them.
        unsafe {
            gpu.device.destroy_fence(self.fence, None);
            gpu.device.destroy_command_pool(self.pool, None);
        }
    }
}

impl VulkanBackend {
    pub(crate) fn run_list(&mut self, list: &PassList) -> Result<()> {
        self.check_lost()?;
        let runner = match self.runner.take() {
            Some(runner) => runner,
            None => Runner::new(&self.gpu)?,
        };
        let begun = runner.begin(&self.gpu).map_err(|code| error(code, "run", 0));
        let mut commands = runner.commands;
        let recorded = begun.and_then(|()| self.record(&mut commands, list));
        // A list that could not be recorded to its end is run so far, or its event would never be set.
        let ran = runner.submit_and_wait(&self.gpu).map_err(|code| error(code, "run", 0));
        self.runner = Some(runner);
        self.noted(recorded.and(ran))?;
        self.collect_all_but(0);
        self.heard()
    }
}
