//! Failures that a test plants, to see that nothing is left behind where the driver refuses something half way.

#[cfg(feature = "faults")]
use std::sync::Mutex;

use ash::prelude::VkResult;
#[cfg(feature = "faults")]
use ash::vk;

/// What is to fail: nothing in a usual build.
#[derive(Debug, Default)]
pub(crate) struct Faults {
    /// So many calls succeed before one answers so.
    #[cfg(feature = "faults")]
    planted: Mutex<Option<(u32, vk::Result)>>,
}

impl Faults {
    /// To be asked before a call that can fail.
    #[cfg(feature = "faults")]
    pub(crate) fn next(&self) -> VkResult<()> {
        let mut planted = self.planted.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        match planted.take() {
            Some((0, code)) => Err(code),
            later => {
                *planted = later.map(|(calls, code)| (calls - 1, code));
                Ok(())
            }
        }
    }

    #[cfg(not(feature = "faults"))]
    pub(crate) fn next(&self) -> VkResult<()> {
        let Self {} = self;
        Ok(())
    }
}

#[cfg(feature = "faults")]
impl crate::VulkanBackend {
    /// Has the driver refuse one call that makes, allocates or submits something: after so many that succeed.
    pub fn plant_failure(&mut self, after: u32, code: vk::Result) {
        *self.gpu.faults.planted.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some((after, code));
    }

    /// Takes a failure out again. Says whether it was still to come.
    pub fn unplant_failure(&mut self) -> bool {
        self.gpu.faults.planted.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take().is_some()
    }

    /// Leaves all barriers out from now on, or none again.
    pub fn leave_out_barriers(&mut self, left_out: bool) {
        self.tracker.barrier.leave_out(left_out);
    }
}
