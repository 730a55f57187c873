//! Who frees what.

use super::{Backend, BufferDesc, Caps, ComputeDesc, Memory, RasterDesc, ReadBack, TextureDesc, Timing};
use crate::error::Result;
use crate::id::{BufferId, PipelineId, Resource, TextureId};
use crate::pass::Ticket;
use crate::shader::{Kernel, RasterPipeline};

/// Everything that one part of the library has made on a backend. It is freed together; if a later step of making it fails,
/// what was made before is freed at once.
#[must_use = "what it owns is freed by `destroy` alone"]
#[derive(Debug, Default)]
pub struct Owner {
    resources: Vec<Resource>,
    pipelines: Vec<PipelineId>,
}

impl Owner {
    /// Makes something of several resources and pipelines. If `make` fails, what it has made until then is freed.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn build<T, E>(
        backend: &mut dyn Backend,
        make: impl FnOnce(&mut dyn Backend) -> Result<T, E>,
    ) -> Result<(T, Self), E> {
        let mut owner = Self::default();
        let made = owner.change(backend, make)?;
        Ok((made, owner))
    }

    /// Makes more, or replaces something: what `make` creates is owned from now on, and what it destroys no longer. If it
    /// fails, what it has created is freed.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn change<T, E>(
        &mut self,
        backend: &mut dyn Backend,
        make: impl FnOnce(&mut dyn Backend) -> Result<T, E>,
    ) -> Result<T, E> {
        let mut watched = Watched { backend, made: Self::default(), gone: Self::default() };
        let made = make(&mut watched);
        let Watched { backend, made: new, gone } = watched;
        self.resources.retain(|resource| !gone.resources.contains(resource));
        self.pipelines.retain(|pipeline| !gone.pipelines.contains(pipeline));
        if made.is_err() {
            new.destroy(backend);
        } else {
            self.resources.extend(new.resources);
            self.pipelines.extend(new.pipelines);
        }
        made
    }

    /// Forgets what is owned and frees nothing: the caller frees it.
    pub fn leave(self) {}

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.resources.into_iter().for_each(|resource| backend.destroy(resource));
        self.pipelines.into_iter().for_each(|pipeline| backend.destroy_pipeline(pipeline));
    }
}

/// A backend that notes what is made on it.
struct Watched<'a> {
    backend: &'a mut dyn Backend,
    made: Owner,
    /// What was destroyed and not made here.
    gone: Owner,
}

impl Backend for Watched<'_> {
    fn caps(&self) -> &Caps {
        self.backend.caps()
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        let id = self.backend.create_buffer(desc)?;
        self.made.resources.push(id.into());
        Ok(id)
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        let id = self.backend.create_texture(desc)?;
        self.made.resources.push(id.into());
        Ok(id)
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        let kernel = self.backend.create_compute(desc)?;
        self.made.pipelines.push(kernel.pipeline);
        Ok(kernel)
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        let pipeline = self.backend.create_raster(desc)?;
        self.made.pipelines.push(pipeline.pipeline);
        Ok(pipeline)
    }

    fn destroy(&mut self, resource: Resource) {
        self.backend.destroy(resource);
        match self.made.resources.iter().position(|&made| made == resource) {
            Some(index) => drop(self.made.resources.swap_remove(index)),
            None => self.gone.resources.push(resource),
        }
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.backend.destroy_pipeline(pipeline);
        match self.made.pipelines.iter().position(|&made| made == pipeline) {
            Some(index) => drop(self.made.pipelines.swap_remove(index)),
            None => self.gone.pipelines.push(pipeline),
        }
    }

    fn read(&mut self, ticket: Ticket) -> ReadBack {
        self.backend.read(ticket)
    }

    fn cancel_read(&mut self, ticket: Ticket) {
        self.backend.cancel_read(ticket);
    }

    fn timings(&mut self) -> Vec<Timing> {
        self.backend.timings()
    }

    fn memory(&self) -> Memory {
        self.backend.memory()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::null::NullBackend;

    fn bytes(backend: &NullBackend) -> u64 {
        backend.memory().bytes
    }

    #[test]
    fn what_fails_half_way_leaves_nothing_behind() {
        let mut backend = NullBackend::default();
        let made = Owner::build(&mut backend, |backend| {
            backend.create_buffer(&BufferDesc::storage("first", 64))?;
            backend.create_buffer(&BufferDesc::storage("second", 3))
        });
        assert!(matches!(made, Err(Error::Rule { .. })));
        assert_eq!(bytes(&backend), 0);
    }

    #[test]
    fn what_is_replaced_is_freed_once_and_the_rest_with_the_owner() {
        let mut backend = NullBackend::default();
        let make = |backend: &mut dyn Backend, bytes| backend.create_buffer(&BufferDesc::storage("part", bytes));
        let ((first, _), mut owner) =
            Owner::build(&mut backend, |backend| Ok::<_, Error>((make(backend, 64)?, make(backend, 32)?))).unwrap();
        owner
            .change(&mut backend, |backend| {
                backend.destroy(first.into());
                make(backend, 128)
            })
            .unwrap();
        assert_eq!(bytes(&backend), 32 + 128);
        owner.change(&mut backend, |backend| make(backend, 16).and_then(|_| make(backend, 1))).unwrap_err();
        assert_eq!(bytes(&backend), 32 + 128);
        owner.destroy(&mut backend);
        assert_eq!(bytes(&backend), 0);
    }
}
