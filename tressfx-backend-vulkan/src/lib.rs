//! Runs TressFX passes on raw Vulkan 1.3: synchronization2 and dynamic rendering, and SPIR-V from the naga module of each shader.
//!
//! # Promises
//!
//! * [`record`](tressfx_core::backend::Record::record) never submits, waits or keeps the command buffer. It is called outside of a render pass and leaves
//!   pipelines, descriptor sets, viewport and scissor changed.
//! * Barriers come from the hazards of `tressfx-core`: one `vkCmdPipelineBarrier2` before a command that has to wait for an
//!   earlier one, none before one that does not.
//! * Imported buffers and textures are never destroyed here; `destroy` only forgets them. After each recording they are in
//!   the use that was promised when they were imported, if it named them; else they are as it found them.
//! * What is destroyed while the GPU may still use it is freed once the engine says that the command buffers that may name it
//!   are over: [`retire`](VulkanBackend::retire), once a frame. [`run`](Backend::run) and
//!   [`wait_idle`](VulkanBackend::wait_idle) know by themselves.
//! * Nothing is put between two threads: a backend is used by one at a time, and so is its queue.
//!
//! It decides nothing about hair and does not know what a window is.

mod barrier;
mod cache;
mod device;
mod error;
mod frame;
mod instance;
mod label;
mod pipeline;
mod read;
mod record;
mod resource;
mod run;
mod sets;
mod tables;
mod timer;
mod validation;

use std::collections::HashMap;
use std::path::PathBuf;

use tressfx_core::backend::{Backend, BufferDesc, Caps, ComputeDesc, Kernel, Memory, RasterDesc, TextureDesc, Timing};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::hazards::Hazards;
use tressfx_core::id::{BufferId, PipelineId, Resource, Slots, TextureId};
use tressfx_core::pass::{PassList, Ticket};

/// The ash that this backend is built against.
pub use ash;
pub use device::{Enabled, VulkanDesc, VulkanOptions};
/// The allocator that this backend is built against.
pub use gpu_allocator;
pub use instance::adapters;
pub use label::alone;
pub use resource::Import;

/// A backend on a Vulkan device, its own or an engine's.
#[derive(Debug)]
pub struct VulkanBackend {
    caps: Caps,
    buffers: Slots<resource::Buffer>,
    textures: Slots<resource::Texture>,
    pipelines: Slots<pipeline::Pipeline>,
    sets: sets::Sets,
    /// Made, and not filled with zeros yet.
    not_zeroed: Vec<Resource>,
    hazards: Hazards,
    /// What the next command has to wait for.
    barrier: barrier::Barrier,
    /// Imported resources that the list under way has touched.
    borrowed: Vec<Resource>,
    barriers: u64,
    frames: frame::Frames,
    reads: HashMap<Ticket, read::PendingRead>,
    timer: timer::Timer,
    runner: Option<run::Runner>,
    cache: ash::vk::PipelineCache,
    cache_path: Option<PathBuf>,
    memory: Memory,
    lost: Option<String>,
    /// The last to go: everything above lives on it.
    gpu: device::Gpu,
}

impl VulkanBackend {
    /// A backend on an engine's device.
    ///
    /// # Safety
    /// * Instance, adapter, device, queue and allocator belong together and outlive the backend; the device is of Vulkan 1.3,
    ///   with `synchronization2`, `dynamicRendering` and what `enabled` says.
    /// * Command buffers given to [`record`](tressfx_core::backend::Record::record) are of this device and the queue's family, are being recorded,
    ///   outside of a render pass, and are submitted to the queue once, in the order in which they were recorded, among what
    ///   [`run`](Backend::run) submits. Where one is never submitted, [`wait_idle`](Self::wait_idle) is called before the next
    ///   is recorded.
    /// * The queue is used by one thread at a time: [`run`](Backend::run) submits to it.
    /// * When the backend is dropped, everything that was recorded has run or never will.
    pub unsafe fn new(desc: VulkanDesc) -> Self {
        let path = desc.pipeline_cache.clone();
        // SAFETY: as promised.
        Self::on(unsafe { device::Gpu::share(desc) }, path)
    }

    /// A backend with a device of its own and no window: the fastest adapter that the system has.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] with what was tried and what to install.
    pub fn headless() -> Result<Self> {
        Self::open(&VulkanOptions::default())
    }

    /// As [`headless`](Self::headless), with options.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] with what there is and what to install.
    pub fn open(options: &VulkanOptions) -> Result<Self> {
        Ok(Self::on(device::Gpu::open(options)?, options.pipeline_cache.clone()))
    }

