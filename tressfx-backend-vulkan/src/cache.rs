//! Compiled pipelines, kept in a file from one run to the next.

use std::fs;
use std::path::{Path, PathBuf};

use ash::vk;

use crate::device::Gpu;

/// What the file begins with.
const MAGIC: &[u8; 8] = b"tfxcache";

/// A pipeline cache, and where it is kept.
#[derive(Debug)]
pub(crate) struct Cache {
    pub(crate) cache: vk::PipelineCache,
    path: Option<PathBuf>,
}

impl Cache {
    pub(crate) fn load(gpu: &Gpu, path: Option<PathBuf>) -> Self {
        Self { cache: gpu.load_cache(path.as_deref()), path }
    }

    pub(crate) fn store(&self, gpu: &Gpu) -> std::io::Result<()> {
        self.path.as_ref().map_or(Ok(()), |path| gpu.store_cache(self.cache, path))
    }

    pub(crate) fn destroy(&mut self, gpu: &Gpu) {
        // SAFETY: no pipeline is being made; null is nothing to destroy.
        unsafe { gpu.device.destroy_pipeline_cache(std::mem::take(&mut self.cache), None) };
    }
}

impl Gpu {
    /// A pipeline cache with what the file holds, if it is there, whole and of this driver; else an empty one; null if not
    /// even that can be made, which Vulkan takes for none.
    fn load_cache(&self, path: Option<&Path>) -> vk::PipelineCache {
        let stored = path.and_then(|path| fs::read(path).ok());
        let data = stored.as_deref().and_then(|file| self.checked(file)).unwrap_or_default();
        let create = |data: &[u8]| {
            let info = vk::PipelineCacheCreateInfo::default().initial_data(data);
            // SAFETY: the device is alive, and the data are what this driver wrote.
            unsafe { self.device.create_pipeline_cache(&info, None) }
        };
        create(data).or_else(|_| create(&[])).unwrap_or_default()
    }

    /// The driver's data, if nothing about the file is wrong. Drivers are known to crash on data that were damaged.
    fn checked<'a>(&self, file: &'a [u8]) -> Option<&'a [u8]> {
        let (sum, data) = file.strip_prefix(MAGIC)?.split_first_chunk::<8>()?;
        let properties = &self.properties;
        // The header that Vulkan prescribes: its length, its version, vendor, device, and the driver's build.
        let head =
            |at: usize| data.get(at..at + 4).map(|four| u32::from_le_bytes(four.try_into().expect("four bytes")));
        let ours = u64::from_le_bytes(*sum) == checksum(data)
            && head(4)? == vk::PipelineCacheHeaderVersion::ONE.as_raw() as u32
            && head(8)? == properties.vendor_id
            && head(12)? == properties.device_id
            && data.get(16..32)? == properties.pipeline_cache_uuid;
        ours.then_some(data)
    }

    /// Writes the cache to the file, whole or not at all. A cache that cannot be kept only costs time.
    fn store_cache(&self, cache: vk::PipelineCache, path: &Path) -> std::io::Result<()> {
        // SAFETY: the cache is alive, or null.
        let data = match cache {
            cache if cache == vk::PipelineCache::null() => return Ok(()),
            cache => unsafe { self.device.get_pipeline_cache_data(cache) }.map_err(std::io::Error::other)?,
        };
        let file = [&MAGIC[..], &checksum(&data).to_le_bytes(), &data].concat();
        let unfinished = path.with_extension(format!("{}.tmp", std::process::id()));
        fs::write(&unfinished, file)?;
        fs::rename(&unfinished, path)
    }
}

/// FNV-1a.
fn checksum(data: &[u8]) -> u64 {
    data.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
