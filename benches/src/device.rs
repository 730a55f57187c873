//! Devices that can time passes.

use tressfx_backend_vulkan::VulkanBackend;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::backend::Run;

use crate::groom::Failure;

/// Opens a device.
pub type Open = fn() -> tressfx_core::Result<Box<dyn Run>>;

/// The backends, by name.
pub const DEVICES: [(&str, Open); 2] =
    [("wgpu", || Ok(Box::new(WgpuBackend::headless()?))), ("vulkan", || Ok(Box::new(VulkanBackend::headless()?)))];

/// The device of the backend of a name, whose adapter is printed; none where it cannot be timed, and why is printed.
///
/// # Errors
/// A name that no backend has.
pub fn timed_by_name(name: &str) -> Result<Option<Box<dyn Run>>, Failure> {
    let (name, open) = DEVICES.iter().find(|(known, _)| *known == name).ok_or("no such backend")?;
    match timed(name, open()) {
        Ok(backend) => {
            println!("{name}: {}", backend.caps().adapter);
            Ok(Some(backend))
        }
        Err(message) => {
            println!("{message}");
            Ok(None)
        }
    }
}

/// A device that has timestamps.
///
/// # Errors
/// Why it is left out, in words.
pub fn timed(name: &str, opened: tressfx_core::Result<Box<dyn Run>>) -> Result<Box<dyn Run>, String> {
    let backend = opened.map_err(|error| format!("{name}: skipped: {error}"))?;
    let caps = backend.caps();
    if !caps.timestamps {
        return Err(format!("{name}: skipped: {} has no timestamps, so its passes cannot be timed", caps.adapter));
    }
    Ok(backend)
}

#[cfg(test)]
mod tests {
    use tressfx_core::backend::Caps;
    use tressfx_core::error::Error;
    use tressfx_core::null::NullBackend;

    use super::*;

    #[test]
    fn a_device_without_timestamps_is_left_out_and_named() {
        let device = |timestamps| {
            let mut caps = Caps::webgpu_default();
            (caps.timestamps, caps.adapter) = (timestamps, String::from("an old GPU"));
            timed("wgpu", Ok(Box::new(NullBackend::new(caps))))
        };
        assert!(device(true).is_ok());
        let said = device(false).err().expect("it cannot be timed");
        assert_eq!(said, "wgpu: skipped: an old GPU has no timestamps, so its passes cannot be timed");
        let missing = Error::NoAdapter { message: String::from("no driver") };
        let said = timed("vulkan", Err(missing)).err().expect("there is none");
        assert!(said.starts_with("vulkan: skipped: ") && said.contains("no driver"), "{said}");
    }
}