    fn on(gpu: device::Gpu, cache_path: Option<PathBuf>) -> Self {
        let caps = gpu.caps();
        Self {
            timer: timer::Timer::new(&gpu, caps.timestamps),
            caps,
            buffers: Slots::default(),
            textures: Slots::default(),
            pipelines: Slots::default(),
            sets: sets::Sets::default(),
            not_zeroed: Vec::new(),
            hazards: Hazards::default(),
            barrier: barrier::Barrier::default(),
            borrowed: Vec::new(),
            barriers: 0,
            frames: frame::Frames::default(),
            reads: HashMap::new(),
            runner: None,
            cache: gpu.load_cache(cache_path.as_deref()),
            cache_path,
            memory: Memory::default(),
            lost: None,
            gpu,
        }
    }

    /// The device.
    pub fn device(&self) -> &ash::Device {
        &self.gpu.device
    }

    /// The family of the queue that recorded command buffers go to.
    pub fn queue_family(&self) -> u32 {
        self.gpu.queue_family
    }

    /// How many `vkCmdPipelineBarrier2` were recorded so far.
    pub fn barriers(&self) -> u64 {
        self.barriers
    }

    /// Leaves all barriers out from now on, or none again, so that a test can see whether anybody notices.
    #[doc(hidden)]
    pub fn leave_out_barriers(&mut self, left_out: bool) {
        self.barrier.leave_out(left_out);
    }

    /// Writes the pipeline cache to its file, as dropping the backend does.
    ///
    /// # Errors
    /// Whatever the file system or the driver answers.
    pub fn store_pipeline_cache(&self) -> std::io::Result<()> {
        self.cache_path.as_ref().map_or(Ok(()), |path| self.gpu.store_cache(self.cache, path))
    }

    fn check_lost(&self) -> Result<()> {
        self.lost.as_ref().map_or(Ok(()), |reason| Err(Error::DeviceLost { reason: reason.clone() }))
    }

    /// Remembers that the device is lost.
    fn noted<T>(&mut self, result: Result<T>) -> Result<T> {
        if let Err(Error::DeviceLost { reason }) = &result {
            self.lost = Some(reason.clone());
        }
        result
    }

    /// What the validation layer has said becomes an error.
    fn heard(&self) -> Result<()> {
        let messages = self.gpu.messages();
        let message = messages.join("\n");
        if messages.is_empty() { Ok(()) } else { Err(Error::Backend { label: "validation", message }) }
    }

    /// What was made, unless the validation layer had something to say about it.
    fn validated<T>(&mut self, label: Label, made: T, garbage: fn(T) -> frame::Garbage) -> Result<T> {
        match self.heard() {
            Ok(()) => Ok(made),
            Err(error) => {
                self.throw_away(garbage(made));
                Err(Error::Backend { label, message: error.to_string() })
            }
        }
    }
}

impl Backend for VulkanBackend {
    fn caps(&self) -> &Caps {
        &self.caps
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        let made = self.make_buffer(desc);
        self.noted(made)
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        let made = self.make_texture(desc);
        self.noted(made)
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        let made = self.make_compute(desc);
        self.noted(made)
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<Kernel> {
        let made = self.make_raster(desc);
        self.noted(made)
    }

    fn destroy(&mut self, resource: Resource) {
        self.forget(resource);
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.forget_pipeline(pipeline);
    }

    fn run(&mut self, list: &PassList) -> Result<()> {
        self.run_list(list)
    }

    fn read(&mut self, ticket: Ticket) -> Option<Vec<u8>> {
        self.take_read(ticket)
    }

    fn timings(&mut self) -> Vec<Timing> {
        self.collect();
        self.timer.take()
    }

    fn memory(&self) -> Memory {
        self.memory
    }
}

impl Drop for VulkanBackend {
    fn drop(&mut self) {
        // A lost device has finished too.
        let _ = self.wait_idle();
        // A cache that cannot be kept only costs time.
        let _ = self.store_pipeline_cache();
        self.frames.destroy(&self.gpu);
        self.sets.destroy(&self.gpu);
        self.reads.drain().for_each(|(_, read)| read.destroy(&self.gpu));
        self.runner.take().into_iter().for_each(|runner| runner.destroy(&self.gpu));
        self.buffers.drain().for_each(|buffer| self.gpu.destroy_buffer(buffer));
        self.textures.drain().for_each(|texture| self.gpu.destroy_texture(texture));
        self.pipelines.drain().for_each(|pipeline| self.gpu.destroy_pipeline(pipeline));
        // SAFETY: no pipeline is being made.
        unsafe { self.gpu.device.destroy_pipeline_cache(self.cache, None) };
    }
}
