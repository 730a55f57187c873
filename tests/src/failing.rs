//! A backend that refuses one creation: for what must be left behind, which is nothing.

use tressfx_core::backend::{
    Backend, BufferDesc, Caps, ComputeDesc, Memory, RasterDesc, ReadBack, Run, TextureDesc, Timing,
};
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shader::{Kernel, RasterPipeline};

/// A backend that does what `inner` does, but for one creation. It counts what lives, pipelines too.
#[derive(Debug)]
pub struct Failing<B> {
    /// The backend.
    pub inner: B,
    /// So many creations succeed before one fails; `None`: all do.
    pub after: Option<usize>,
    living: usize,
}

impl<B: Backend> Failing<B> {
    /// A backend that refuses nothing yet.
    pub fn new(inner: B) -> Self {
        Self { inner, after: None, living: 0 }
    }

    /// Buffers, textures and pipelines that were made and not destroyed, and the bytes that they take.
    pub fn living(&self) -> (usize, u64) {
        (self.living, self.inner.memory().bytes)
    }

    fn create<T>(&mut self, label: Label, bytes: u64, make: impl FnOnce(&mut B) -> Result<T>) -> Result<T> {
        match self.after {
            Some(0) => {
                self.after = None;
                return Err(Error::OutOfMemory { label, bytes });
            }
            Some(more) => self.after = Some(more - 1),
            None => {}
        }
        let made = make(&mut self.inner)?;
        self.living += 1;
        Ok(made)
    }

    /// Runs `step` again and again, with one more creation that succeeds each time, until none is refused. After each failure as
    /// much lives as before; the number of failures is given.
    ///
    /// # Panics
    /// If something is left behind, or if an error is another one.
    pub fn fail_everywhere<T, E: std::fmt::Display>(
        &mut self,
        mut step: impl FnMut(&mut dyn Backend) -> std::result::Result<T, E>,
    ) -> (T, usize) {
        for after in 0.. {
            let before = self.living();
            self.after = Some(after);
            let made = step(self);
            if self.after.take().is_some() {
                return (made.unwrap_or_else(|error| panic!("nothing was refused: {error}")), after);
            }
            let error =
                made.err().unwrap_or_else(|| panic!("creation {after} was refused, and nobody noticed")).to_string();
            assert!(error.contains("has no memory left"), "creation {after}: {error}");
            assert_eq!(self.living(), before, "creation {after} was refused: resources, bytes");
        }
        unreachable!("numbers do not end")
    }
}

impl<B: Backend> Backend for Failing<B> {
    fn caps(&self) -> &Caps {
        self.inner.caps()
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        self.create(desc.label, desc.bytes, |inner| inner.create_buffer(desc))
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        self.create(desc.label, desc.bytes(), |inner| inner.create_texture(desc))
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        self.create(desc.shader.label, 0, |inner| inner.create_compute(desc))
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        self.create(desc.shader.label, 0, |inner| inner.create_raster(desc))
    }

    fn destroy(&mut self, resource: Resource) {
        self.living -= 1;
        self.inner.destroy(resource);
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.living -= 1;
        self.inner.destroy_pipeline(pipeline);
    }

    fn read(&mut self, ticket: Ticket) -> ReadBack {
        self.inner.read(ticket)
    }

    fn cancel_read(&mut self, ticket: Ticket) {
        self.inner.cancel_read(ticket);
    }

    fn timings(&mut self) -> Vec<Timing> {
        self.inner.timings()
    }

    fn memory(&self) -> Memory {
        self.inner.memory()
    }
}

impl<B: Run> Run for Failing<B> {
    fn run(&mut self, list: &PassList) -> Result<()> {
        self.inner.run(list)
    }
}
