//! Runs TressFX passes on raw Vulkan 1.3. It uses synchronization2 and dynamic rendering, and naga writes the SPIR-V of the
//! shaders.
//!
//! # Which constructor
//!
//! * An engine that has a device and draws hair in its frames: [`VulkanBackend::new`]. The backend shares the device.
//! * A tool or a test without a device and without a window: [`VulkanBackend::headless`], or
//!   [`VulkanBackend::headless_with`] to choose the adapter and more. The backend opens a device of its own.
//!
//! # Promises
//!
//! * [`record`](tressfx_core::backend::Record::record) never submits, waits or keeps the command buffer. Call it outside of
//!   a render pass. It changes the bound pipelines and descriptor sets, the viewport and the scissor, and does not restore
//!   them.
//! * Barriers come from `tressfx_core::hazards`: one `vkCmdPipelineBarrier2` before a command that has to wait for an
//!   earlier one, and no barrier before other commands.
//! * Imported buffers and textures are never destroyed here; `destroy` only stops tracking them. A recording that uses one
//!   leaves it in the final use (and layout) that it was imported with; a recording that does not use it does not touch
//!   it.
//! * On an engine's device only [`run`](tressfx_core::backend::Run::run) waits. A resource that is destroyed while the GPU
//!   may still use it is freed once the engine has said that the command buffers that may name it have finished: it calls
//!   [`mark_finished`](VulkanBackend::mark_finished) once a frame.
//! * If the engine throws a command buffer away, [`mark_discarded_after`](VulkanBackend::mark_discarded_after) undoes what
//!   was recorded into it.
//! * There is no lock inside: one thread at a time may use a backend, and one at a time its queue.
//!
//! The crate decides nothing about hair and opens no window.

mod barrier;
mod cache;
mod device;
mod draw;
mod error;
mod faults;
mod frames;
mod instance;
mod label;
mod memory;
mod pipeline;
mod progress;
mod reads;
mod record;
mod resource;
mod run;
mod sets;
mod tables;
mod timer;
mod tracker;
mod uses;
mod validation;

use std::path::PathBuf;

use tressfx_core::backend::{
    Backend, BufferDesc, Caps, Catalog, ComputeDesc, Memory, RasterDesc, ReadBack, Run, TextureDesc, Timing,
};
use tressfx_core::error::{Error, Result};
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shader::{Kernel, RasterPipeline};

/// The version of the crate `ash` that this backend is built with.
pub use ash;
pub use device::{Enabled, VulkanDesc, VulkanOptions};
/// The version of the crate `gpu-allocator` that this backend is built with.
pub use gpu_allocator;
pub use instance::adapters;
pub use label::{LoaderLock, lock_loader};
pub use record::EngineCommands;
pub use uses::EngineUse;

type Resources = Catalog<resource::Buffer, resource::Texture, pipeline::Pipeline>;

/// A backend on a Vulkan device, its own or an engine's.
#[derive(Debug)]
pub struct VulkanBackend {
    catalog: Resources,
    tracker: tracker::Tracker,
    sets: sets::Sets,
    frames: frames::Frames,
    reads: reads::Reads,
    timer: timer::Timer,
    runner: Option<run::Runner>,
    cache: cache::Cache,
    /// Freed last: everything above is made on its device.
    gpu: device::Gpu,
}

impl VulkanBackend {
    /// For engines: a backend on the engine's device.
    ///
    /// # Safety
    /// * Instance, adapter, device, queue and allocator belong together and outlive the backend; the device is a Vulkan 1.3
    ///   device with `synchronization2`, `dynamicRendering` and the features that `enabled` lists.
    /// * The queue is used by one thread at a time: [`run`](Run::run) submits to it.
    /// * When the backend is dropped, everything that was recorded has run, or never will run: the backend does not wait.
    pub unsafe fn new(desc: VulkanDesc) -> Self {
        let path = desc.pipeline_cache.clone();
        // SAFETY: as promised.
        Self::on(unsafe { device::Gpu::share(desc) }, path)
    }

