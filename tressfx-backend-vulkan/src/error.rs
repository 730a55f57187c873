//! What the driver answers, in words of the contract.

use ash::vk;
use tressfx_core::error::{Error, Label, Result};

use crate::device::Gpu;

impl Gpu {
    /// As [`error`], and keeps in mind that the device is lost.
    pub(crate) fn failed(&self, code: vk::Result, label: Label, bytes: u64) -> Error {
        if code == vk::Result::ERROR_DEVICE_LOST {
            // The first who says so is right.
            let _ = self.lost.set(format!("the driver said so at {label}"));
        }
        error(code, label, bytes)
    }

    pub(crate) fn is_lost(&self) -> bool {
        self.lost.get().is_some()
    }

    pub(crate) fn check_lost(&self) -> Result<()> {
        self.lost.get().map_or(Ok(()), |reason| Err(Error::DeviceLost { reason: reason.clone() }))
    }
}

/// Something of a newer contract.
pub(crate) fn unknown(label: Label, what: impl std::fmt::Debug) -> Error {
    Error::Backend { label, message: format!("this backend does not know {what:?}") }
}

/// `bytes` were asked for, if any.
fn error(code: vk::Result, label: Label, bytes: u64) -> Error {
    match code {
        vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => {
            Error::OutOfMemory { label, bytes }
        }
        vk::Result::ERROR_DEVICE_LOST => Error::DeviceLost { reason: format!("the driver said so at {label}") },
        code => Error::Backend { label, message: code.to_string() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_answer_of_the_driver_has_its_error() {
        let lost = error(vk::Result::ERROR_DEVICE_LOST, "run", 0);
        assert_eq!(lost.to_string(), "the graphics device was lost: the driver said so at run");
        let full = error(vk::Result::ERROR_OUT_OF_DEVICE_MEMORY, "hair.nodes", 7);
        assert_eq!(full, Error::OutOfMemory { label: "hair.nodes", bytes: 7 });
        let other = error(vk::Result::ERROR_INITIALIZATION_FAILED, "hair.nodes", 7);
        assert!(other.to_string().starts_with("hair.nodes: "), "{other}");
    }
}
