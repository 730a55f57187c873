//! Runs TressFX passes on wgpu.
//!
//! # Promises
//!
//! * [`Record::record`] never submits, waits or keeps the encoder.
//! * Imported buffers and textures are never destroyed here; `destroy` only forgets them.
//! * wgpu derives barriers by itself, so the hazards of `tressfx-core` are not asked for.
//!
//! It decides nothing about hair and does not know what a window is.

mod device;
mod pipeline;
mod read;
mod record;
mod resource;
mod tables;
mod timer;

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use tressfx_core::backend::{
    Backend, BufferDesc, Caps, ComputeDesc, Kernel, Memory, RasterDesc, Record, TextureDesc, Timing,
};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::{BufferId, PipelineId, Resource, Slots, TextureId};
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shader::Bindings;

pub use device::adapters;
/// The wgpu that this backend is built against.
pub use wgpu;

/// A backend on a wgpu device, its own or an engine's.
#[derive(Debug)]
pub struct WgpuBackend {
    device: wgpu::Device,
    queue: wgpu::Queue,
    caps: Caps,
    lost: Arc<Mutex<Option<String>>>,
    buffers: Slots<resource::Buffer>,
    textures: Slots<resource::Texture>,
    pipelines: Slots<pipeline::Pipeline>,
    bind_groups: HashMap<(PipelineId, Bindings), wgpu::BindGroup>,
    reads: HashMap<Ticket, read::PendingRead>,
    timer: timer::Timer,
    memory: Memory,
}

impl WgpuBackend {
    /// A backend that shares an engine's device and queue.
    ///
    /// Timestamps are used where the device was made with `TIMESTAMP_QUERY`.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let lost = device::watch_for_loss(&device);
        Self {
            caps: device::caps(&device),
            timer: timer::Timer::new(&device, &queue),
            device,
            queue,
            lost,
            buffers: Slots::default(),
            textures: Slots::default(),
            pipelines: Slots::default(),
            bind_groups: HashMap::new(),
            reads: HashMap::new(),
            memory: Memory::default(),
        }
    }

    /// A backend with a device of its own and no window: the fastest adapter that the system has.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] with what was tried and what to install.
    pub fn headless() -> Result<Self> {
        Self::headless_on(None)
    }

    /// As [`headless`](Self::headless), on the first adapter whose name contains `adapter`, in whatever case.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] with the adapters that there are.
    pub fn headless_on(adapter: Option<&str>) -> Result<Self> {
        let (device, queue) = device::open(adapter)?;
        Ok(Self::new(device, queue))
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    fn check_lost(&self) -> Result<()> {
        match self.lost.lock().unwrap_or_else(std::sync::PoisonError::into_inner).as_ref() {
            Some(reason) => Err(Error::DeviceLost { reason: reason.clone() }),
            None => Ok(()),
        }
    }

    /// Runs `make` and turns what wgpu complains of into an error.
    fn guarded<T>(&mut self, label: Label, bytes: u64, make: impl FnOnce(&mut Self) -> T) -> Result<T> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make(self);
        let validation = pollster::block_on(validation.pop());
        let internal = pollster::block_on(internal.pop());
        let memory = pollster::block_on(memory.pop());
        self.check_lost()?;
        if memory.is_some() {
            return Err(Error::OutOfMemory { label, bytes });
        }
        match validation.or(internal) {
            Some(error) => Err(Error::Backend { label, message: error.to_string() }),
            None => Ok(made),
        }
    }
}

impl Backend for WgpuBackend {
    fn caps(&self) -> &Caps {
        &self.caps
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

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<Kernel> {
        self.make_raster(desc)
    }

    fn destroy(&mut self, resource: Resource) {
        self.forget(resource);
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.pipelines.remove(pipeline.0);
        self.bind_groups.retain(|(of, _), _| *of != pipeline);
    }

    fn run(&mut self, list: &PassList) -> Result<()> {
        self.check_lost()?;
        self.guarded("run", 0, |backend| {
            let mut encoder = backend.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            backend.record(&mut encoder, list)?;
            backend.queue.submit([encoder.finish()]);
            Ok(())
        })??;
        self.wait()
    }

    fn read(&mut self, ticket: Ticket) -> Option<Vec<u8>> {
        self.take_read(ticket)
    }

    fn timings(&mut self) -> Vec<Timing> {
        self.timer.collect(&self.device)
    }

    fn memory(&self) -> Memory {
        self.memory
    }
}
