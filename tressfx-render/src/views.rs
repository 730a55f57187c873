//! The views of a frame on the GPU.

use tressfx_core::backend::{Backend, BufferDesc, BufferUse};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, Resource};
use tressfx_core::pass::PassList;
use tressfx_core::view::View;

use crate::lights::Lights;
use crate::renderer::Targets;
use crate::uniforms::ViewUniform;

/// Views that one frame can have.
pub const MAX_VIEWS: usize = 8;

/// A view in a frame.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ViewDraw<'a> {
    /// From where.
    pub view: &'a View,
    /// In which light.
    pub lights: &'a Lights,
    /// Into which textures.
    pub targets: Targets,
}

impl<'a> ViewDraw<'a> {
    /// A view of the strands.
    pub fn new(view: &'a View, lights: &'a Lights, targets: Targets) -> Self {
        Self { view, lights, targets }
    }
}

/// A view as passes bind it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundView {
    /// Which view of the frame it is.
    pub(crate) index: usize,
    /// [`ViewUniform`].
    pub(crate) uniform: Resource,
    /// Pixels of the viewport.
    pub(crate) size: [u32; 2],
}

/// [`ViewUniform`] of each view.
#[derive(Debug)]
pub(crate) struct Views {
    uniforms: [BufferId; MAX_VIEWS],
}

impl Views {
    pub(crate) fn new(backend: &mut dyn Backend) -> Result<Self> {
        let bytes = size_of::<ViewUniform>() as u64;
        let mut uniforms = Vec::new();
        for _ in 0..MAX_VIEWS {
            uniforms.push(backend.create_buffer(&BufferDesc {
                label: "hair.render.view",
                bytes,
                usage: BufferUse::Uniform,
            })?);
        }
        Ok(Self { uniforms: uniforms.try_into().expect("as many as there are views") })
    }

    /// Uploads the views of a frame.
    pub(crate) fn upload(&self, list: &mut PassList, views: &[ViewDraw]) {
        for (buffer, draw) in self.uniforms.iter().zip(views) {
            list.upload(*buffer, 0, &[ViewUniform::new(draw.view, draw.lights)]);
        }
    }

    pub(crate) fn bound(&self, index: usize, view: &View) -> BoundView {
        BoundView { index, uniform: self.uniforms[index].into(), size: view.size() }
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.uniforms.into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}
