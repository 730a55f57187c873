//! Names of objects and passes, as debuggers show them.

use std::cell::RefCell;
use std::ffi::CString;
use std::marker::PhantomData;
use std::sync::{PoisonError, RwLock, RwLockWriteGuard};

use ash::vk;
use tressfx_core::error::Label;

use crate::device::Gpu;

/// Held to name an object, and alone to make, ask or destroy an instance or a device: the Vulkan loader looks for the object's
/// device in lists that it does not guard, and crashes where another thread changes them.
static OPEN: RwLock<()> = RwLock::new(());

thread_local! {
    /// How often this thread is alone, and what keeps the others out.
    static HELD: RefCell<(u32, Option<RwLockWriteGuard<'static, ()>>)> = const { RefCell::new((0, None)) };
}

/// See [`lock_loader`]. It stays on its thread.
#[derive(Debug)]
#[must_use = "others are kept out for as long as it is held"]
pub struct LoaderLock(PhantomData<*const ()>);

/// Held by an engine that makes, asks or destroys instances or devices of its own while a backend is used on another thread: no
/// object is named meanwhile. A thread may hold several.
pub fn lock_loader() -> LoaderLock {
    let is_alone = HELD.with_borrow(|held| held.0 > 0);
    let guard = (!is_alone).then(|| OPEN.write().unwrap_or_else(PoisonError::into_inner));
    HELD.with_borrow_mut(|held| {
        held.0 += 1;
        held.1 = held.1.take().or(guard);
    });
    LoaderLock(PhantomData)
}

impl Drop for LoaderLock {
    fn drop(&mut self) {
        HELD.with_borrow_mut(|held| {
            held.0 -= 1;
            if held.0 == 0 {
                held.1 = None;
            }
        });
    }
}

impl Gpu {
    /// Gives an object the name that it has in the source.
    pub(crate) fn name<T: vk::Handle>(&self, object: T, label: Label) {
        let Some(debug) = &self.debug else { return };
        let name = CString::new(label).unwrap_or_default();
        let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(object).object_name(&name);
        let is_alone = HELD.with_borrow(|held| held.0 > 0);
        let _nothing_changes = (!is_alone).then(|| OPEN.read().unwrap_or_else(PoisonError::into_inner));
        // SAFETY: the object is alive. A name that could not be given is no reason to stop.
        let _ = unsafe { debug.set_debug_utils_object_name(&info) };
    }

    /// Opens a group of commands: a pass, and whose it is.
    pub(crate) fn begin_label(&self, commands: vk::CommandBuffer, label: Label, scope: Option<&str>) {
        let Some(debug) = &self.debug else { return };
        let name = scope.map_or_else(|| label.to_owned(), |scope| format!("{label} of {scope}"));
        let name = CString::new(name).unwrap_or_default();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_is_alone_may_be_alone_again_and_others_wait_for_the_last() {
        let (outer, inner) = (lock_loader(), lock_loader());
        let other = std::thread::spawn(|| drop(lock_loader()));
        drop(outer);
        std::thread::sleep(std::time::Duration::from_millis(50));
        assert!(!other.is_finished(), "the second is still held");
        drop(inner);
        other.join().unwrap();
    }
}
