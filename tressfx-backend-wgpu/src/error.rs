//! What wgpu complains of, and whether the device is still there.

use std::future::Future;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::task::{Context, Poll, Waker};

use tressfx_core::error::{Error, Label, Result};
use wgpu::{ErrorFilter, PollStatus, PollType, WasmNotSend};

use crate::WgpuBackend;

/// What an error scope has caught, once the device says so.
trait Caught: Future<Output = Option<wgpu::Error>> + WasmNotSend {}

impl<F: Future<Output = Option<wgpu::Error>> + WasmNotSend> Caught for F {}

/// An error scope whose answer has not come yet.
struct Scope {
    label: Label,
    bytes: u64,
    caught: Pin<Box<dyn Caught>>,
}

impl Scope {
    /// What it has caught; `Pending` in a browser, where it comes later.
    fn poll(&mut self) -> Poll<Result<()>> {
        let caught = self.caught.as_mut().poll(&mut Context::from_waker(Waker::noop()));
        caught.map(|error| match error {
            None => Ok(()),
            Some(wgpu::Error::OutOfMemory { .. }) => Err(Error::OutOfMemory { label: self.label, bytes: self.bytes }),
            Some(error) => Err(Error::Backend { label: self.label, message: error.to_string() }),
        })
    }
}

/// Error scopes whose answers have not come yet. On native systems there are none.
#[derive(Default)]
pub(crate) struct Scopes(Mutex<Vec<Scope>>);

impl std::fmt::Debug for Scopes {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(out, "Scopes")
    }
}

impl Scopes {
    /// The first error that has come since, if any.
    fn check(&mut self) -> Result<()> {
        let mut error = Ok(());
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner).retain_mut(|scope| match scope.poll() {
            Poll::Pending => true,
            Poll::Ready(caught) => {
                error = std::mem::replace(&mut error, Ok(())).and(caught);
                false
            }
        });
        error
    }

    fn push(&mut self, scope: Scope) {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner).push(scope);
    }
}

/// Runs `call` and drops what wgpu complains of: for calls whose result says the same.
pub(crate) fn ignoring<T>(device: &wgpu::Device, call: impl FnOnce() -> T) -> T {
    let scope = device.push_error_scope(ErrorFilter::Validation);
    let result = call();
    drop(scope);
    result
}

/// Whether the device is still there. An engine keeps its device-lost callback, so it is found out in other ways.
#[derive(Debug)]
pub(crate) struct Loss {
    reason: Arc<OnceLock<String>>,
    /// Four bytes that a device which is there agrees to map.
    probe: wgpu::Buffer,
}

impl Loss {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let probe = ignoring(device, || {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("hair.probe"),
                size: 4,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        });
        Self { reason: Arc::default(), probe }
    }

    /// Has a device of our own say when and why it is lost.
    pub(crate) fn watch(&self, device: &wgpu::Device) {
        let reason = self.reason.clone();
        device.set_device_lost_callback(move |kind, message| {
            let _ = reason.set(format!("{kind:?}: {message}"));
        });
    }

    /// Notes that something failed which fails on lost devices alone.
    pub(crate) fn note(&self) {
        let _ = self.reason.set(String::from("it refuses to work; why, the device-lost callback has been told"));
    }

    fn reason(&self) -> Result<()> {
        self.reason.get().map_or(Ok(()), |reason| Err(Error::DeviceLost { reason: reason.clone() }))
    }

    /// # Errors
    /// [`Error::DeviceLost`] if it is.
    pub(crate) fn check(&self, device: &wgpu::Device) -> Result<()> {
        self.reason()?;
        // In a browser the answer would come later: there, read-backs tell.
        if !cfg!(target_arch = "wasm32") && self.refuses_to_map(device) {
            self.note();
        }
        self.reason()
    }

    /// A lost device refuses at once; one that is there has not answered yet when the buffer is taken back.
    fn refuses_to_map(&self, device: &wgpu::Device) -> bool {
        let refused = Arc::new(AtomicBool::new(false));
        let answer = refused.clone();
        ignoring(device, || {
            self.probe.map_async(wgpu::MapMode::Read, .., move |result| {
                answer.store(result.is_err(), Ordering::Release);
            });
            let refused = refused.load(Ordering::Acquire);
            self.probe.unmap();
            refused
        })
    }

    /// As [`wgpu::Device::poll`], which panics where it is the first to find that the device is lost.
    pub(crate) fn poll(&self, device: &wgpu::Device, how: PollType) -> Result<()> {
        self.check(device)?;
        match catch_unwind(AssertUnwindSafe(|| device.poll(how))) {
            Ok(Ok(PollStatus::QueueEmpty | PollStatus::WaitSucceeded | PollStatus::Poll)) => self.reason(),
            Ok(Err(error)) => Err(Error::Backend { label: "poll", message: error.to_string() }),
            Err(panic) => {
                let of_wgpu = panic.downcast_ref::<String>().is_some_and(|said| said.contains("Device::poll"));
                if !of_wgpu {
                    // A callback of the engine's.
                    resume_unwind(panic);
                }
                self.note();
                self.reason()
            }
        }
    }
}

impl WgpuBackend {
    /// # Errors
    /// [`Error::DeviceLost`], or what wgpu has said since it was last asked.
    pub(crate) fn check(&mut self) -> Result<()> {
        self.loss.check(&self.device)?;
        self.scopes.check()
    }

    /// Runs `make` and turns what wgpu complains of into an error.
    pub(crate) fn guarded<T>(
        &mut self,
        label: Label,
        bytes: u64,
        make: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        self.check()?;
        let memory = self.device.push_error_scope(ErrorFilter::OutOfMemory);
        let internal = self.device.push_error_scope(ErrorFilter::Internal);
        let validation = self.device.push_error_scope(ErrorFilter::Validation);
        let made = make(self);
        let caught: [Pin<Box<dyn Caught>>; 3] =
            [Box::pin(validation.pop()), Box::pin(internal.pop()), Box::pin(memory.pop())];
        // Creation on a lost device fails without an error.
        self.loss.check(&self.device)?;
        for caught in caught {
            let mut scope = Scope { label, bytes, caught };
            match scope.poll() {
                Poll::Ready(caught) => caught?,
                Poll::Pending => self.scopes.push(scope),
            }
        }
        made
    }
}
