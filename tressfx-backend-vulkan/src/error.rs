//! What the driver answers, in words of the contract.

use ash::vk;
use tressfx_core::error::{Error, Label};

/// `bytes` were asked for, if any.
pub(crate) fn error(code: vk::Result, label: Label, bytes: u64) -> Error {
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
