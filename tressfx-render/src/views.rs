//! The views of a frame on the GPU.

use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;
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
    pub(crate) uniform: Binding,
    /// Pixels of the viewport.
    pub(crate) size: [u32; 2],
}

/// [`ViewUniform`] of each view, in one buffer: they are uploaded together, and each pass binds its own.
#[derive(Debug)]
pub(crate) struct Views {
    uniforms: BufferId,
    /// From view to view, in bytes.
    stride: u64,
}

impl Views {
    const BYTES: u64 = size_of::<ViewUniform>() as u64;

    pub(crate) fn new(backend: &mut dyn Backend) -> Result<Self> {
        let stride = Self::BYTES.next_multiple_of(backend.caps().binding_alignment);
        let desc = BufferDesc::uniform("hair.render.views", stride * MAX_VIEWS as u64);
        Ok(Self { uniforms: backend.create_buffer(&desc)?, stride })
    }

    /// Uploads the views of a frame.
    pub(crate) fn upload(&self, list: &mut PassList, views: &[ViewDraw]) {
        let stride = self.stride as usize;
        let mut bytes = vec![0u8; stride * views.len()];
        for (place, draw) in bytes.chunks_exact_mut(stride).zip(views) {
            let uniform = ViewUniform::new(draw.view, draw.lights);
            place[..size_of::<ViewUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        list.upload(self.uniforms, 0, &bytes);
    }

    pub(crate) fn bound(&self, index: usize, view: &View) -> BoundView {
        let uniform = self.uniforms.range(index as u64 * self.stride, Self::BYTES);
        BoundView { index, uniform, size: view.size() }
    }
}
