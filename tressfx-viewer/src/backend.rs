//! Which backend runs the passes.

use anyhow::{Result, bail};
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_backend_wgpu::{WgpuBackend, WgpuOptions};
use tressfx_core::backend::Run;

use crate::cli::{BackendName, Scene};
use crate::say::say;

/// Opens the backend that was asked for.
pub(crate) fn open(args: &Scene) -> Result<Box<dyn Run>> {
    match args.backend {
        BackendName::Wgpu if args.validate => bail!("--validate works with --backend vulkan"),
        BackendName::Wgpu => Ok(Box::new(WgpuBackend::headless_with(&WgpuOptions { adapter: args.adapter.clone() })?)),
        BackendName::Vulkan => Ok(Box::new(VulkanBackend::headless_with(&VulkanOptions {
            adapter: args.adapter.clone(),
            validation: args.validate,
            statistics: args.profile || args.trace.is_some(),
            pipeline_cache: args.pipeline_cache.clone(),
        })?)),
        BackendName::Both => bail!("--backend both works with `render`"),
    }
}

/// `tressfx adapters`.
pub(crate) fn adapters() -> Result<()> {
    let adapters = [tressfx_backend_wgpu::adapters(), tressfx_backend_vulkan::adapters()].concat();
    if adapters.is_empty() {
        bail!("{}", WgpuBackend::headless().err().map_or(String::new(), |error| error.to_string()));
    }
    adapters.iter().try_for_each(say)?;
    Ok(())
}
