//! Names of objects and passes, as debuggers show them.

use std::ffi::CString;
use std::sync::{PoisonError, RwLock, RwLockWriteGuard};

use ash::vk;
use tressfx_core::error::Label;

use crate::device::Gpu;

/// Held to name an object, and alone to make, ask or destroy an instance or a device: the Vulkan loader looks for the object's
/// device in lists that it does not guard, and crashes where another thread changes them.
static OPEN: RwLock<()> = RwLock::new(());

/// Held by an engine that makes, asks or destroys instances or devices of its own while a backend is used on another thread: no
/// object is named meanwhile.
pub fn alone() -> RwLockWriteGuard<'static, ()> {
    OPEN.write().unwrap_or_else(PoisonError::into_inner)
}

impl Gpu {
    /// Gives an object the name that it has in the source.
    pub(crate) fn name<T: vk::Handle>(&self, object: T, label: Label) {
        let Some(debug) = &self.debug else { return };
        let name = CString::new(label).unwrap_or_default();
        let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(object).object_name(&name);
        let _nothing_changes = OPEN.read().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the object is alive. A name that could not be given is no reason to stop.
        let _ = unsafe { debug.set_debug_utils_object_name(&info) };
    }

    /// Opens a group of commands.
    pub(crate) fn begin_label(&self, commands: vk::CommandBuffer, label: Label) {
        let Some(debug) = &self.debug else { return };
        let name = CString::new(label).unwrap_or_default();
        let info = vk::DebugUtilsLabelEXT::default().label_name(&name);
        // SAFETY: the command buffer is being recorded.
        unsafe { debug.cmd_begin_debug_utils_label(commands, &info) };
    }

    /// Closes it.
    pub(crate) fn end_label(&self, commands: vk::CommandBuffer) {
        let Some(debug) = &self.debug else { return };
        // SAFETY: as above.
        unsafe { debug.cmd_end_debug_utils_label(commands) };
    }
}
