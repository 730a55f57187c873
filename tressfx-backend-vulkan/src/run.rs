//! Lists that this backend submits by itself: for tests and tools.

use ash::prelude::VkResult;
use ash::vk;
use tressfx_core::backend::Record;
use tressfx_core::error::{Label, Result};
use tressfx_core::pass::PassList;

use crate::device::Gpu;
use crate::{EngineCommands, VulkanBackend};

const LABEL: Label = "hair.run";

/// A command buffer of our own, and what tells that it has run.
#[derive(Debug)]
pub(crate) struct Runner {
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
}

impl Runner {
    fn new(gpu: &Gpu) -> Result<Self> {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.queue_family);
        // SAFETY: the device is alive.
        let pool = gpu.create(LABEL, |device| unsafe { device.create_command_pool(&info, None) })?;
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: as above.
        let commands = gpu.create(LABEL, |device| unsafe { device.allocate_command_buffers(&info) }.map(|all| all[0]));
        let fence = vk::FenceCreateInfo::default();
        let made = commands.and_then(|commands| {
            // SAFETY: as above.
            let fence = gpu.create(LABEL, |device| unsafe { device.create_fence(&fence, None) })?;
            Ok(Self { pool, commands, fence })
        });
        // SAFETY: nothing uses it.
        made.inspect_err(|_| unsafe { gpu.device.destroy_command_pool(pool, None) })
    }

    fn begin(&self, gpu: &Gpu) -> VkResult<()> {
        let once = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        gpu.faults.next()?;
        // SAFETY: what it recorded last is over.
        unsafe {
            gpu.device.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())?;
            gpu.device.begin_command_buffer(self.commands, &once)
        }
    }

    fn submit(&self, gpu: &Gpu) -> VkResult<()> {
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(self.commands)];
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&commands)];
        gpu.faults.next()?;
        // SAFETY: the command buffer was begun, and the fence is not in use.
        unsafe {
            gpu.device.end_command_buffer(self.commands)?;
            gpu.device.queue_submit2(gpu.queue, &submit, self.fence)
        }
    }

    fn wait(&self, gpu: &Gpu) -> VkResult<()> {
        // SAFETY: the fence is of what was submitted last.
        unsafe {
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
        let runner = match self.runner.take() {
            Some(runner) => runner,
            None => Runner::new(&self.gpu)?,
        };
        let ran = self.run_on(&runner, list);
        self.runner = Some(runner);
        ran?;
        self.check_validation()
    }

    fn run_on(&mut self, runner: &Runner, list: &PassList) -> Result<()> {
        runner.begin(&self.gpu).map_err(|code| self.gpu.failed(code, LABEL, 0))?;
        let before = self.recorded();
        // SAFETY: it is ours, it is being recorded, and it is submitted or discarded below.
        let mut commands = unsafe { EngineCommands::new(self, runner.commands) };
        self.record(&mut commands, list)?;
        if let Err(code) = runner.submit(&self.gpu) {
            let error = self.gpu.failed(code, LABEL, 0);
            // SAFETY: it was not submitted.
            unsafe { self.mark_discarded_after(before) };
            return Err(error);
        }
        runner.wait(&self.gpu).map_err(|code| self.gpu.failed(code, LABEL, 0))?;
        // SAFETY: the fence has waited for this and for everything that was submitted before. What was not submitted by now
        // never will be, as promised for all other command buffers.
        unsafe { self.mark_finished(self.recorded()) };
        Ok(())
    }
}