    /// For tools and tests: a backend with a device of its own and no window, on the fastest adapter that the system has.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] with what was tried and what to install.
    pub fn headless() -> Result<Self> {
        Self::headless_with(&VulkanOptions::default())
    }

    /// As [`headless`](Self::headless), with options.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] with the adapters that were found, or with what was tried and what to install.
    pub fn headless_with(options: &VulkanOptions) -> Result<Self> {
        Ok(Self::on(device::Gpu::open(options)?, options.pipeline_cache.clone()))
    }

    fn on(gpu: device::Gpu, cache_path: Option<PathBuf>) -> Self {
        let caps = gpu.caps();
        Self {
            timer: timer::Timer::new(&gpu, caps.timestamps),
            catalog: Catalog::new(caps),
            tracker: tracker::Tracker::default(),
            sets: sets::Sets::default(),
            frames: frames::Frames::default(),
            reads: reads::Reads::default(),
            runner: None,
            cache: cache::Cache::load(&gpu, cache_path),
            gpu,
        }
    }

    /// The device.
    pub fn device(&self) -> &ash::Device {
        &self.gpu.device
    }

    /// The queue family that command buffers have to be submitted to.
    pub fn queue_family(&self) -> u32 {
        self.gpu.queue_family
    }

    /// How many `vkCmdPipelineBarrier2` commands were recorded so far.
    pub fn barriers(&self) -> u64 {
        self.tracker.barriers
    }

    /// How many descriptor pools there are.
    #[cfg(feature = "faults")]
    pub fn descriptor_pools(&self) -> usize {
        self.sets.pools()
    }

    /// Writes the pipeline cache to its file. This also happens when the backend is dropped.
    ///
    /// # Errors
    /// Whatever the file system or the driver answers.
    pub fn store_pipeline_cache(&self) -> std::io::Result<()> {
        self.cache.store(&self.gpu)
    }

    /// An error if the validation layer has sent messages since the last call.
    fn check_validation(&self) -> Result<()> {
        let messages = self.gpu.messages();
        let message = messages.join("\n");
        if messages.is_empty() { Ok(()) } else { Err(Error::Backend { label: "validation", message }) }
    }
}

impl Backend for VulkanBackend {
    fn caps(&self) -> &Caps {
        self.catalog.caps()
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        self.make_buffer(desc)
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        self.make_texture(desc)
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        self.make_compute(desc)
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        self.make_raster(desc)
    }

    fn destroy(&mut self, resource: Resource) {
        self.catalog.destroy(resource);
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.catalog.destroy_pipeline(pipeline);
    }

    fn read(&mut self, ticket: Ticket) -> ReadBack {
        self.take_read(ticket)
    }

    fn cancel_read(&mut self, ticket: Ticket) {
        self.forget_read(ticket);
    }

    fn timings(&mut self) -> Vec<Timing> {
        self.time();
        self.timer.take()
    }

    fn memory(&self) -> Memory {
        self.catalog.memory()
    }
}

impl Run for VulkanBackend {
    fn run(&mut self, list: &PassList) -> Result<()> {
        self.run_list(list)
    }
}

impl Drop for VulkanBackend {
    fn drop(&mut self) {
        self.gpu.finish_own();
        // A cache that cannot be kept only costs time.
        let _ = self.store_pipeline_cache();
        self.frames.destroy(&self.gpu, &mut self.sets);
        self.sets.destroy(&self.gpu);
        self.reads.destroy(&self.gpu);
        self.runner.take().into_iter().for_each(|runner| runner.destroy(&self.gpu));
        let (buffers, textures, pipelines) = self.catalog.drain();
        buffers.into_iter().for_each(|buffer| self.gpu.destroy_buffer(buffer));
        textures.into_iter().for_each(|texture| self.gpu.destroy_texture(texture));
        pipelines.into_iter().for_each(|pipeline| self.gpu.destroy_pipeline(pipeline));
        self.cache.destroy(&self.gpu);
    }
}
