//! The backends.

use anyhow::{Context, Result};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::backend::Run;

/// A backend, as one types it.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum BackendName {
    /// wgpu.
    Wgpu,
    /// Raw Vulkan.
    Vulkan,
}

impl BackendName {
    /// As it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgpu => "wgpu",
            Self::Vulkan => "vulkan",
        }
    }
}

/// A device.
pub struct Gpu {
    /// Which backend it is.
    pub name: BackendName,
    /// The backend.
    pub backend: Box<dyn Run>,
}

impl Gpu {
    /// Opens a device without a window.
    ///
    /// # Errors
    /// There is none.
    pub fn open(name: BackendName) -> Result<Self> {
        // The Vulkan loader does not let a device be made while another thread names an object.
        let _alone = tressfx_backend_vulkan::lock_loader();
        let backend: Box<dyn Run> = match name {
            BackendName::Wgpu => Box::new(WgpuBackend::headless().context("wgpu")?),
            BackendName::Vulkan => Box::new(VulkanBackend::headless().context("raw Vulkan")?),
        };
        Ok(Self { name, backend })
    }

    /// Opens it anew: what a failed case leaves behind is gone.
    ///
    /// # Errors
    /// There is no device any more.
    pub fn reopen(&mut self) -> Result<()> {
        *self = Self::open(self.name)?;
        Ok(())
    }

    /// The device in words.
    pub fn device(&self) -> String {
        self.backend.caps().adapter.clone()
    }
}
