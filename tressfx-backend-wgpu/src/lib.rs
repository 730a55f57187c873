//! Runs TressFX passes on wgpu.
//!
//! # Which constructor
//!
//! * An engine that has a device and draws hair in its frames: [`WgpuBackend::new`]. The backend shares the device.
//! * A tool or a test without a device and without a window: [`WgpuBackend::headless`], or
//!   [`WgpuBackend::headless_with`] to choose the adapter. The backend opens a device of its own.
//! * The same where a thread must not block, as in a browser: [`WgpuBackend::headless_async`].
//!
//! # Promises
//!
//! * [`Record::record`] never submits, waits or keeps the encoder.
//! * Imported buffers and textures are never destroyed here; `destroy` only forgets them.
//! * The callbacks of an engine's device (device lost, uncaptured error) are left as the engine set them. A list that breaks
//!   a rule of the contract gives an `Err`, never an uncaptured error.
//! * wgpu derives barriers itself, so `tressfx_core::hazards` is not used.
//!
//! The crate decides nothing about hair and opens no window.

mod device;
mod draw;
mod error;
mod limits;
mod pipeline;
mod reads;
mod record;
mod resource;
mod run;
mod sets;
mod staging;
mod tables;
#[cfg(test)]
mod tests;
mod timer;
mod uploads;

#[cfg(doc)]
use tressfx_core::backend::Record;
use tressfx_core::backend::{
    Backend, BufferDesc, Caps, Catalog, ComputeDesc, Memory, RasterDesc, ReadBack, TextureDesc, Timing,
};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::pass::Ticket;
use tressfx_core::shader::{Kernel, RasterPipeline};

pub use device::{WgpuOptions, adapters};
/// The wgpu that this backend is built against.
pub use wgpu;

/// A backend on a wgpu device, its own or an engine's.
#[derive(Debug)]
pub struct WgpuBackend {
    device: wgpu::Device,
    queue: wgpu::Queue,
    catalog: Catalog<wgpu::Buffer, resource::Texture, pipeline::Pipeline>,
    loss: error::Loss,
    scopes: error::Scopes,
    bind_groups: sets::BindGroups,
    uploads: uploads::Belt,
    reads: reads::Reads,
    timer: timer::Timer,
}

impl WgpuBackend {
    /// For engines: a backend on the engine's device.
    ///
    /// Timestamps are used where the device was made with `TIMESTAMP_QUERY`, targets of
    /// [`R11G11B10F`](tressfx_core::backend::Format::R11G11B10F) where it was made with `RG11B10UFLOAT_RENDERABLE`,
    /// and textures that compute passes read and write at once where it was made with `TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES`.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self {
            catalog: Catalog::new(device::caps(&device)),
            loss: error::Loss::new(&device),
            scopes: error::Scopes::default(),
            bind_groups: sets::BindGroups::new(&device),
            uploads: uploads::Belt::default(),
            reads: reads::Reads::default(),
            timer: timer::Timer::new(&device, &queue),
            device,
            queue,
        }
    }

    /// For tools and tests: a backend with a device of its own and no window, on the fastest adapter that the system has.
    /// Blocks until the device is open.
    ///
    /// # Errors
    /// [`Error::NoAdapter`](tressfx_core::Error::NoAdapter) with what was tried and what to install.
    pub fn headless() -> Result<Self> {
        Self::headless_with(&WgpuOptions::default())
    }

    /// As [`headless`](Self::headless), with options.
    ///
    /// # Errors
    /// [`Error::NoAdapter`](tressfx_core::Error::NoAdapter) with the adapters that were found, or with what was tried and
    /// what to install.
    pub fn headless_with(options: &WgpuOptions) -> Result<Self> {
        pollster::block_on(Self::headless_async(options))
    }

    /// As [`headless_with`](Self::headless_with), without blocking.
    ///
    /// # Errors
    /// As [`headless_with`](Self::headless_with).
    pub async fn headless_async(options: &WgpuOptions) -> Result<Self> {
        let (device, queue) = device::open(options).await?;
        let backend = Self::new(device, queue);
        backend.loss.watch(&backend.device);
        Ok(backend)
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }
}

impl Backend for WgpuBackend {
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
        self.reads.cancel_read(ticket);
    }

    fn timings(&mut self) -> Vec<Timing> {
        self.take_timings()
    }

    fn memory(&self) -> Memory {
        self.catalog.memory()
    }
}
